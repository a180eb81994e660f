// A Bayes filter over places and rates, its cells, and the re-scoring of a track.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <limits>
#include <span>
#include <vector>

#include "match/filter_kernels.h"
#include "match/filter_settings.h"
#include "match/frame_distances.h"

namespace vpr {

/// The longest step of the filter: this number of cells before a run are not places, so that no
/// mass enters from there.
inline constexpr size_t kLongestStep = 3;

/// The cells of a run of readable training frames.
struct CellRun {
  size_t first = 0;  ///< cell
  size_t count = 0;
  size_t sequence = 0;
  size_t frames_end = 0;  ///< one past the last frame of the run
};

struct FilterCells {
  /// The first frame of every cell's keyframe, in all training frames. Unspecified for a cell that
  /// is not a place.
  std::vector<uint32_t> frames;
  std::vector<CellRun> runs;  ///< increasing
  size_t places = 0;          ///< number of cells that are places

  size_t size() const { return frames.size(); }
};

/// Every run begins with a keyframe; a frame that differs by at least least_change from the last
/// keyframe of its run is a keyframe.
FilterCells find_cells(const FrameDistances& distances, double least_change);

/// The run that contains a place.
const CellRun& run_of(const FilterCells& cells, size_t cell);

/// One past the last frame of the keyframe of a place in the run.
size_t view_end(const FilterCells& cells, const CellRun& run, size_t cell);

/// The prior of a rate, and of each of its steps: kFirstSteps[r] and more keyframes of the training
/// sequence per keyframe of the query.
struct FilterRate {
  double prior = 0;
  std::array<double, kSteps> steps = {};
};
const std::array<FilterRate, kRates>& filter_rates();

/// The state after some keyframes of a query: masses of all cells and rates, up to a factor. 60
/// bytes per place, and 4 for its value.
struct FilterState {
  FilterSettings settings;
  FilterCells cells;
  FilterKernels kernels;
  std::vector<float> likelihood_of;  ///< by score / kScoresPerLikelihood
  std::vector<uint32_t> logarithms;  ///< of mantissas, in units of values / 256
  uint32_t octave = 0;               ///< logarithm of 2, in the same units

  std::vector<float> likelihoods;  ///< of the keyframe; 0 for a cell that is not a place
  std::array<std::vector<float>, kRates> before;  ///< by rate: after changes of the rate
  std::array<std::vector<float>, kRates> after;
  std::vector<float> masses;     ///< of every cell, summed over rates
  double off_map = 0;            ///< mass of the off-map state
  double total = 1;              ///< total mass
  std::vector<uint32_t> values;  ///< of every cell: kScoreBias and -log(mass / total) / sharpness
  uint32_t nowhere_value = 0;
};

/// Scores that differ by less have equal likelihoods: 1/64 of a deviation.
inline constexpr uint32_t kScoresPerLikelihood = 16;

/// The value of a cell that is not a place.
inline constexpr uint32_t kNoValue = std::numeric_limits<uint32_t>::max();

/// The state before the first keyframe: half off the map, half uniform over places, with the rates'
/// priors. Throws Error(usage) for settings out of range. `least_change`: frame distance between
/// keyframes.
FilterState start_filter(const FrameDistances& distances, const FilterSettings& settings,
                         double least_change);

/// Replaces the places and forgets all keyframes.
void place_filter(FilterState& state, FilterCells cells);

/// Forgets all keyframes.
void restart_filter(FilterState& state);

/// Adds a keyframe of the query: its z-scores to all training frames, in the format of
/// ScoreKernels::to_zscores. Values, also of the off-map state, are integers in units of 1/1024
/// deviations; smaller is likelier. Time O(cells). Unspecified without places.
void advance_filter(FilterState& state, std::span<const uint16_t> scores);

/// The maximum number of keyframes of a path that are re-scored.
inline constexpr size_t kRescoredKeyframes = 48;

/// The re-scored keyframes of a path.
struct RescoredPath {
  /// -z at the best places of its keyframes, in scores; oldest first
  std::vector<int32_t> supports;
  uint32_t margin = 0;  ///< over the off-map state, in scores
};

/// A keyframe of a path, and its distances to the places around its best one.
struct PathKeyframe {
  size_t best = 0;                ///< cell
  size_t first = 0;               ///< cell
  std::vector<double> distances;  ///< centered, to the cells from `first` on, which are in one run
};

/// The early keyframes of a query are scored mainly with training statistics. Later statistics are
/// better: the z-scores of a path are recomputed with them, and a filter over its places and the
/// off-map state processes them from the first keyframe to the last.
struct Rescoring {
  FilterState filter;  ///< its cells are those around the path
  std::deque<PathKeyframe> views;
};

/// `filter`: the filter over all places.
Rescoring start_rescoring(const FilterState& filter);

/// Adds a keyframe of the path, whose best place is `cell`, and its scores to all training frames.
/// `scale`: the statistics of the scores.
void add_keyframe(Rescoring& rescoring, const FilterCells& cells, std::span<const uint16_t> scores,
                  const std::function<ScoreScale(size_t)>& scale, size_t cell);

/// Re-scores the keyframes with the statistics `scale`. The margin is the margin of the likeliest
/// place within near_keyframes of the last best one; keyframes before an unreadable training frame
/// add nothing to it. There must be a keyframe. Time O(keyframes * near_keyframes).
RescoredPath rescore(Rescoring& rescoring, const FilterCells& cells,
                     const std::function<ScoreScale(size_t)>& scale);

}  // namespace vpr
