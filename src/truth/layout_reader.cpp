// The reader of all layouts.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/column_names.h"
#include "base/text.h"
#include "recordings/sequence_source.h"
#include "truth/layouts.h"
#include "truth/positions.h"
#include "truth/rotations.h"
#include "truth/times.h"

namespace vpr {
namespace {

/// Positions that move less than this share of the translations do not move at all.
constexpr double kStillShare = 0.01;
/// Keys of GTSAM have a letter in the highest byte.
constexpr size_t kKeyBits = 56;

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
    found_.has_times = has_time();
  }

  Trajectory read() {
    check_columns();
    TimeReader times(with_times_ ? unit() : std::nullopt);
    const bool by_frame = rows_.has("frame") && !has_time();
    std::set<size_t> listed;
    size_t points = 0;  // the line after a pose
    for (size_t index = 0; rows_.next();) {
      if (rows_.line() == points && has_points()) continue;
      if (!layout_.keyword.empty() && rows_.cells().front() != layout_.keyword) continue;
      if (layout_.has_points) points = rows_.line() + 1;
      check_width();
      check_device();
      size_t frame = by_frame ? frame_number() : index++;
      const auto in_range = frame_in_range(source_.range, frame);
      if (!in_range) continue;
      const auto pose = read_pose();
      if (!by_frame) {
        found_.poses.push_back(pose);
        found_.lines.push_back(rows_.line());
        if (with_times_ && has_time()) found_.times_ns.push_back(read_time(times));
        if (has_names_) found_.names.emplace_back(name());
        continue;
      }
      frame = *in_range;
      if (!listed.insert(frame).second) rows_.fail("frame {} is listed twice", frame);
      if (frame >= most_frames_of(rows_.size()))
        rows_.fail("frame {} is too large for {}", frame, counted(rows_.size(), "line"));
      found_.poses.resize(std::max(found_.poses.size(), frame + 1));
      found_.poses[frame] = pose;
    }
    check_lengths();
    check_centers();
    if (!layout_.is_world_to_camera) check_meters(rows_, found_);
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
    const auto is_end = [](const std::string& name) {
      return lower_case(name).starts_with("destination_timestamp");
    };
    if (layout_.is_table() && std::ranges::any_of(header, is_end))
      rows_.fail(
          "its lines are motions between two times, not positions. Use the positions of the data "
          "set, such as ins.csv or gps.csv");
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
    const Layout* detected = open_start(source_.path).layout;
    rows_.fail("has {} columns, but {} ({}) has {}{}", width, layout_.name, layout_.summary,
               fmt::join(layout_.widths, ", "),
               detected == nullptr || detected == &layout_
                   ? ""
                   : fmt::format(". Its layout is {}", detected->name));
  }

  // A file of several cameras has several poses at one time.
  void check_device() {
    if (!rows_.has("device")) return;
    const std::string_view device = rows_.text("device");
    if (device_.empty()) device_ = device;
    if (device != device_)
      rows_.fail(
          "is a pose of the device {}, earlier lines are of {}. Keep the lines of one device",
          device, device_);
  }

  bool has_time() const { return rows_.has("time") || rows_.has("sec"); }

  // Beside the two parts of a message's own stamp, a time is the one at which it was recorded.
  bool has_whole_times() const {
    return rows_.has("time") && !(rows_.has("sec") && rows_.has("nsec"));
  }

  std::optional<TimeUnit> unit() {
    return has_whole_times() ? unit_of_times(rows_, "time") : TimeUnit::seconds;
  }

  int64_t read_time(TimeReader& times) const {
    if (has_whole_times()) return times.read(rows_.location(), rows_.text("time"));
    const int64_t seconds = times.read(rows_.location(), rows_.text("sec"));
    return rows_.has("nsec") ? seconds + static_cast<int64_t>(rows_.frame("nsec", 999'999'999))
                             : seconds;
  }

  // Points are triples of numbers, but a pose ends with a name.
  bool has_points() const {
    return rows_.cells().size() % 3 == 0 && parse_real(rows_.cells().back());
  }

  // The name of a frame, which may have blanks in the last column.
  std::string_view name() const {
    const std::string_view first = rows_.text("image");
    if (layout_.columns.back() != "image") return first;
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
    if (rows_.has("roll") && rows_.has("yaw")) pose.orientation = read_turns();
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

  std::array<double, 9> read_turns() const {
    const std::array<double, 3> turns = {rows_.real("roll"), rows_.real("pitch"),
                                         rows_.real("yaw")};
    if (!are_radians(turns))
      rows_.fail("roll, pitch and yaw are {:g}, {:g} and {:g}, but radians are at most 6.28",
                 turns[0], turns[1], turns[2]);
    return matrix_of(turns);
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
  bool has_names_ = layout_.has("image") && !layout_.is_table();
  Trajectory found_ = {};
  Poses translations_ = {};  // of poses that map the world to the camera
  std::string device_ = {};
  size_t quaternions_ = 0;
  size_t unequal_ = 0;  // quaternions of another length than 1
};

// Whether a cell is a number that names neither a frame nor its time: a negative one, or one with a
// point and few digits before it.
bool is_measurement(std::string_view cell) {
  constexpr size_t kClock = 10;  // digits of seconds since 1970
  return parse_real(cell) &&
         (cell.starts_with('-') || (cell.find('.') < std::min(cell.size(), kClock)));
}

}  // namespace

void read_names(Rows& rows, const FrameRange& lines, Trajectory& trajectory) {
  if (rows.has("image")) {
    for (size_t row = 0; rows.next(); ++row)
      if (frame_in_range(lines, row)) trajectory.names.emplace_back(rows.text("image"));
    return;
  }
  static const std::vector<std::string_view> kPoseColumns = {
      "x",   "y",   "z",       "qx",    "qy",    "qz",  "qw",
      "lat", "lon", "heading", "floor", "score", "sec", "nsec"};
  const auto may_have_names = [&](size_t column) {
    const std::string& name = rows.header()[column];
    const std::string_view cell = rows.cells()[column];
    return !name.empty() && !is_measurement(cell) && !parse_calendar_time(cell) &&
           std::ranges::none_of(kPoseColumns, [&](std::string_view known) {
             return parse_column_name(name, known).has_value();
           });
  };
  std::vector<size_t> columns;
  for (size_t row = 0; rows.next(); ++row) {
    for (size_t i = 0; row == 0 && i < rows.header().size(); ++i)
      if (may_have_names(i)) columns.push_back(i);
    trajectory.name_columns.resize(columns.size());
    for (size_t i = 0; i < columns.size() && frame_in_range(lines, row); ++i) {
      const std::string_view cell = rows.cells()[columns[i]];
      trajectory.name_columns[i].emplace_back(is_missing(cell) ? "" : cell);
    }
  }
}

Trajectory read_layout(const std::filesystem::path& path, const Layout& layout, bool with_times) {
  return LayoutReader(path, layout, with_times).read();
}

}  // namespace vpr
