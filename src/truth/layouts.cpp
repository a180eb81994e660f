#include "truth/layouts.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include <fmt/format.h>

#include "base/column_names.h"
#include "base/named_table.h"
#include "base/rows.h"
#include "base/text.h"
#include "truth/positions.h"
#include "truth/rotations.h"

namespace vpr {
namespace {

/// Lines of a file that are examined for its layout.
constexpr size_t kSampledLines = 200;
constexpr std::array<std::string_view, 3> kTurns = {"roll", "pitch", "yaw"};
using Columns = std::vector<std::string_view>;

Columns split_cells(std::string_view line, std::string_view separators) {
  Columns cells;
  if (separators == " ") {
    for (size_t at = 0; (at = line.find_first_not_of(" \t\r", at)) < line.size();) {
      const size_t end = std::min(line.find_first_of(" \t\r", at), line.size());
      cells.push_back(line.substr(at, end - at));
      at = end;
    }
    return cells;
  }
  for (const std::string_view cell : split(line, ',')) {
    const size_t begin = std::min(cell.find_first_not_of(" \t\r"), cell.size());
    cells.push_back(cell.substr(begin, cell.find_last_not_of(" \t\r") + 1 - begin));
  }
  return cells;
}

/// The beginning of a file: its comments and first lines.
struct Sample {
  std::string_view comments = {};  ///< before the first line
  std::vector<std::string_view> lines = {};
};

Sample sample_of(const FileStart& start) {
  Sample sample;
  const std::string_view text = start.bytes;
  std::vector<std::string_view> all = split_lines(text);
  if (start.is_cut && all.size() > 1) all.pop_back();
  for (const std::string_view line : all) {
    const size_t begin = line.find_first_not_of(" \t\r");
    if (begin >= line.size()) continue;
    if (line[begin] == '#') {
      if (!sample.lines.empty()) continue;
      sample.comments =
          text.substr(0, static_cast<size_t>(line.data() - text.data()) + line.size());
      continue;
    }
    sample.lines.push_back(line);
    if (sample.lines.size() == kSampledLines) break;
  }
  return sample;
}

/// A line of a file, as a layout names its columns.
class Line {
 public:
  Line(const Layout& layout, std::string_view text)
      : layout_(layout), cells_(split_cells(text, layout.separators)) {}

  bool is_of_layout() const {
    return (layout_.keyword.empty() || cells_.front() == layout_.keyword) &&
           (std::ranges::find(layout_.widths, width_of(cells_)) != layout_.widths.end() ||
            (layout_.has_points && cells_.size() > layout_.columns.size()));
  }

  // Whether all cells have the kinds of their columns.
  bool has_kinds() const {
    for (const std::string_view column : layout_.columns) {
      const std::string_view cell = text(column);
      const bool is_integer =
          !cell.empty() && cell.find_first_not_of("0123456789") == std::string_view::npos;
      if (is_value(column) && !parse_real(cell) && !is_missing(cell)) return false;
      if (column == "time" && (!parse_real(cell) || (layout_.separators == "," && !is_integer)))
        return false;
      const bool counts =
          column == "frame" || column == "sec" || column == "nsec" || column == "id";
      if (counts && !is_integer) return false;
      if (column == "image" && parse_real(cell)) return false;
    }
    return true;
  }

  // The length of the quaternion; nullopt without one.
  std::optional<double> length() const {
    const auto q = values(kQuaternion);
    return q ? std::optional(length_of(*q)) : std::nullopt;
  }

  bool is_plausible() const {
    const auto matrix = values(kMatrix);
    const auto degrees = values(std::array<std::string_view, 2>{"lat", "lon"});
    const auto turns = values(kTurns);
    return is_length(length().value_or(1)) && (!matrix || is_rotation(*matrix)) &&
           (!turns || are_radians(*turns)) &&
           (!degrees || (std::abs((*degrees)[0]) <= 90 && std::abs((*degrees)[1]) <= 360));
  }

 private:
  std::string_view text(std::string_view column) const {
    const auto at =
        static_cast<size_t>(std::ranges::find(layout_.columns, column) - layout_.columns.begin());
    return at < layout_.columns.size() && at < cells_.size() ? cells_[at] : "";
  }

  template <size_t N>
  std::optional<std::array<double, N>> values(
      const std::array<std::string_view, N>& columns) const {
    std::array<double, N> found{};
    for (size_t i = 0; i < N; ++i) {
      const auto value = parse_real(text(columns[i]));
      if (!value) return std::nullopt;
      found[i] = *value;
    }
    return found;
  }

