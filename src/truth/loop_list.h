// Loop closures: lists of them, as SLAM systems print them, and the gap that a loop needs.
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
#include "truth/trajectory.h"

namespace vpr {

/// What names the frames of a list; `automatic`: time stamps if any has a decimal point or an
/// exponent, or if all are beyond the last frame of a trajectory with times; else indices.
enum class LoopFrames { automatic, index, time };
template <>
inline constexpr std::array<std::string_view, 3> kEnumNames<LoopFrames> = {"auto", "index", "time"};

/// A loop closure that somebody claims: two frames of one trajectory, the match the earlier.
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

/// How a list is read.
struct LoopListRules {
  LoopFrames frames = LoopFrames::automatic;
  int64_t max_difference_ns = 20'000'000;  ///< of a time stamp to its pose, bounds included
};

/// A line a loop: query, match and maybe a score, divided by commas or blanks; a header may name
/// the columns query, match and score in any order (others are not looked at); lines that start
/// with # are skipped. Indices count the poses of `trajectory` from 0; a time stamp is the pose
/// nearest to it. Throws Error(input) if the file can't be read; Error(data), naming the line, for
/// a frame that there is not, one without a pose, a time stamp without a pose near it, a match that
/// is not before its query, and a score in some lines only.
LoopList read_loop_list(const std::filesystem::path& path, const Trajectory& trajectory,
                        const LoopListRules& rules);

/// How long before a frame another must be, so that to be at one place closes a loop; bounds
/// included.
struct LoopGap {
  std::optional<int64_t> nanoseconds;  ///< none: `frames`
  size_t frames = 1;
};

/// "30s" or a whole number of frames, above 0. Throws Error(usage), beginning with `flag`, for
/// anything else.
LoopGap parse_loop_gap(const std::string& text, const std::string& flag);

/// Whether frame `match` is at least the gap before frame `query`. `times_ns`, which rise, are
/// only looked at if the gap is one of time.
bool is_past(const LoopGap& gap, std::span<const int64_t> times_ns, size_t query, size_t match);

/// By frame, how many frames from the first on are past. Rises.
std::vector<uint32_t> past_frames(const LoopGap& gap, std::span<const int64_t> times_ns,
                                  size_t frames);

}  // namespace vpr
