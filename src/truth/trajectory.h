// Poses of frames: trajectories of SLAM systems and data sets, and their association with frames by
// time, as in evo.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/monitor.h"
#include "truth/dataset.h"
#include "truth/ground_truth.h"

namespace vpr {

/// In meters; either the heading in degrees, or the orientation as a rotation matrix, row by row.
struct Pose {
  std::array<double, 3> position{};
  std::optional<double> heading_deg;
  std::optional<std::array<double, 9>> orientation;
  /// A floor, or a zone of coordinates: other areas are other places. Empty: unknown.
  std::string area = {};
};

/// One entry per frame; nullopt if the pose is unknown.
using Poses = std::vector<std::optional<Pose>>;

/// The number of frames without a pose.
size_t count_unknown(const Poses& poses);

/// The extent of the known poses along each coordinate in meters; minus infinity if all are
/// unknown.
std::array<double, 3> extents_of(const Poses& poses);

/// Degrees between two orientations, 0 to 180: the difference of headings, or the angle of the
/// rotation between two rotation matrices. Nullopt if the two poses have different kinds.
std::optional<double> angle_between(const Pose& a, const Pose& b);

/// Whether headings or orientations are known.
inline bool has_heading(const Pose& pose) { return pose.heading_deg || pose.orientation; }

/// Throws Error(data): a pose has no heading, which an angle of the same place needs.
[[noreturn]] void refuse_angle(const std::string& file, size_t frame);

/// Warns if an angle of the same place can have no effect: if all headings of a file are equal, as
/// unknown ones are, or within 2 pi, as radians are.
void warn_of_headings(const std::string& file, const Poses& poses, const Monitor& monitor);

/// The limits of the same place.
struct Nearness {
  double radius_m = 0;                   ///< of the same place, inclusive
  std::optional<double> angle_deg = {};  ///< larger differences of headings are different places
  std::optional<double> ignore_radius_m =
      {};  ///< beyond the radius, up to this one, pairs are ignored

  double farthest_m() const { return std::max(radius_m, ignore_radius_m.value_or(0)); }
};

/// Throws Error(usage) for limits that are negative or not finite, and for an ignore radius below
/// the radius.
void check_nearness(const Nearness& nearness);

/// The square of the distance in meters; infinite between different areas.
double square_distance(const Pose& a, const Pose& b);

/// Nullopt if an angle is needed, but not known.
std::optional<PlaceLabel> label_of(const Pose& a, const Pose& b, const Nearness& nearness);

/// The poses of one file, by frame.
struct Trajectory {
  std::string name = {};  ///< of the file, for errors
  Poses poses = {};       ///< nullopt if the file has no pose for a frame
  std::vector<size_t> lines =
      {};  ///< line of each pose in the file, counted from 1; empty for a CSV
  std::vector<int64_t> times_ns = {};  ///< one per pose, or empty if the file has no times
  /// Names of the poses' frames, or empty if the file has none.
  std::vector<std::string> names = {};
  /// Columns that may have names (choose_names), each with a cell per pose.
  std::vector<std::vector<std::string>> name_columns = {};
  bool is_on_earth = false;  ///< positions are those of earth_position()
  bool has_heights = true;   ///< false: a CSV without a column z
  bool has_floors = false;   ///< a CSV with a column floor
  bool has_times = false;    ///< of a layout, also if they were not read
};

/// Chooses the names from the columns that may have them: the column that names the most frames, by
/// more than half of its cells. Numbers are names only if each names another frame, and they do not
/// increase, with a warning. Otherwise one of names of image files. `reader`: of the names of the
/// frames; null: unknown. Throws what it throws, if a column may have names.
void choose_names(Trajectory& trajectory, const NameReader& reader, const Monitor& monitor);

/// Warns of consecutive poses that are more than 1 km apart: their coordinates are not meters,
/// other columns, or zeros instead of unknown poses.
void warn_of_steps(const Trajectory& trajectory, const Monitor& monitor);

/// Throws Error(data), with the line, if times do not increase.
void require_rising_times(const Trajectory& trajectory);

/// Reads a trajectory of any layout (truth/layouts.h), a CSV of poses or GPS fixes, which are
/// projected to the plane that touches the earth at the first one. As in all readers of this
/// header, a range may follow the path (PATH@FIRST:LAST[:STEP]). For a file without times, `times`,
/// if not empty, has them: one per line and pose (KITTI's times.txt). Times need not increase.
/// Throws Error(input) if a file cannot be read; Error(data), with the line, if it is damaged;
/// Error(usage) for other files, for a file that names its frames in any order, or if both files
/// have times.
Trajectory read_trajectory(const std::filesystem::path& path, const std::filesystem::path& times);

/// The association of frames with poses.
struct AssociationRules {
  /// maximum distance of a frame to its nearest pose, inclusive; evo's default
  int64_t max_difference_ns = 20'000'000;
  int64_t offset_ns = 0;  ///< added to the times of frames
};

/// One entry per frame: the position on the straight line between the poses before and after its
/// time (before the first and after the last pose, the position of that pose), and heading and
/// orientation of the nearest pose, the earlier one on a tie. Nullopt if the nearest pose is
/// farther away than the maximum difference. Both times must increase; the trajectory must not be
/// empty. One pass over both.
Poses poses_at(const Trajectory& trajectory, std::span<const int64_t> frame_times,
               const AssociationRules& rules);

/// As poses_at, with checks: warns if more than half of the frames have no pose; throws Error(data)
/// with both ranges of times if none has. Both messages include the median difference between
/// frames and their nearest poses. `frames`: a description of the frames.
Poses associate(const Trajectory& trajectory, std::span<const int64_t> frame_times,
                const AssociationRules& rules, const std::string& frames, const Monitor& monitor);

/// A side of a ground truth.
enum class PoseSide { query, train };

/// The options of one side, and its poses.
struct SideOptions {
  const char* name;         ///< as in its flags
  const char* offset_flag;  ///< of the offset
  const std::filesystem::path& poses;
  const TruthSide& files;
};

/// References to parts of `argument`, which must outlive the result.
SideOptions side_options(const GroundTruthArgument& argument, PoseSide side);

/// ", by time within 0.02 s" for a protocol; empty without times of frames. `are_fixes`: the poses
/// are GPS fixes, whose default of --max-difference is larger.
std::string describe_times(const GroundTruthArgument& argument, bool are_fixes = false);

/// The names of the frames of one side: of the images in the options or else `names`, which may be
/// null. Throws Error(usage) if the images are another kind of sequence.
NameReader names_of_side(const TruthSide& files, const NameReader& names);

/// The poses of the frames of one side: by time if the options have the times of frames (as
/// associate() does; poses without a position are removed first); by name if the file has names
/// (without folders, with or without extension), of names_of_side(); otherwise pose i belongs to
/// frame i. Every line must name one of the images in the options; with `names`, lines may name
/// frames of other sequences. Throws as associate() and the readers of times do, Error(usage) for
/// options that lack a required option or have invalid values, and Error(data), with the line, for
/// two lines of one frame, and if no line names a frame.
Poses poses_of_side(const GroundTruthArgument& argument, PoseSide side, Trajectory trajectory,
                    const NameReader& names, const Monitor& monitor);

/// The pose of each training frame, from `path` in any format of read_trajectory, by time if the
/// options have the times of frames; without lines and times. Fixes keep their positions on the
/// earth. Throws as poses_of_side does.
Trajectory read_train_poses(const std::filesystem::path& path, const GroundTruthOptions& options,
                            const NameReader& names, const Monitor& monitor);

}  // namespace vpr
