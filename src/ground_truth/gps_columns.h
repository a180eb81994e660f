// Latitudes and longitudes in the columns of a CSV.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ground_truth/geodesy.h"
#include "ground_truth/named_rows.h"

namespace vpr {

/// What a header calls them.
struct GpsColumns {
  std::string latitude;
  std::string longitude;
};

/// Those of lat or latitude, and of lon, lng, long or longitude, in small or capital letters.
/// Nothing if one is missing.
std::optional<GpsColumns> find_gps_columns(const std::vector<std::string>& header);

/// A place from two numbers as text, in degrees with a decimal point; longitudes are from -180 to
/// 360. Throws Error(data), at the location, for anything else; of a latitude beyond 90 it says
/// that the two may be swapped.
Geographic parse_place(const FileLocation& location, std::string_view latitude,
                       std::string_view longitude);

/// The place of the present row; nothing where both fields are empty: there was no fix. Throws as
/// parse_place does.
std::optional<Geographic> read_fix(const NamedRows& rows, const GpsColumns& columns);

}  // namespace vpr
