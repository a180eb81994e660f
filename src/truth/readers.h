// The readers and writers of all ground truth formats (frame numbers, matrices and poses), and the
// builder to which readers pass the pairs: it checks them and limits sizes.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/error.h"
#include "base/monitor.h"
#include "base/rows.h"
#include "truth/formats.h"
#include "truth/ground_truth.h"
#include "truth/trajectory.h"

namespace vpr {

/// The maximum number of examples per kind of problem.
inline constexpr size_t kMaxExamples = 5;

/// The treatment of pairs that are out of range or contradict each other.
enum class InconsistentPairs { refuse, count };

/// The number of frames of one side. If it grows, the largest index in the file determines it.
struct FrameCount {
  size_t frames = 0;
  bool grows = false;

  std::optional<size_t> known() const { return grows ? std::nullopt : std::optional(frames); }
};

/// The index of the only searched sequence. Throws Error(usage) if there are several or none:
/// `what` needs exactly one.
size_t only_searched_sequence(const GroundTruthScope& scope, std::string_view what);

/// Collects the pairs of a reader: checks indices and labels, and counts inconsistencies.
class GroundTruthBuilder {
 public:
  /// `format`: the name of the file's format.
  GroundTruthBuilder(const GroundTruthArgument& argument, std::string_view format,
                     const GroundTruthScope& scope, InconsistentPairs inconsistent,
                     const Monitor& monitor);

  const GroundTruthArgument& argument() const { return argument_; }
  std::string_view format() const { return format_; }
  const GroundTruthScope& scope() const { return scope_; }
  const FrameCount& query() const { return query_; }
  const FrameCount& train(size_t sequence) const { return train_[sequence]; }

  /// As only_searched_sequence.
  size_t only_searched(std::string_view what) const { return only_searched_sequence(scope_, what); }
  /// Throws Error(data) if the name is empty, or if no sequence has it.
  size_t find_sequence(std::string_view name);
  /// Checks the number of frames that the file states. Throws Error(data) if it differs.
  void require_query_frames(size_t frames);
  void require_train_frames(size_t sequence, size_t frames) {
    require_frames(train_[sequence], "training", frames);
  }

  /// Sets the current position of the reader for errors; initially the whole file. Throws
  /// Error(interrupted) on a stop, because it is called often.
  void at(std::string_view unit, size_t number) {
    check_stop();
    location_.at(unit, number);
  }
  void check_stop() const { vpr::check_stop(monitor_); }
  void at_file(const std::filesystem::path& path) { location_ = {path.string()}; }
  template <class... Values>
  [[noreturn]] void fail(fmt::format_string<Values...> what, Values&&... values) const {
    location_.fail(fmt::format(what, std::forward<Values>(values)...));
  }
  const Monitor& monitor() const { return monitor_; }
  /// Sets the frames of a file that are query frames. Throws Error(data) for another number of
  /// frames than the query has.
  void set_query_range(const SequenceArgument& source);

  /// Labels references first .. last of `sequence`. Accepts any indices; those out of range are
  /// refused or counted.
  void add(size_t query, size_t sequence, size_t first, size_t last, PlaceLabel label);
  /// A `same` pair whose reference may be after the last frame: frames within the tolerance of it
  /// are labeled.
  void add_beyond_end(size_t query, size_t sequence, size_t reference);
  /// Reports an index `text` that is out of range and cannot become a pair.
  void report_out_of_range(std::string_view what, std::string_view text, const FrameCount& side);

  /// GroundTruth::asked: one entry per query frame; person_labels and is_sample.
  void set_labels(std::vector<std::vector<GroundTruth::Pair>> asked,
                  std::vector<PersonLabel> labels, bool is_sample) {
    asked_ = std::move(asked);
    labels_ = std::move(labels);
    is_sample_ = is_sample;
  }

  /// Sorts the pairs, joins them to runs and checks them. `protocol`: a description for reports.
  InspectedGroundTruth finish(std::string protocol);

