// Images with their position in their name.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "truth/formats.h"
#include "truth/poses.h"

namespace vpr {

/// A name in the format of the field's data sets:
/// @east@north@zone@letter@latitude@longitude@pano@tile@heading@..., of which east and north (UTM,
/// meters) are required and the rest may be empty or missing. Nullopt for other names. `zone`: the
/// UTM zone, 1 to 60; empty if missing or invalid.
struct UtmName {
  Pose pose;
  std::string zone;
};
std::optional<UtmName> parse_utm_name(std::string_view file_name);

/// The argument's path is the query, its `reference` the training sequence: folders or lists, with
/// ranges of frames, as passed to vpr-query and vpr-train. Images within a radius (default 25 m)
/// show the same place. Throws Error(data) for a name without coordinates, for different zones, or
/// if the numbers of images and frames differ.
std::string read_utm_names(GroundTruthBuilder& builder);

/// A folder, or a list whose first image has a UTM name.
bool is_utm_names(const FileStart& start);

}  // namespace vpr