  const Layout& layout_;
  Columns cells_;
};

// Whether a comment before the lines names one of the layout's columns otherwise.
bool contradicts(const Sample& sample, const Layout& layout) {
  for (std::string_view comment : split_lines(sample.comments)) {
    comment.remove_prefix(std::min(comment.find_first_not_of("# \t"), comment.size()));
    const Columns names = split_cells(comment, layout.separators);
    const size_t count = layout.columns.size();
    const auto known = std::ranges::count_if(std::span(names).first(std::min(count, names.size())),
                                             [](std::string_view name) {
                                               return are_columns({&name, 1});
                                             });
    if (names.size() < count || 2 * known <= std::ssize(layout.columns)) continue;  // a sentence
    for (size_t i = 0; i < layout.columns.size(); ++i)
      for (const std::string_view role :
           {"x", "y", "z", "qx", "qy", "qz", "qw", "nsec", "lat", "lon"})
        if (layout.columns[i] != role && has_columns({std::string(names[i])}, {role})) return true;
  }
  return false;
}

/// How a layout fits a file: its columns may have values that are not plausible.
enum class Fit { none, columns, values };

Fit fit_of(const Layout& layout, const Sample& sample) {
  if (layout.is_table() || sample.comments.find(layout.marker) == std::string_view::npos ||
      contradicts(sample, layout))
    return Fit::none;
  bool is_plausible = false;
  size_t lengths = 0;
  size_t unequal = 0;
  for (const std::string_view text : sample.lines) {
    const Line line(layout, text);
    if (!line.is_of_layout() || !line.has_kinds()) {
      if (lengths == 0 && layout.keyword.empty()) return Fit::none;
      continue;  // the reader refuses it, or skips it
    }
    if (lengths++ == 0) is_plausible = line.is_plausible();
    unequal += std::abs(line.length().value_or(1) - 1) > kLengthTolerance ? 1 : 0;
    if (layout.has_points) break;
  }
  if (lengths == 0) return Fit::none;
  return is_plausible && 2 * unequal <= lengths ? Fit::values : Fit::columns;
}

/// In kapture's records_gnss.txt, x and y are degrees.
bool is_kapture_gnss(const FileStart& start) {
  return has_columns(first_row(start.bytes, kListSeparators), {"x", "y", "utc", "dop"});
}

bool is_table_header(const FileStart& start) {
  const std::vector<std::string> header = first_row(start.bytes, kListSeparators);
  const auto has = [&](std::string_view column) { return has_columns(header, {column}); };
  return has("x") && has("y") && !is_gps_header(header) && !is_kapture_gnss(start) &&
         (has("time") || has("sec") || has("z") || has("image") || has("qw"));
}

/// Layouts of lines that have only numbers.
std::vector<Layout> layouts_by_numbers() {
  const Columns tum = {"time", "x", "y", "z", "qx", "qy", "qz", "qw"};
  const Columns kitti = {"m0", "m1", "m2", "x", "m3", "m4", "m5", "y", "m6", "m7", "m8", "z"};
  const auto after = [](Columns columns, const Columns& others) {
    columns.insert(columns.end(), others.begin(), others.end());
    return columns;
  };
  return {
      {"tum", "time x y z qx qy qz qw", " ", tum, {8}},
      {"rtabmap", "time x y z qx qy qz qw id", " ", tum, {9}},
      {"openvins", "time x y z qx qy qz qw and 12 covariances", " ", tum, {20}},
      {"kitti", "3 x 4 or 4 x 4 matrices", " ", kitti, {12, 16}},
      {"kitti-360", "frame number and matrix", " ", after({"frame"}, kitti), {13, 17}},
      {"4seasons", "CSV time in ns, x, y, z, qx, qy, qz, qw, scale, ...", ",", tum, {11}, "fusion"},
      {"euroc",
       "CSV time in ns, x, y, z, qw, qx, qy, qz, and 0, 3 or 9 more",
       ",",
       {"time", "x", "y", "z", "qw", "qx", "qy", "qz"},
       {8, 11, 17}},
      {"tiers",
       "CSV time in ns, x, y, z, roll, pitch, yaw, qx, qy, qz, qw",
       ",",
       {"time", "x", "y", "z", "roll", "pitch", "skipped", "qx", "qy", "qz", "qw"},
       {11}},
      {"nclt",
       "CSV time in us, x, y, z, roll, pitch, yaw",
       ",",
       {"time", "x", "y", "z", "roll", "pitch", "yaw"},
       {7}},
      {"tartanair", "x y z qx qy qz qw", " ", {"x", "y", "z", "qx", "qy", "qz", "qw"}, {7}},
      {"leica", "CSV time in ns, x, y, z", ",", {"time", "x", "y", "z"}, {4}},
      {"mulran", "CSV time in ns and 3 x 4 matrix", ",", after({"time"}, kitti), {13}},
      {"mulran-gps",
       "CSV time in ns, latitude, longitude, altitude and 9 covariances",
       ",",
       {"time", "lat", "lon"},
       {13}},
      {"newer-college",
       "CSV sec, nsec, x, y, z, qx, qy, qz, qw",
       ",",
       {"sec", "nsec", "x", "y", "z", "qx", "qy", "qz", "qw"},
       {9}}};
}

/// Layouts that words mark: in a comment, in each line, or in a header.
std::vector<Layout> layouts_by_words() {
  return {{.name = "kapture",
           .summary = "trajectories.txt: time, device, qw, qx, qy, qz, x, y, z; world to camera",
           .separators = ",",
           .columns = {"time", "device", "qw", "qx", "qy", "qz", "x", "y", "z"},
           .widths = {9},
           .marker = "kapture",
           .is_world_to_camera = true},
          {.name = "lamar",
           .summary = "trajectories.txt: time, device, qw, qx, qy, qz, x, y, z, covariances",
           .separators = ",",
           .columns = {"time", "device", "qw", "qx", "qy", "qz", "x", "y", "z"},
           .widths = {9, 45},
           .marker = "*covar"},
          {.name = "hloc",
           .summary = "results: image qw qx qy qz x y z; world to camera",
           .separators = " ",
           .columns = {"image", "qw", "qx", "qy", "qz", "x", "y", "z"},
           .widths = {8},
           .is_world_to_camera = true},
          {.name = "g2o",
           .summary = "VERTEX_SE3:QUAT frame x y z qx qy qz qw",
           .separators = " ",
           .columns = {"vertex", "frame", "x", "y", "z", "qx", "qy", "qz", "qw"},
           .widths = {9},
           .keyword = "VERTEX_SE3:QUAT"},
          {.name = "g2o-2d",
           .summary = "VERTEX_SE2 frame x y yaw",
           .separators = " ",
           .columns = {"vertex", "frame", "x", "y", "yaw"},
           .widths = {5},
           .keyword = "VERTEX_SE2"},
          {.name = "colmap",
           .summary = "images.txt: id qw qx qy qz x y z camera name; world to camera",
           .separators = " ",
           .columns = {"id", "qw", "qx", "qy", "qz", "x", "y", "z", "camera", "image"},
           .widths = {10},
           .marker = "IMAGE_ID",
           .is_world_to_camera = true,
           .has_points = true},
          {"table",
           "a header with x, y and z, time, qx to qw, image, ...",
           "",
           {"x", "y", "z", "qx", "qy", "qz", "qw", "time", "sec", "nsec", "frame", "image",
            "heading"}}};
}

}  // namespace

bool is_value(std::string_view column) {
  constexpr std::array<std::string_view, 2> kOthers = {"lat", "lon"};
  const auto is_one_of = [&](const auto& columns) {
    return std::ranges::find(columns, column) != columns.end();
  };
  return is_one_of(kPosition) || is_one_of(kQuaternion) || is_one_of(kMatrix) ||
         is_one_of(kTurns) || is_one_of(kOthers);
}

size_t width_of(std::span<const std::string_view> cells) {
  return cells.size() - (cells.size() > 1 && cells.back().empty() ? 1 : 0);
}

bool Layout::has(std::string_view column) const {
  return std::ranges::find(columns, column) != columns.end();
}

std::span<const Layout> layouts() {
  static const std::vector<Layout> kLayouts = [] {
    std::vector<Layout> all = layouts_by_numbers();
    std::ranges::move(layouts_by_words(), std::back_inserter(all));
    return all;
  }();
  return kLayouts;
}

const Layout* find_layout(std::string_view name) { return find_in(layouts(), name); }

const Layout* detect_layout(const FileStart& start) {
  if (start.is_folder || start.bytes.find('\0') < start.bytes.size()) return nullptr;
  const Sample sample = sample_of(start);
  const Layout* of_columns = nullptr;
  for (const Layout& layout : layouts()) {
    const Fit fit =
        layout.is_table() && is_table_header(start) ? Fit::values : fit_of(layout, sample);
    if (fit == Fit::values) return &layout;
    if (fit == Fit::columns && of_columns == nullptr) of_columns = &layout;
  }
  return of_columns;
}

std::string columns_hint(const FileStart& start) {
  if (is_kapture_gnss(start)) return ": its x and y are degrees. Name these columns lon and lat";
  const std::vector<std::string> cells = first_row(start.first_line + "\n", kListSeparators);
  const auto is_number = [](const std::string& cell) { return parse_real(cell).has_value(); };
  if (cells.size() < 4 || !std::ranges::all_of(cells, is_number)) return "";
  return fmt::format(
      ": its {} columns of numbers fit no layout of trajectories. Add a first line with their "
      "names, "
      "such as time, x, y, z, qx, qy, qz and qw",
      cells.size());
}

}  // namespace vpr