 private:
  void require_frames(FrameCount& side, std::string_view name, size_t frames);
  void note(FindingKind kind, uint64_t count, const std::string& what);
  bool accept(size_t index, FrameCount& side, std::string_view what);
  void append(size_t query, const GroundTruth::Pair& pair);
  void report_overlaps(size_t query, std::span<const GroundTruth::Pair> kept,
                       const GroundTruth::Pair& pair);
  void join(size_t query);

  const GroundTruthArgument& argument_;
  std::string_view format_;
  GroundTruthScope scope_;
  InconsistentPairs inconsistent_;
  Monitor monitor_;
  std::string query_hint_;
  FrameCount query_;
  std::vector<FrameCount> train_;
  std::vector<std::vector<GroundTruth::Pair>> pairs_;
  std::vector<std::vector<GroundTruth::Pair>> asked_;
  std::vector<PersonLabel> labels_;
  bool is_sample_ = false;
  size_t runs_ = 0;
  FileLocation location_;
  std::array<GroundTruthFinding, 3> findings_;
};

/// Checks a size before writing. Throws Error(data) if there are more than `most` of `what`, such
/// as "pairs".
void require_writable(uint64_t count, uint64_t most, std::string_view what);

/// Header query,reference[,label] or query,sequence,reference[,label]; label "same" (default) or
/// "ignore"; unlisted pairs are different. A frame is a number or, if the scope has names, the name
/// of its file, with or without extension. Digits are numbers, unless every cell of the column is
/// the name of a frame. Requires exactly one searched
/// sequence if there is no sequence column. The path may end in a range (pairs.csv@60:111), which
/// selects the query's frames with its step; other pairs are skipped. Throws Error(data), with the
/// line. Pairs in memory (GroundTruthArgument::pairs) are read instead; errors have their index.
std::string read_pairs(GroundTruthBuilder& builder);

/// One pair per line, with the tolerance applied; writes the columns sequence and label only if
/// needed.
void write_pairs_csv(const InspectedGroundTruth& ground_truth, Output& file,
                     const Monitor& monitor);

/// Header query,reference,label,tolerance or query,sequence,reference,label,tolerance, by frame
/// numbers. "same" labels the pair and references at most `tolerance` frames away, "different" the
/// pair only; all other pairs are unknown. Throws Error(data), with the line, without rows, for
/// frames out of range and for pairs with both labels; Error(usage) if the number of query frames
/// is not known.
std::string read_labels(GroundTruthBuilder& builder);

/// The marked places (read_marked_places) of a FAB-MAP database, by their order: a place is the
/// same for the query frames of its visits and different for all others, except that as many frames
/// again on both sides of a visit are ignored. Throws Error(usage) if the number of query frames is
/// not known, and Error(data) for another number of places than the database has and for frames out
/// of range.
std::string read_places(GroundTruthBuilder& builder);

/// A CSV query,anchor or query,sequence,anchor (or reference for anchor): anchors, with increasing
/// query frames for each training sequence. A query frame between two neighboring anchors of a
/// sequence is at the training frame found by linear interpolation, rounded (ties up); before the
/// first and after the last anchor it has no place. `same` are training frames within the tolerance
/// and, if the argument has a `reference` (poses of the training sequence, a CSV frame,x,y or a
/// trajectory) and a radius, all frames within that many meters of the interpolated position;
/// training frames without a pose are then ignored. A range after the path is the range of the
/// query. Throws Error(data), with the line, for query frames that do not increase and for frames
/// out of range; Error(usage) for a radius without poses, or poses without a radius.
std::string read_anchors(GroundTruthBuilder& builder);

/// Query frame i is training frame step * i (argument: train_step, default 1), rounded to
/// nearest, ties up. Frames beyond the training sequence match its end within the tolerance.
/// Requires exactly one searched sequence.
std::string read_aligned(GroundTruthBuilder& builder);

/// Reads a .npy matrix of 0 and 1 (bool, integers or floats) in C or Fortran order, whose rows are
/// query frames, and optionally a second one of the same shape (argument: soft), whose ones are
/// ignored if the first has 0. Or a .npz file with both, named GThard and GTsoft, whose rows are
/// training frames, as in VPR_Tutorial's data sets (Schubert et al. 2023); a .npz file with a
/// single matrix is read like a .npy file. The argument's matrix_rows overrides this, and so does a
/// shape that only fits transposed. Reads row by row, without the whole matrix in memory. Requires
/// exactly one searched sequence. Throws Error(data) for another shape, a value that is neither 0
/// nor 1, or damage.
std::string read_matrix_file(GroundTruthBuilder& builder);

/// Whether it is a .npy file of numbers or a zip archive.
bool is_matrix_file(const FileStart& start);

/// Writes bool matrices: to a .npz file GThard and GTsoft (rows training frames; soft: same or
/// ignored), otherwise a .npy matrix (rows query frames; ignored becomes different).
void write_matrix_file(const InspectedGroundTruth& ground_truth, Output& file,
                       const Monitor& monitor);

/// Labels every pair of a query frame and a frame of `sequence`: `same` if the distance is at most
/// the argument's radius_m and, if angle_deg is set, the angle is at most angle_deg (both
/// inclusive); `ignore` if a pose is unknown. `default_radius_m`: the radius in the format's own
/// protocol, if the argument has none. Warns if more than a tenth of all pairs of known poses are
/// the same, and if the two sides have floors or zones, but none in common. Throws Error(data) if
/// the numbers of poses and frames differ, Error(usage) for an invalid radius or angle, and if
/// there is no radius. Returns the protocol as text. References are sorted by one coordinate, so
/// that only nearby ones are compared. Query frames in `unplaced`, which is empty or has one entry
/// per frame, are different from all references.
std::string match_poses(GroundTruthBuilder& builder, size_t sequence, const Poses& query,
                        const Poses& train, std::optional<double> default_radius_m,
                        const std::vector<bool>& unplaced = {});

/// Readers of poses. All take the query's poses from the argument's path and the training
/// sequence's from its `reference`, each with a range of frames (PATH@FIRST:LAST[:STEP]) if the
/// sequence had one; all require exactly one searched sequence and use match_poses(). Throw
/// Error(data), with the line.

/// CSV with columns frame, x, y and optionally heading, in meters and degrees (read_pose_csv).
/// Pairs with a frame without a line are ignored.
std::string read_poses(GroundTruthBuilder& builder);

/// Trajectories in layouts of truth/layouts.h, which may differ between the sides. Poses are
/// associated by time or by name (poses_of_side); otherwise pose i belongs to frame i, and times
/// are ignored.
std::string read_trajectories(GroundTruthBuilder& builder);

/// GPS fixes (read_fixes), by time or name as for trajectories. Distances are straight lines
/// between points on the ellipsoid, without heights. Warns if more than half of the frames of a
/// side have no fix; throws Error(data) if none has, and as the readers do.
std::string read_gps(GroundTruthBuilder& builder);

/// A name in the format of the field's data sets:
/// @east@north@zone@letter@latitude@longitude@pano@tile@heading@..., of which east and north (UTM,
/// meters) are required and the rest may be empty or missing. Nullopt for other names. The area is
/// the UTM zone, 1 to 60; empty if missing or invalid.
std::optional<Pose> parse_utm_name(std::string_view file_name);

/// The argument's path is the query, its `reference` the training sequence: folders or lists, as
/// passed to vpr-query and vpr-train, with positions as names. Images within a radius (default 25
/// m) show the same place. In several zones, distances are those of gps if every image has its zone
/// and band; otherwise zones that do not touch show different places. Images whose position is nan
/// have no pose. Throws Error(data) for a name without coordinates, for zones that touch without
/// bands, or if the numbers of images and frames differ.
std::string read_utm_names(GroundTruthBuilder& builder);

/// A folder, or a list whose first image has a UTM name.
bool is_utm_names(const FileStart& start);

}  // namespace vpr
