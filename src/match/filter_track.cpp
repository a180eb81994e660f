#include "match/filter_track.h"

#include <algorithm>
#include <cmath>

namespace vpr {
namespace {

constexpr size_t kFewKeyframes = 6;  // fewer do not determine the rate

uint32_t least_of(const PathTrack& track, const FilterState& state, size_t first, size_t last) {
  return first < last ? track.kernels.minimum(state.values.data() + first, last - first) : kNoValue;
}

bool continues_path(const PathTrack& track, const FilterState& state, size_t cell) {
  if (track.keyframes == 0) return false;
  const size_t last = track.recent.back().cell;
  const size_t gap = std::max(cell, last) - std::min(cell, last);
  return gap <= track.settings.near_keyframes &&
         run_of(state.cells, cell).sequence == run_of(state.cells, last).sequence;
}

// The smallest value of a runner-up and of a new path.
uint32_t runner_up_value(const PathTrack& track, const FilterState& state, size_t cell) {
  const FilterCells& cells = state.cells;
  const size_t sequence = run_of(cells, cell).sequence;
  const size_t near = track.settings.near_keyframes;
  const size_t before = cell - std::min(cell, near);  // the first near cell
  uint32_t least = kNewPathValue;
  for (const CellStretch& run : cells.runs) {
    const size_t end = run.first + run.count;
    const bool has_direction = cells.is_decoy(run.first) == cells.is_decoy(cell);
    if (has_direction && run.sequence == sequence) {
      least = std::min({least, least_of(track, state, run.first, std::min(end, before)),
                        least_of(track, state, std::max(run.first, cell + near + 1), end)});
    } else if (!has_direction || track.overlapping.empty() ||
               track.overlapping[sequence][run.sequence] == 0) {
      least = std::min(least, least_of(track, state, run.first, end));
    }
  }
  return least;
}

// Whether the last path_keyframes of the path move, and are close to their places.
bool is_plausible(const PathTrack& track) {
  const size_t count = std::max<size_t>(track.settings.path_keyframes, 1);
  const auto first = track.recent.end() - static_cast<ptrdiff_t>(count);
  uint64_t distances = 0;
  for (auto keyframe = first; keyframe != track.recent.end(); ++keyframe)
    distances += keyframe->distance;
  return track.recent.back().cell >= first->cell + count / 4 &&
         static_cast<double>(distances) <= track.farthest * static_cast<double>(count);
}

// The place before a step to `cell`. kLongestStep cells before a run are not places.
size_t place_before(const std::vector<uint32_t>& values, size_t cell) {
  const auto first = values.begin() + static_cast<ptrdiff_t>(cell - kLongestStep);
  return cell - kLongestStep +
         static_cast<size_t>(std::min_element(first, first + kLongestStep + 1) - first);
}

void trace_back(PathTrack& track, const FilterState& state) {
  size_t cell = track.recent.back().cell;
  for (size_t k = 1; k < open_keyframes(track) + 1 && k < track.recent.size(); ++k) {
    const std::vector<uint32_t>& values = state.earlier[k - 1];
    cell = place_before(values, cell);
    PathKeyframe& keyframe = track.recent[track.recent.size() - 1 - k];
    keyframe.cell = cell;
    keyframe.value = values[cell];
  }
}

}  // namespace

size_t open_keyframes(const PathTrack& track) {
  return std::min<size_t>(track.keyframes, track.settings.path_keyframes / 2);
}

size_t best_place(const PathTrack& track, const FilterState& state) {
  const size_t first = track.follows_decoys ? state.cells.decoys : 0;
  const size_t last = track.follows_decoys ? state.cells.size() : state.cells.decoys;
  const uint32_t least = least_of(track, state, first, last);
  return track.kernels.find_below(state.values.data(), first, last, least + 1);
}

void follow_keyframe(PathTrack& track, const FilterState& state, size_t query_frame,
                     uint32_t distance) {
  const size_t cell = best_place(track, state);
  if (!continues_path(track, state, cell)) {
    track.keyframes = 0;
    track.recent.clear();
    ++track.number;
  }
  ++track.keyframes;
  track.recent.push_back({query_frame, cell, state.values[cell], distance});
  if (track.recent.size() > track.settings.path_keyframes * 3 / 2 + 1) track.recent.pop_front();
  trace_back(track, state);
  track.margin = 0;
  if (track.keyframes < track.settings.path_keyframes || !is_plausible(track)) return;
  const uint32_t runner_up = runner_up_value(track, state, cell);
  track.margin = runner_up - std::min(runner_up, state.values[cell]);
}

std::optional<double> recent_rate(const PathTrack& track, const FilterCells& cells) {
  if (track.recent.size() < kFewKeyframes) return std::nullopt;
  const size_t before = std::min<size_t>(track.recent.size() - 1, track.settings.path_keyframes);
  const PathKeyframe& from = track.recent[track.recent.size() - 1 - before];
  const PathKeyframe& to = track.recent.back();
  const size_t first = cells.frames[from.cell];
  const size_t passed = std::max<size_t>(cells.frames[to.cell], first) - first;
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
