#include "truth/layouts.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <opencv2/core.hpp>

#include "base/error.h"
#include "base/named_table.h"
#include "base/rows.h"
#include "base/text.h"
#include "recordings/sequence_source.h"
#include "truth/positions.h"
#include "truth/times.h"

namespace vpr {
namespace {

/// Tolerance for the products of a matrix's rows: files with three digits have errors of 0.002.
constexpr double kRotationError = 0.01;
/// Lengths of quaternions, some of which are not normalized. If more than half of them differ from
/// 1 by more than the tolerance, they are other values.
constexpr double kLeastLength = 0.5;
constexpr double kGreatestLength = 3;
constexpr double kLengthTolerance = 0.1;
/// Lines of a file that are examined for its layout.
constexpr size_t kSampledLines = 200;
/// A frame number is at most this times the number of lines.
constexpr size_t kFramesPerLine = 1000;
/// Positions that move less than this share of the translations do not move at all.
constexpr double kStillShare = 0.01;
/// Keys of GTSAM have a letter in the highest byte.
constexpr size_t kKeyBits = 56;

using Columns = std::vector<std::string_view>;

constexpr std::array<std::string_view, 4> kQuaternion = {"qx", "qy", "qz", "qw"};
constexpr std::array<std::string_view, 9> kMatrix = {"m0", "m1", "m2", "m3", "m4",
                                                     "m5", "m6", "m7", "m8"};
constexpr std::array<std::string_view, 3> kPosition = {"x", "y", "z"};

double length_of(const std::array<double, 4>& q) {
  return std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
}

bool is_length(double length) { return length >= kLeastLength && length <= kGreatestLength; }

// A quaternion x, y, z, w of this length as a matrix.
std::array<double, 9> matrix_of(const std::array<double, 4>& q, double length) {
  const double x = q[0] / length;
  const double y = q[1] / length;
  const double z = q[2] / length;
  const double w = q[3] / length;
  return {1 - 2 * (y * y + z * z), 2 * (x * y - z * w),     2 * (x * z + y * w),
          2 * (x * y + z * w),     1 - 2 * (x * x + z * z), 2 * (y * z - x * w),
          2 * (x * z - y * w),     2 * (y * z + x * w),     1 - 2 * (x * x + y * y)};
}

// Whether the rows are orthonormal and right-handed, up to rounding.
bool is_rotation(const std::array<double, 9>& m) {
  const cv::Matx33d rows(m.data());
  const cv::Matx33d error = rows * rows.t() - cv::Matx33d::eye();
  return cv::norm(error, cv::NORM_INF) <= kRotationError && cv::determinant(rows) > 0;
}

// The pose of a camera whose pose maps the world to it.
void invert(Pose& pose) {
  const cv::Matx33d rotation = cv::Matx33d(pose.orientation->data()).t();
  const cv::Vec3d center = -(rotation * cv::Vec3d(pose.position.data()));
  std::copy_n(rotation.val, 9, pose.orientation->begin());
  std::copy_n(center.val, 3, pose.position.begin());
}

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

// VINS ends its lines with a comma.
size_t width_of(std::span<const std::string_view> cells) {
  return cells.size() - (cells.size() > 1 && cells.back().empty() ? 1 : 0);
}

/// The beginning of a file: its comments and first lines.
struct Sample {
  std::string_view comments = {};  ///< before the first line
  std::string_view comment = {};   ///< the last of them, without its #
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
      sample.comment = line.substr(begin + 1);
      sample.comments =
          text.substr(0, static_cast<size_t>(line.data() - text.data()) + line.size());
      continue;
    }
    sample.lines.push_back(line);
    if (sample.lines.size() == kSampledLines) break;
  }
  return sample;
}

