// Images that carry their place in their name.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "truth/formats.h"
#include "truth/poses.h"

namespace vpr {

/// A name as the field's data sets have it: @east@north@zone@letter@latitude@longitude@pano@tile@
/// heading@..., of which east and north (UTM, metres) are needed and the rest may be empty or
/// absent. Nothing if it isn't one. `zone`: the UTM zone, 1 to 60; empty if it isn't said, or if
/// something else stands there.
struct UtmName {
  Pose pose;
  std::string zone;
};
std::optional<UtmName> parse_utm_name(std::string_view file_name);

/// The argument's path is the query, its `reference` the training sequence: folders or lists, with
/// ranges of frames, as they were given to vpr-query and vpr-train. Images within a radius
/// (default 25 m) show the same place. Throws Error(data) for a name without coordinates, for
/// different zones, or where the numbers of images are not those of the frames.
std::string read_utm_names(GroundTruthBuilder& builder);

/// A folder, or a list whose first image has such a name.
bool is_utm_names(const FileStart& start);

}  // namespace vpr
