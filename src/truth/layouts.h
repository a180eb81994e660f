// The table of layouts of trajectory files, as SLAM systems and data sets write them: detection and
// the only reader.
#pragma once

#include <array>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/rows.h"
#include "truth/formats.h"
#include "truth/trajectory.h"

namespace vpr {

inline constexpr std::array<std::string_view, 4> kQuaternion = {"qx", "qy", "qz", "qw"};
inline constexpr std::array<std::string_view, 9> kMatrix = {"m0", "m1", "m2", "m3", "m4",
                                                            "m5", "m6", "m7", "m8"};
inline constexpr std::array<std::string_view, 3> kPosition = {"x", "y", "z"};

/// Whether a column has coordinates or angles.
bool is_value(std::string_view column);

/// The number of columns of a line. VINS ends its lines with a comma.
size_t width_of(std::span<const std::string_view> cells);

/// A layout of files with one pose per line, or of tables with a header.
struct Layout {
  std::string_view name;     ///< of the ground truth format
  std::string_view summary;  ///< for help texts and errors
  std::string_view separators;
  /// The columns in their order. Roles are time, sec and nsec, frame, image, x, y, z, qx to qw (a
  /// quaternion), m0 to m8 (a rotation matrix, row by row), roll, pitch and yaw (in radians), lat
  /// and lon; other columns are skipped. In a table, the columns that its header may name.
  std::vector<std::string_view> columns;
  /// Possible numbers of columns; those after `columns` are skipped. Empty for a table.
  std::vector<size_t> widths = {};
  std::string_view marker = {};   ///< a part of the comments before the first line; empty: none
  std::string_view keyword = {};  ///< the first cell of its lines; others are skipped; empty: all
  bool is_world_to_camera = false;
  bool has_points = false;  ///< the line after each pose is skipped

  bool is_table() const { return widths.empty(); }
  bool has(std::string_view column) const;
};

/// All layouts, in the order of detection.
std::span<const Layout> layouts();

/// The layout with this name, or null.
const Layout* find_layout(std::string_view name);

/// The first layout whose columns are in the file: by their number, by the names in a comment
/// before them, and by values (quaternions of length 1, rotation matrices, degrees). Without
/// plausible values, the first one with these columns, which read_layout refuses. Null if there is
/// none.
const Layout* detect_layout(const FileStart& start);

/// The end of a sentence about a file of numbers that has no layout: ": its 4 columns ..."; empty
/// for other files.
std::string columns_hint(const FileStart& start);

/// Fills the names of the poses' frames from the column image or, without it, the columns that may
/// have them: all but coordinates.
void read_names(Rows& rows, const FrameRange& lines, Trajectory& trajectory);

/// Reads a trajectory. A layout with a column frame has one pose per frame number, others one per
/// line. A range may follow the path (PATH@FIRST:LAST[:STEP]). Missing values (nan) are poses that
/// are unknown. `with_times`: reads times; they need not increase. Throws Error(input) if the file
/// cannot be read and Error(data), with the line, if it is damaged or implausible: a quaternion
/// whose length is not about 1, a matrix that is not a rotation.
Trajectory read_layout(const std::filesystem::path& path, const Layout& layout, bool with_times);

}  // namespace vpr