bool is_value(std::string_view column) {
  constexpr std::array<std::string_view, 3> kOthers = {"yaw", "lat", "lon"};
  const auto is_one_of = [&](const auto& columns) {
    return std::ranges::find(columns, column) != columns.end();
  };
  return is_one_of(kPosition) || is_one_of(kQuaternion) || is_one_of(kMatrix) || is_one_of(kOthers);
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
    return is_length(length().value_or(1)) && (!matrix || is_rotation(*matrix)) &&
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

// Whether the comment before the lines names one of the layout's columns otherwise.
bool contradicts(const Sample& sample, const Layout& layout) {
  const Columns names = split_cells(sample.comment, layout.separators);
  if (names.size() < layout.columns.size()) return false;
  for (size_t i = 0; i < layout.columns.size(); ++i)
    for (const std::string_view role :
         {"x", "y", "z", "qx", "qy", "qz", "qw", "nsec", "lat", "lon"})
      if (layout.columns[i] != role && has_columns({std::string(names[i])}, {role})) return true;
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

bool is_table_header(const FileStart& start) {
  const std::vector<std::string> header = first_row(start.bytes, kListSeparators);
  const auto has = [&](std::string_view column) { return has_columns(header, {column}); };
  return has("x") && has("y") && !is_gps_header(header) &&
         (has("time") || has("sec") || has("z") || has("image") || has("qw"));
}

/// The rows of a file by a layout.
class LayoutReader {
 public:
  LayoutReader(const std::filesystem::path& path, const Layout& layout, bool with_times)
      : layout_(layout),
        source_(parse_sequence_argument(path.string())),
        rows_(source_.path, path.string(), rules_of(layout)),
        with_times_(with_times) {
    found_.name = path.string();
    found_.is_on_earth = layout.has("lat");
    found_.has_heights = rows_.has("z") || rows_.has("lat");
  }

  Trajectory read() {
    check_columns();
    TimeReader times(with_times_ ? unit() : std::nullopt);
    const bool by_frame = rows_.has("frame") && !rows_.has("time") && !rows_.has("sec");
    std::set<size_t> listed;
    size_t points = 0;  // the line to skip
    for (size_t index = 0; rows_.next();) {
      if (rows_.line() == points) continue;
      if (!layout_.keyword.empty() && rows_.cells().front() != layout_.keyword) continue;
      if (layout_.has_points) points = rows_.line() + 1;
      check_width();
      size_t frame = by_frame ? frame_number() : index++;
      const auto in_range = frame_in_range(source_.range, frame);
      if (!in_range) continue;
      const auto pose = read_pose();
      if (!by_frame) {
        found_.poses.push_back(pose);
        found_.lines.push_back(rows_.line());
        if (with_times_ && has_time()) found_.times_ns.push_back(read_time(times));
        if (layout_.has_points) found_.names.emplace_back(name());
        continue;
      }
      frame = *in_range;
      if (!listed.insert(frame).second) rows_.fail("frame {} is listed twice", frame);
      if (frame >= std::min(kMaxGrownFrames, kFramesPerLine * (rows_.size() + 1)))
        rows_.fail("frame {} is too large for {}", frame, counted(rows_.size(), "line"));
      found_.poses.resize(std::max(found_.poses.size(), frame + 1));
      found_.poses[frame] = pose;
    }
    check_lengths();
    check_centers();
    found_.has_certain_names = layout_.has_points;
    if (layout_.is_table() && !by_frame) read_names(rows_, source_.range, found_);
    return std::move(found_);
  }

 private:
  static RowRules rules_of(const Layout& layout) {
    const bool is_table = layout.is_table();
    return {.columns = layout.columns,
            .needed = is_table ? 2 : layout.columns.size(),
            .needs_header = is_table,
            .separators = is_table ? kListSeparators : layout.separators,
            .has_others = true,
            .is_ragged = !layout.keyword.empty() || layout.has_points};
  }

  // The names of a table's columns.
  void check_columns() const {
    const auto& header = rows_.header();
    const auto is_w = [](const std::string& name) { return lower_case(name) == "w"; };
    if (layout_.is_table() && !rows_.has("qw") && std::ranges::any_of(header, is_w))
      rows_.fail(
          "its columns x, y, z and w are a quaternion. Rename them qx, qy, qz and qw, and those of "
          "the position x, y and z");
  }

  void check_width() const {
    const size_t width = width_of(rows_.cells());
    if (layout_.is_table() || (layout_.has_points && width > layout_.columns.size()) ||
        std::ranges::find(layout_.widths, width) != layout_.widths.end())
      return;
    rows_.fail("has {} columns, but {} ({}) has {}", width, layout_.name, layout_.summary,
               fmt::join(layout_.widths, ", "));
  }

  bool has_time() const { return rows_.has("time") || rows_.has("sec"); }

  std::optional<TimeUnit> unit() {
    return rows_.has("time") ? unit_of_times(rows_, "time") : TimeUnit::seconds;
  }

  int64_t read_time(TimeReader& times) const {
    if (rows_.has("time")) return times.read(rows_.location(), rows_.text("time"));
    const int64_t seconds = times.read(rows_.location(), rows_.text("sec"));
    return rows_.has("nsec") ? seconds + static_cast<int64_t>(rows_.frame("nsec", 999'999'999))
                             : seconds;
  }

  // The name of a frame in the last column, which may have blanks.
  std::string_view name() const {
    const std::string_view first = rows_.text("image");
    const std::string_view last = rows_.cells().back();
    return {first.data(), static_cast<size_t>(last.data() + last.size() - first.data())};
  }

  size_t frame_number() const {
    const size_t number = rows_.frame("frame");
    return number >> kKeyBits == 0 ? number : number & ((size_t{1} << kKeyBits) - 1);
  }

  std::optional<Pose> read_pose() {
    bool is_known = true;
    for (const std::string_view column : layout_.columns) {
      if (!is_value(column) || !rows_.has(column)) continue;
      if (is_missing(rows_.text(column)))
        is_known = false;
      else
        rows_.real(column);
    }
    if (!is_known) return std::nullopt;
    if (rows_.has("lat")) return fix_pose(rows_);
    Pose pose;
    for (size_t k = 0; k < kPosition.size(); ++k)
      if (rows_.has(kPosition[k])) pose.position[k] = rows_.real(kPosition[k]);
    if (rows_.has("heading") && !is_missing(rows_.text("heading")))
      pose.heading_deg = rows_.real("heading");
    if (rows_.has("yaw")) pose.heading_deg = rows_.real("yaw") * 180 / std::numbers::pi;
    if (rows_.has("qw")) pose.orientation = read_quaternion();
    if (rows_.has("m0")) pose.orientation = read_matrix();
    if (pose.orientation) pose.heading_deg.reset();
    if (!layout_.is_world_to_camera) return pose;
    translations_.push_back(pose);
    invert(pose);
    return pose;
  }

  std::array<double, 9> read_quaternion() {
    std::array<double, 4> q{};
    for (size_t i = 0; i < q.size(); ++i) q[i] = rows_.real(kQuaternion[i]);
    const double length = length_of(q);
    if (!is_length(length))
      rows_.fail(
          "its quaternion has the length {:g} instead of 1, so these columns are others, such as "
          "roll, pitch and yaw. Write nan for an unknown pose, 0 0 0 1 for an unknown orientation",
          length);
    ++quaternions_;
    unequal_ += std::abs(length - 1) > kLengthTolerance ? 1 : 0;
    return matrix_of(q, length);
  }

  std::array<double, 9> read_matrix() const {
    std::array<double, 9> matrix{};
    for (size_t i = 0; i < matrix.size(); ++i) matrix[i] = rows_.real(kMatrix[i]);
    if (!is_rotation(matrix)) rows_.fail("its matrix is not a rotation");
    return matrix;
  }

  void check_lengths() const {
    if (2 * unequal_ > quaternions_)
      rows_.fail(
          "{} of its {} quaternions have another length than 1, so these columns are others, such "
          "as roll, pitch and yaw",
          unequal_, quaternions_);
  }

  void check_centers() const {
    if (translations_.size() < 2) return;
    const auto extent = [](const Poses& poses) {
      const auto [x, y, z] = extents_of(poses);
      return std::hypot(x, y, z);
    };
    if (extent(found_.poses) < kStillShare * extent(translations_))
      rows_.fail(
          "its poses map the world to the camera, as {} defines them, so the camera does not move. "
          "If they are poses of the camera, write them in the layout tum",
          layout_.name);
  }

  const Layout& layout_;
  SequenceArgument source_;
  Rows rows_;
  bool with_times_;
  Trajectory found_ = {};
  Poses translations_ = {};  // of poses that map the world to the camera
  size_t quaternions_ = 0;
  size_t unequal_ = 0;  // quaternions of another length than 1
};

}  // namespace

bool Layout::has(std::string_view column) const {
  return std::ranges::find(columns, column) != columns.end();
}

std::span<const Layout> layouts() {
  static const Columns kTum = {"time", "x", "y", "z", "qx", "qy", "qz", "qw"};
  static const Columns kKitti = {"m0", "m1", "m2", "x",  "m3", "m4",
                                 "m5", "y",  "m6", "m7", "m8", "z"};
  static const auto after = [](Columns first, const Columns& others) {
    first.insert(first.end(), others.begin(), others.end());
    return first;
  };
  static const std::vector<Layout> kLayouts = {
      {"tum", "time x y z qx qy qz qw", " ", kTum, {8}},
      {"rtabmap", "time x y z qx qy qz qw id", " ", kTum, {9}},
      {"openvins", "time x y z qx qy qz qw and 12 covariances", " ", kTum, {20}},
      {"kitti", "3 x 4 or 4 x 4 matrices", " ", kKitti, {12, 16}},
      {"kitti-360", "frame number and matrix", " ", after({"frame"}, kKitti), {13, 17}},
      {"4seasons",
       "CSV time in ns, x, y, z, qx, qy, qz, qw, scale, ...",
       ",",
       kTum,
       {11},
       "fusion"},
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
      {"leica", "CSV time in ns, x, y, z", ",", {"time", "x", "y", "z"}, {4}},
      {"mulran", "CSV time in ns and 3 x 4 matrix", ",", after({"time"}, kKitti), {13}},
      {"mulran-gps",
       "CSV time in ns, latitude, longitude, altitude and 9 covariances",
       ",",
       {"time", "lat", "lon"},
       {13}},
      {"newer-college",
       "CSV sec, nsec, x, y, z, qx, qy, qz, qw",
       ",",
       {"sec", "nsec", "x", "y", "z", "qx", "qy", "qz", "qw"},
       {9}},
      {.name = "kapture",
       .summary = "trajectories.txt: time, device, qw, qx, qy, qz, x, y, z; world to camera",
       .separators = ",",
       .columns = {"time", "device", "qw", "qx", "qy", "qz", "x", "y", "z"},
       .widths = {9},
       .marker = "kapture",
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
  return kLayouts;
}

const Layout* find_layout(std::string_view name) {
  const auto found = std::ranges::find(layouts(), name, &Layout::name);
  return found == layouts().end() ? nullptr : &*found;
}

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
  const std::vector<std::string> cells = first_row(start.first_line + "\n", kListSeparators);
  const auto is_number = [](const std::string& cell) { return parse_real(cell).has_value(); };
  if (cells.size() < 4 || !std::ranges::all_of(cells, is_number)) return "";
  return fmt::format(
      ": its {} columns of numbers fit no layout of trajectories. Add a first line with their "
      "names, "
      "such as time, x, y, z, qx, qy, qz and qw",
      cells.size());
}

void read_names(Rows& rows, const FrameRange& lines, Trajectory& trajectory) {
  const std::vector<std::string>& header = rows.header();
  std::vector<std::set<std::string_view>> texts(header.size());
  std::vector<bool> are_names(header.size(), true);
  const bool is_named = rows.has("image");
  for (size_t row = 0; rows.next(); ++row) {
    if (!frame_in_range(lines, row)) continue;
    if (is_named) trajectory.names.emplace_back(rows.text("image"));
    for (size_t i = 0; i < texts.size() && !is_named; ++i) {
      const std::string_view cell = rows.cells()[i];
      are_names[i] = are_names[i] && !is_missing(cell) && !parse_calendar_time(cell) &&
                     (!parse_real(cell) || !no_number_hint(cell).empty()) &&
                     texts[i].insert(cell).second;
    }
  }
  trajectory.has_certain_names = is_named && !trajectory.names.empty();
  const auto found = std::ranges::find(are_names, true);
  if (is_named || found == are_names.end() || trajectory.poses.size() < 2) return;
  const auto column = static_cast<size_t>(found - are_names.begin());
  for (size_t row = 0; rows.next(); ++row)
    if (frame_in_range(lines, row)) trajectory.names.emplace_back(rows.cells()[column]);
  trajectory.has_certain_names = is_frame_name(trajectory.names.front());
}

Trajectory read_layout(const std::filesystem::path& path, const Layout& layout, bool with_times) {
  return LayoutReader(path, layout, with_times).read();
}

}  // namespace vpr
