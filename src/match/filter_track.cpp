#include "match/filter_track.h"

#include <algorithm>
#include <cmath>

#include "match/row_kernels.h"

namespace vpr {
namespace {

// Mean distances of paths as shares of the typical distance of training frames: paths in other
// buildings are seldom closer than kFar; a path above kFarthest has no margin
// (docs/benchmarks/why-these-defaults.md).
constexpr double kNear = 0.5;
constexpr double kFar = 0.8;
constexpr double kFarthest = 1.05;

// The share of the keyframes that must advance.
constexpr double kLeastAdvances = 0.25;

// Added to that share, and subtracted from the margin, of a path at kFar; in proportion from kNear.
constexpr double kFarAdvances = 0.5;
constexpr double kFarMargin = 4.0 * kScoreUnit;

constexpr size_t kFewKeyframes = 6;  // fewer do not determine the rate

// Evidence by which another pass must be better, in units of values.
constexpr uint32_t kOtherPass = 5 * kScoreUnit;

// The margin that establishes a path, in units of values.
constexpr uint32_t kEstablished = 5 * kScoreUnit;

// A path begins where it advances by this number of places over the next path_keyframes / 2: half
// the speed advances by one more. Views before the first trained one resemble it, and stand there.
constexpr int64_t kHeadAdvance = 3;
constexpr size_t kHeadStand = 3;  // keyframes at one place, at its beginning

size_t difference(size_t a, size_t b) { return std::max(a, b) - std::min(a, b); }

// The smallest value of cells [first, last).
uint32_t least_of(const FilterState& state, size_t first, size_t last) {
  return first < last ? minimum_of(std::span(state.values).subspan(first, last - first)) : kNoValue;
}

/// The other passes of the place of a cell. Passes are at least 2 path_keyframes apart.
struct OtherPasses {
  CellRange first_passes;
  CellRange own;  ///< trained cells of the pass of the cell
};

OtherPasses other_passes(const PathTrack& track, const FilterCells& cells, size_t cell) {
  const size_t near = 2 * track.settings.near_keyframes;  // first passes are noisy
  const size_t own = cells.trained_cell(cell);
  return {same_place(cells, cell, near), {own - std::min(own, near), own + near + 1}};
}

bool contains(const OtherPasses& passes, const FilterCells& cells, size_t cell) {
  const size_t trained = cells.trained_cell(cell);
  return passes.first_passes.contains(cells.first_passes[trained]) && !passes.own.contains(trained);
}

// The same without other passes of the place of `cell` in its direction.
uint32_t least_elsewhere(const PathTrack& track, const FilterState& state, size_t cell,
                         size_t first, size_t last) {
  const FilterCells& cells = state.cells;
  if (cells.first_passes.empty() || cells.is_decoy(first) != cells.is_decoy(cell))
    return least_of(state, first, last);
  const OtherPasses passes = other_passes(track, cells, cell);
  uint32_t least = kNoValue;
  for (size_t other = first; other < last; ++other)
    if (state.values[other] < least && !contains(passes, cells, other)) least = state.values[other];
  return least;
}

// The first cell of [first, last) with the smallest value.
size_t best_of(const FilterState& state, size_t first, size_t last) {
  const uint32_t least = least_of(state, first, last);
  return find_below(std::span(state.values).first(last), first, least + 1);
}

bool is_in_pass(const PathTrack& track, const FilterCells& cells, size_t cell, size_t last) {
  return difference(cell, last) <= track.settings.near_keyframes &&
         run_of(cells, cell).sequence == run_of(cells, last).sequence;
}

bool is_other_pass(const PathTrack& track, const FilterCells& cells, size_t cell, size_t last) {
  return !cells.first_passes.empty() && contains(other_passes(track, cells, last), cells, cell);
}

// The best place in the pass of the path, or, with much more evidence, in another one.
size_t chosen_pass(const PathTrack& track, const FilterState& state, size_t best) {
  const size_t near = track.settings.near_keyframes;
  const size_t last = track.recent.back().cell;
  const CellStretch& run = run_of(state.cells, last);
  const size_t in_pass = best_of(state, std::max(run.first, last - std::min(last, near)),
                                 std::min(run.first + run.count, last + near + 1));
  return state.values[in_pass] <= state.values[best] + kOtherPass ? in_pass : best;
}

// The place before a step to `cell`. kLongestStep cells before a run are not places.
size_t place_before(const std::vector<uint32_t>& values, size_t cell) {
  const auto first = values.begin() + static_cast<ptrdiff_t>(cell - kLongestStep);
  return cell - kLongestStep +
         static_cast<size_t>(std::min_element(first, first + kLongestStep + 1) - first);
}

/// A place, and the recent keyframe from which its path continues.
struct NextPlace {
  size_t cell = 0;
  const PathKeyframe* from = nullptr;  ///< null: the path begins
  size_t age = 1;                      ///< of `from`, in keyframes
  bool is_in_pass = false;             ///< of `from`
};

NextPlace next_place(const PathTrack& track, const FilterState& state, size_t best) {
  const FilterCells& cells = state.cells;
  const size_t recent = track.recent.size();
  if (recent == 0) return {best};
  const PathKeyframe& last = track.recent.back();
  if (is_in_pass(track, cells, best, last.cell)) return {best, &last, 1, true};
  if (is_other_pass(track, cells, best, last.cell)) {
    const size_t cell = chosen_pass(track, state, best);
    return {cell, &last, 1, cell != best};
  }
  size_t place = best;
  for (size_t age = 1; age <= std::min(recent, state.earlier.size()); ++age) {
    place = place_before(state.earlier[age - 1], place);
    const PathKeyframe& led = track.recent[recent - age];
    const bool in_pass = is_in_pass(track, cells, place, led.cell);
    if (!in_pass && !is_other_pass(track, cells, place, led.cell)) continue;
    return led.established > 0 ? NextPlace{best} : NextPlace{best, &led, age, in_pass};
  }
  return {best};
}

// Adds the next keyframe without its frame, distance and margin.
void add_place(PathTrack& track, const FilterState& state, const NextPlace& next) {
  PathKeyframe added{
      .cell = next.cell, .value = state.values[next.cell], .path = track.paths + 1, .length = 1};
  if (next.from != nullptr) {
    if (next.is_in_pass) added.path = next.from->path;
    added.length = next.from->length + next.age;
    added.established = next.from->established > 0 ? next.from->established + 1 : 0;
    for (size_t age = 1; age < next.age; ++age) {
      PathKeyframe& resumed = track.recent[track.recent.size() - age];
      resumed.path = added.path;
      resumed.length = added.length - age;
      resumed.established = 0;
    }
  }
  track.paths = std::max(track.paths, added.path);
  track.recent.push_back(added);
  if (track.recent.size() > track.settings.path_keyframes * 4 + 1) track.recent.pop_front();
}

// The smallest value of a runner-up and of a new path.
uint32_t runner_up_value(const PathTrack& track, const FilterState& state, size_t cell) {
  const FilterCells& cells = state.cells;
  const size_t sequence = run_of(cells, cell).sequence;
  const size_t near = track.settings.near_keyframes;
  const size_t before = cell - std::min(cell, near);  // the first near cell
  uint32_t least = kNewPathValue;
  const auto add = [&](size_t first, size_t last) {
    least = std::min(least, least_elsewhere(track, state, cell, first, last));
  };
  for (const CellStretch& run : cells.runs) {
    const size_t end = run.first + run.count;
    const bool has_direction = cells.is_decoy(run.first) == cells.is_decoy(cell);
    if (has_direction && run.sequence == sequence) {
      add(run.first, std::min(end, before));
      add(std::max(run.first, cell + near + 1), end);
    } else if (!has_direction || track.overlapping.empty() ||
               track.overlapping[sequence][run.sequence] == 0) {
      add(run.first, end);
    }
  }
  return least;
}

// The margin of the path if it has at least path_keyframes. Changes of the pass do not advance.
uint32_t margin_of(const PathTrack& track, const FilterState& state) {
  const size_t count = std::max<size_t>(track.settings.path_keyframes, 1);
  const auto first = track.recent.end() - static_cast<ptrdiff_t>(count);
  uint64_t distances = first->distance;
  size_t advanced = 0;
  for (auto keyframe = first + 1; keyframe != track.recent.end(); ++keyframe) {
    distances += keyframe->distance;
    const size_t before = (keyframe - 1)->cell;
    if (keyframe->cell > before && keyframe->cell - before <= track.settings.near_keyframes)
      ++advanced;
  }
  const auto keyframes = static_cast<double>(count);
  const double share = static_cast<double>(distances) / keyframes / track.typical_distance;
  if (!(share <= kFarthest)) return 0;  // or equal training frames
  const double far = std::clamp((share - kNear) / (kFar - kNear), 0.0, 1.0);
  if (static_cast<double>(advanced) < std::floor(keyframes * (kLeastAdvances + kFarAdvances * far)))
    return 0;
  const PathKeyframe& last = track.recent.back();
  const uint32_t runner_up = runner_up_value(track, state, last.cell);
  const uint32_t lead = runner_up - std::min(runner_up, last.value);
  return lead - std::min(lead, static_cast<uint32_t>(kFarMargin * far));
}

void trace_back(PathTrack& track, const FilterState& state) {
  size_t cell = track.recent.back().cell;
  const size_t count = std::min(open_keyframes(track), path_size(track) - 1);
  for (size_t k = 1; k <= count; ++k) {
    const std::vector<uint32_t>& values = state.earlier[k - 1];
    cell = place_before(values, cell);
    PathKeyframe& keyframe = track.recent[track.recent.size() - 1 - k];
    keyframe.cell = cell;
    keyframe.value = values[cell];
  }
}

// The recent keyframe at which the path begins, or the first one if it began earlier.
size_t begin_of_path(const PathTrack& track) {
  const auto& recent = track.recent;
  if (recent.back().length > recent.size()) return 0;
  const size_t ahead = track.settings.path_keyframes / 2;
  const int64_t advance = std::min(kHeadAdvance, static_cast<int64_t>(3 * ahead / 8));
  const size_t settled = recent.size() - open_keyframes(track);
  const auto step = [&](size_t from, size_t to) {
    return static_cast<int64_t>(recent[to].cell) - static_cast<int64_t>(recent[from].cell);
  };
  // Longer steps back lead to another pass.
  const auto near = static_cast<int64_t>(track.settings.near_keyframes);
  const auto is_below = [near](int64_t cells, int64_t least) {
    return -near <= cells && cells < least;
  };
  size_t first = recent.size() - recent.back().length;
  for (size_t k = settled; k-- > first + 1;)
    if (is_below(step(k - 1, k), -int64_t{kLongestStep})) first = k;
  while (first < settled && first + ahead < recent.size() &&
         is_below(step(first, first + ahead), advance))
    ++first;
  size_t last = first;  // at the first place
  while (last + 1 < settled && is_below(step(first, last + 1), 1)) ++last;
  return std::max(first, last + 1 - std::min(last + 1, kHeadStand));
}

// The first recent keyframe that the path may still recognize. Without a margin, an earlier path
// may be resumed.
size_t first_open(const PathTrack& track) {
  const size_t recent = track.recent.size();
  const size_t most = track.settings.path_keyframes * 3 / 2 + 1;
  const size_t first = track.margin > 0 ? begin_of_path(track) : 0;
  return track.recent.back().established < most ? first : std::max(first, recent - most);
}

}  // namespace

size_t path_size(const PathTrack& track) {
  return track.recent.empty() ? 0 : std::min(track.recent.back().length, track.recent.size());
}

size_t open_keyframes(const PathTrack& track) {
  return std::min<size_t>(path_size(track), track.settings.path_keyframes / 2);
}

void follow_keyframe(PathTrack& track, const FilterState& state, size_t query_frame,
                     const std::function<uint32_t(size_t cell)>& distance_to) {
  const FilterCells& cells = state.cells;
  const size_t best = best_of(state, track.follows_decoys ? cells.decoys : 0,
                              track.follows_decoys ? cells.size() : cells.decoys);
  add_place(track, state, next_place(track, state, best));
  PathKeyframe& last = track.recent.back();
  last.frame = query_frame;
  last.distance = distance_to(last.cell);
  trace_back(track, state);
  track.margin = last.length >= track.settings.path_keyframes ? margin_of(track, state) : 0;
  if (last.established == 0 && track.margin >= kEstablished) last.established = 1;
  track.first_frame = std::max(track.first_frame, track.recent[first_open(track)].frame);
}

std::optional<double> recent_rate(const PathTrack& track, const FilterCells& cells) {
  const size_t last = track.recent.size() - 1;
  size_t first = last;  // of the pass
  while (last - first + 1 < path_size(track) && last - first < track.settings.path_keyframes &&
         difference(track.recent[first - 1].cell, track.recent[first].cell) <=
             track.settings.near_keyframes)
    --first;
  if (last - first + 1 < kFewKeyframes) return std::nullopt;
  const PathKeyframe& from = track.recent[first];
  const PathKeyframe& to = track.recent[last];
  const size_t first_frame = cells.frames[from.cell];
  const size_t passed = std::max<size_t>(cells.frames[to.cell], first_frame) - first_frame;
  return static_cast<double>(passed) / static_cast<double>(to.frame - from.frame);
}

size_t position_at(const FilterCells& cells, const PathKeyframe& keyframe, size_t query_frame,
                   double rate) {
  const size_t first = cells.frames[keyframe.cell];
  const double passed = std::floor(static_cast<double>(query_frame - keyframe.frame) * rate + 0.5);
  const size_t rest = keyframe_end(cells, run_of(cells, keyframe.cell), keyframe.cell) - 1 - first;
  return first + static_cast<size_t>(std::min(passed, static_cast<double>(rest)));
}

}  // namespace vpr
