// Loop closures: lists of any SLAM system, judged by a trajectory.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/enum_names.h"
#include "evaluate/metrics.h"
#include "query/result.h"
#include "truth/ground_truth.h"
#include "truth/trajectory.h"

namespace vpr {

/// How a list identifies frames. `automatic`: time stamps if any has a decimal point or an
/// exponent, or if all are beyond the last frame of a trajectory with times; otherwise indices.
enum class LoopFrames { automatic, index, time };
template <>
inline constexpr std::array<std::string_view, 3> kEnumNames<LoopFrames> = {"auto", "index", "time"};

/// A reported loop closure: two frames of one trajectory; the match is earlier than the query.
struct ListedLoop {
  size_t query = 0;
  size_t match = 0;
  std::optional<double> score;
  size_t line = 0;  ///< in the file, counted from 1
};

/// A list in the order of its file.
struct LoopList {
  std::vector<ListedLoop> loops;
  bool has_scores = false;
};

struct LoopListRules {
  LoopFrames frames = LoopFrames::automatic;
  /// maximum distance of a time stamp to its pose, inclusive
  int64_t max_difference_ns = 20'000'000;
};

/// One loop per row: query, match and optionally a score, in this order or as a header names them.
/// Indices count the poses of `trajectory` from 0; a time stamp refers to the nearest pose. Throws
/// Error(input) if the file cannot be read; Error(data), with the line, for a frame that does not
/// exist or has no pose, a time stamp without a pose nearby, a match that is not before its query,
/// and a score in only some of the lines.
LoopList read_loop_list(const std::filesystem::path& path, const Trajectory& trajectory,
                        const LoopListRules& rules);

/// Parses "30s" or a positive integer number of frames. Throws Error(usage), beginning with `flag`,
/// for other text.
LoopGap parse_loop_gap(const std::string& text, const std::string& flag);

/// The end of a warning, "excludes no frame, because ...", if a gap in time is less than the step
/// between most frames, or if at most a twentieth of the frames has an earlier one; otherwise
/// empty. `times_ns` may be empty for a gap in frames.
std::string gap_fault(const LoopGap& gap, std::span<const int64_t> times_ns, size_t frames);

struct LoopRules {
  Nearness nearness;  ///< of the two poses
  LoopGap gap;
  ScoreOrder order = ScoreOrder::similarity;  ///< of the list's scores
};

/// A listed loop. Its label is ignore if the gap is too short, or up to the ignore radius.
struct JudgedLoop {
  ListedLoop loop;
  double distance_m = 0;  ///< infinite between floors
  PlaceLabel label = PlaceLabel::different;
  bool is_too_near = false;  ///< the gap is too short
};

/// Consecutive frames that are near an earlier one.
struct Revisit {
  size_t first = 0;
  size_t last = 0;
  bool is_found = false;  ///< a correct loop of the list begins at one of them

  bool operator==(const Revisit&) const = default;
};

/// A list judged by its trajectory.
struct LoopJudgment {
  std::vector<JudgedLoop> loops;  ///< in the order of the file, without repetitions
  size_t repeated = 0;
  std::vector<bool> has_loop;     ///< by frame: it is near an earlier one
  std::vector<bool> is_found;     ///< by frame: a correct loop of the list begins there
  std::vector<Revisit> revisits;  ///< in the order of frames
  /// If the list has scores: the best loop of each query, ties to the first of the file, without
  /// those to ignore. Recall is over the frames near an earlier one.
  std::optional<Curve> curve;

  uint64_t count(PlaceLabel label) const {
    return std::ranges::count(loops, label, &JudgedLoop::label);
  }
  uint64_t too_near() const { return std::ranges::count(loops, true, &JudgedLoop::is_too_near); }
  uint64_t frames_with_loop() const { return std::ranges::count(has_loop, true); }
  uint64_t frames_found() const { return std::ranges::count(is_found, true); }
  uint64_t revisits_found() const { return std::ranges::count(revisits, true, &Revisit::is_found); }
  /// The longest run of consecutive frames with a loop but without a found one, ties to the first.
  std::optional<Revisit> longest_missed() const;
};

/// By frame, whether an earlier frame, by at least the gap, shows the same place. False for frames
/// without a pose. Times must increase for a gap in time.
std::vector<bool> frames_with_loop(const Trajectory& trajectory, const LoopRules& rules);

/// Throws Error(usage) for invalid limits, Error(data) for an angle if a pose has no heading or
/// orientation, and Error(usage) for a gap in seconds if the trajectory has no
/// times.
LoopJudgment judge_loops(const LoopList& list, const Trajectory& trajectory,
                         const LoopRules& rules);

/// The best match of each query window of a result of vpr-query loops: the anchors of both windows
/// and the score per frame. With a threshold or a margin, only recognitions; of FAB-MAP all, with
/// probabilities. Line numbers are those of loops_csv.
std::vector<ListedLoop> loops_of(const Result& result);

/// The same as a list. `name`: of the result, for errors. Throws Error(data) for a result of
/// another query than the trajectory's, and for a loop of a frame without a pose.
LoopList loop_list_of(const Result& result, const std::string& name, const Trajectory& trajectory);

/// The input format of `vpr-eval --loops`: the header query,match,score and one line per loop.
std::string loops_csv(const std::vector<ListedLoop>& loops);

}  // namespace vpr
