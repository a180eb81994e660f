#include "ground_truth/gps_columns.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "ground_truth/numbers.h"

namespace vpr {
namespace {

std::string small_letters(std::string text) {
  for (char& letter : text)
    if (letter >= 'A' && letter <= 'Z') letter = static_cast<char>(letter - 'A' + 'a');
  return text;
}

std::string find_name(const std::vector<std::string>& header,
                      const std::vector<std::string_view>& names) {
  const auto found = std::find_if(header.begin(), header.end(), [&](const std::string& column) {
    return std::find(names.begin(), names.end(), small_letters(column)) != names.end();
  });
  return found == header.end() ? "" : *found;
}

double degrees(const FileLocation& location, const char* what, std::string_view text) {
  const auto value = parse_real(text);
  if (!value)
    location.fail(
        fmt::format("the {} \"{}\" is not a number in degrees (leave both empty where "
                    "there was no fix)",
                    what, text));
  return *value;
}

}  // namespace

std::optional<GpsColumns> find_gps_columns(const std::vector<std::string>& header) {
  const GpsColumns columns{find_name(header, {"lat", "latitude"}),
                           find_name(header, {"lon", "lng", "long", "longitude"})};
  if (columns.latitude.empty() || columns.longitude.empty()) return std::nullopt;
  return columns;
}

Geographic parse_place(const FileLocation& location, std::string_view latitude,
                       std::string_view longitude) {
  const Geographic place{degrees(location, "latitude", latitude),
                         degrees(location, "longitude", longitude)};
  if (std::abs(place.latitude_deg) > 90)
    location.fail(fmt::format(
        "the latitude {} is beyond 90 degrees{}", latitude,
        std::abs(place.longitude_deg) <= 90 ? "; are latitude and longitude swapped?" : ""));
  if (!(place.longitude_deg >= -180 && place.longitude_deg <= 360))
    location.fail(fmt::format("the longitude {} is not within -180 and 180 degrees", longitude));
  return place;
}

std::optional<Geographic> read_fix(const NamedRows& rows, const GpsColumns& columns) {
  const std::string& latitude = rows.text(columns.latitude);
  const std::string& longitude = rows.text(columns.longitude);
  if (latitude.empty() && longitude.empty()) return std::nullopt;
  return parse_place(rows.location(), latitude, longitude);
}

}  // namespace vpr
