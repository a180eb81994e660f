// Loop closures: lists of any SLAM system, and how right they are against one trajectory.
#pragma once

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
#include "decide/result.h"
#include "evaluate/outcomes.h"
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
  std::string name;  ///< of the file, for errors
  std::vector<ListedLoop> loops;
  bool is_by_time = false;
  bool has_scores = false;
};

struct LoopListRules {
  LoopFrames frames = LoopFrames::automatic;
  /// maximum distance of a time stamp to its pose, inclusive
  int64_t max_difference_ns = 20'000'000;
};

/// One loop per line: query, match and optionally a score, separated by commas or blanks. A header
/// may name the columns query, match and score in any order; other columns and lines that start
/// with # are skipped. Indices count the poses of `trajectory` from 0; a time stamp refers to the
/// nearest pose. Throws Error(input) if the file cannot be read; Error(data), with the line, for a
/// frame that does not exist or has no pose, a time stamp without a pose nearby, a match that is
/// not before its query, and a score in only some of the lines.
LoopList read_loop_list(const std::filesystem::path& path, const Trajectory& trajectory,
                        const LoopListRules& rules);

/// The minimum separation of two frames of one place that close a loop, inclusive.
struct LoopGap {
  std::optional<int64_t> nanoseconds;  ///< unset: `frames`
  size_t frames = 1;
};

/// Parses "30s" or a positive integer number of frames. Throws Error(usage), beginning with `flag`,
/// for other text.
LoopGap parse_loop_gap(const std::string& text, const std::string& flag);

/// Whether frame `match` is before frame `query` by at least the gap. `times_ns`, which increase,
/// are used only for a gap in time.
bool is_past(const LoopGap& gap, std::span<const int64_t> times_ns, size_t query, size_t match);

/// For each frame, the number of frames from the first on that are past. Non-decreasing.
std::vector<uint32_t> past_frames(const LoopGap& gap, std::span<const int64_t> times_ns,
                                  size_t frames);

/// What is a loop.
struct LoopRules {
  double radius_m = 0;  ///< meters between the two positions at most, bounds included
  LoopGap gap;
  ScoreOrder order = ScoreOrder::similarity;  ///< of the list's scores
};

/// A loop of the list as judged: same, different, or to be ignored since the gap is too short.
struct JudgedLoop {
  ListedLoop loop;
  double distance_m = 0;
  PlaceLabel label = PlaceLabel::different;
};

/// Consecutive frames that are near an earlier one.
struct Revisit {
  size_t first = 0;
  size_t last = 0;
  bool is_found = false;  ///< a loop of the list that is right begins at one of them

  bool operator==(const Revisit&) const = default;
};

/// A list against its trajectory.
struct LoopJudgment {
  std::vector<JudgedLoop> loops;  ///< in the file's order; pairs that are repeated are left out
  size_t repeated = 0;
  std::vector<bool> has_loop;     ///< by frame: it is near an earlier one
  std::vector<bool> is_found;     ///< by frame: a loop of the list that begins there is right
  std::vector<Revisit> revisits;  ///< in the order of frames
  /// Where the list has scores: every query's best loop (of equals the first of the file), those
  /// to be ignored left out, against the frames that have one.
  std::optional<Curve> curve;

  uint64_t count(PlaceLabel label) const;
  uint64_t frames_with_loop() const;
  uint64_t frames_found() const;
  uint64_t revisits_found() const;
  /// The longest stretch of consecutive frames with a loop of which none is found, of equals the
  /// first; nothing where all are.
  std::optional<Revisit> longest_missed() const;
};

/// Meters between the positions of two frames that have poses.
double distance_between(const Trajectory& trajectory, size_t a, size_t b);

/// By frame, whether a frame at least the gap before is within the radius. Positions are sorted
/// into cubes of the radius, so that only those near a frame are compared. Frames without a pose
/// have none. Times, where the gap is one, must rise.
std::vector<bool> frames_with_loop(const Trajectory& trajectory, const LoopRules& rules);

/// Throws Error(usage) for a radius that is none, and for a gap in seconds where the trajectory has
/// no times.
LoopJudgment judge_loops(const LoopList& list, const Trajectory& trajectory,
                         const LoopRules& rules);

/// The best match of each query window, as last frames of both and the score a frame; where a
/// threshold or a margin was set, those that are recognitions. Of FAB-MAP all, by probability.
/// Lines are those of loops_csv. The result must be one of --loop.
std::vector<ListedLoop> loops_of(const Result& result);

/// The same as a list under a name, for a trajectory. Throws Error(data) for a result that has no
/// loops, or has not as many frames as the trajectory poses, and for a loop of a frame without one.
LoopList loop_list_of(const Result& result, const std::string& name, const Trajectory& trajectory);

/// As `vpr-eval --loops` reads it: the header query,match,score, and a line a loop.
std::string loops_csv(const std::vector<ListedLoop>& loops);

}  // namespace vpr
