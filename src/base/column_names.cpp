#include "base/column_names.h"

#include <algorithm>
#include <numbers>

#include "base/text.h"

namespace vpr {
namespace {

/// The quantity in a column.
enum class Quantity { none, time, length, angle };

/// Columns with other names in headers, or with units.
struct Role {
  std::string_view name;
  Quantity quantity;
  std::vector<std::string_view> others = {};
  /// Names of other programs, in lower case, which count only if no column has a name above or an
  /// earlier one. One that begins with a point is the end of a name, as in "field.pose.position.x".
  std::vector<std::string_view> foreign = {};
};

const std::vector<Role>& roles() {
  static const std::vector<Role> kRoles = {
      {"time",
       Quantity::time,
       {"timestamp", "time stamp", "time_stamp", "stamp"},
       {".header.stamp", "t", "unix time", "unix_time", "frame timestamp", "%time", "gpstime",
        "gps_time", "utc", "datetime", "date time", "date_time"}},
      {"sec", Quantity::none, {"secs"}, {".secs", ".sec"}},
      {"nsec", Quantity::none, {"nsecs", "nanosec"}, {".nsecs", ".nsec", ".nanosec"}},
      {"x",
       Quantity::length,
       {},
       {"tx", "t_x", "px", "p_x", "pos_x", "position_x", "p_rs_r_x", "p_ws_w_x", "translation_x",
        "easting", "east", ".position.x", ".translation.x"}},
      {"y",
       Quantity::length,
       {},
       {"ty", "t_y", "py", "p_y", "pos_y", "position_y", "p_rs_r_y", "p_ws_w_y", "translation_y",
        "northing", "north", ".position.y", ".translation.y"}},
      {"z",
       Quantity::length,
       {},
       {"tz", "t_z", "pz", "p_z", "pos_z", "position_z", "p_rs_r_z", "p_ws_w_z", "translation_z",
        "altitude", ".position.z", ".translation.z"}},
      {"qx",
       Quantity::none,
       {"q_x"},
       {"q_rs_x", "q_ws_x", "quat_x", ".orientation.x", ".rotation.x"}},
      {"qy",
       Quantity::none,
       {"q_y"},
       {"q_rs_y", "q_ws_y", "quat_y", ".orientation.y", ".rotation.y"}},
      {"qz",
       Quantity::none,
       {"q_z"},
       {"q_rs_z", "q_ws_z", "quat_z", ".orientation.z", ".rotation.z"}},
      {"qw",
       Quantity::none,
       {"q_w"},
       {"q_rs_w", "q_ws_w", "quat_w", ".orientation.w", ".rotation.w"}},
      {"heading", Quantity::angle},
      {"lat",
       Quantity::angle,
       {"latitude"},
       {"gps_lat", "gps_latitude", "gpslatitude", ".latitude"}},
      {"lon",
       Quantity::angle,
       {"lng", "long", "longitude"},
       {"gps_lon", "gps_lng", "gps_longitude", "gpslongitude", ".longitude"}},
      {"image",
       Quantity::none,
       {"name", "file", "filename"},
       {"image_name", "image_path", "image_file", "image_filename", "img_name", "img_path",
        "file_name", "file_path", "frame_name", "filepath", "path", "img", "key", "photo"}},
      {"n/s", Quantity::none, {}, {"gpslatituderef"}},
      {"e/w", Quantity::none, {}, {"gpslongituderef"}},
      {"score", Quantity::none, {"distance", "similarity", "rank"}}};
  return kRoles;
}

/// A unit that the name of a column may end with.
struct Unit {
  std::string_view symbol;
  Quantity quantity;
  double size;                 // in nanoseconds, meters or degrees
  std::string_view word = {};  // itself the name of a column
};
constexpr Unit kUnits[] = {{"s", Quantity::time, 1e9, "seconds"},
                           {"sec", Quantity::time, 1e9},
                           {"ms", Quantity::time, 1e6, "milliseconds"},
                           {"us", Quantity::time, 1e3, "microseconds"},
                           {"ns", Quantity::time, 1, "nanoseconds"},
                           {"seconds", Quantity::time, 1e9},
                           {"msec", Quantity::time, 1e6},
                           {"millis", Quantity::time, 1e6},
                           {"milliseconds", Quantity::time, 1e6},
                           {"usec", Quantity::time, 1e3},
                           {"micros", Quantity::time, 1e3},
                           {"microseconds", Quantity::time, 1e3},
                           {"nsec", Quantity::time, 1},
                           {"nanos", Quantity::time, 1},
                           {"nanosec", Quantity::time, 1},
                           {"nanoseconds", Quantity::time, 1},
                           {"m", Quantity::length, 1},
                           {"cm", Quantity::length, 1e-2},
                           {"mm", Quantity::length, 1e-3},
                           {"deg", Quantity::angle, 1},
                           {"\xc2\xb0", Quantity::angle, 1},  // the sign of degrees in UTF-8
                           {"rad", Quantity::angle, 180 / std::numbers::pi}};

}  // namespace

std::optional<ColumnName> parse_column_name(const std::string& cell, std::string_view column) {
  std::string text = lower_case(cell);
  if (text == column) return ColumnName{};
  const auto role = std::ranges::find(roles(), column, &Role::name);
  if (role == roles().end() || text.empty()) return std::nullopt;
  if (text.ends_with("[]")) text.erase(text.find_last_not_of(' ', text.size() - 3) + 1);
  // The column with a unit; nullopt if it has another name.
  const auto named = [&](std::string_view name,
                         std::optional<double> unit) -> std::optional<ColumnName> {
    if (name == column || std::ranges::count(role->others, name) > 0) return ColumnName{unit};
    const auto foreign = std::ranges::find_if(role->foreign, [&](std::string_view other) {
      return other.starts_with('.') ? name.ends_with(other) : name == other;
    });
    if (foreign == role->foreign.end()) return std::nullopt;
    return ColumnName{unit, 1 + static_cast<size_t>(foreign - role->foreign.begin())};
  };
  if (const auto name = named(text, std::nullopt)) return name;
  for (const Unit& unit : kUnits) {
    std::string_view name = text;
    if (unit.quantity != role->quantity) continue;
    if (name == unit.word) return ColumnName{unit.size};
    if (name.ends_with(']') || name.ends_with(')')) name.remove_suffix(1);
    if (!name.ends_with(unit.symbol)) continue;
    name.remove_suffix(unit.symbol.size());
    const size_t end = name.find_last_not_of(" _[(") + 1;  // npos + 1 is 0
    if (end == 0 || end == name.size()) continue;
    if (const auto found = named(name.substr(0, end), unit.size)) return found;
  }
  return std::nullopt;
}

bool are_columns(std::span<const std::string_view> words) {
  return std::ranges::all_of(words, [](std::string_view word) {
    return std::ranges::any_of(roles(), [&](const Role& role) {
      return parse_column_name(std::string(word), role.name).has_value();
    });
  });
}

bool has_columns(const std::vector<std::string>& header,
                 const std::vector<std::string_view>& columns) {
  return std::ranges::all_of(columns, [&](auto column) {
    return std::ranges::any_of(
        header, [&](const auto& name) { return parse_column_name(name, column).has_value(); });
  });
}

}  // namespace vpr
