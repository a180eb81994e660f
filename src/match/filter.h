// A Bayes filter over places and rates, the cells that it runs on, and the second reading of a
// track.
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

/// No step of the filter is longer: so many cells in front of a run stand for no place, and nothing
/// comes in from there.
inline constexpr size_t kLongestStep = 3;

/// The cells of a run of readable training frames.
struct CellRun {
  size_t first = 0;  ///< cell
  size_t count = 0;
  size_t sequence = 0;
  size_t frames_end = 0;  ///< the frame behind the run
};

struct FilterCells {
  /// The first frame of every cell's view, among all training frames. Means nothing for a cell that
  /// is no place.
  std::vector<uint32_t> frames;
  std::vector<CellRun> runs;  ///< rising
  size_t places = 0;          ///< cells that are one

  size_t size() const { return frames.size(); }
};

/// Every run begins with a view, and a frame that differs by at least least_change from the last
/// view of its run is one.
FilterCells find_cells(const FrameDistances& distances, double least_change);

/// The run that a place is in.
const CellRun& run_of(const FilterCells& cells, size_t cell);

/// The frame behind the view of a place of the run.
size_t view_end(const FilterCells& cells, const CellRun& run, size_t cell);

/// How likely a rate is before anything was seen, and each of its steps: kFirstSteps[r] views of
/// the training sequence per view of the query, and on.
struct FilterRate {
  double prior = 0;
  std::array<double, kSteps> steps = {};
};
const std::array<FilterRate, kRates>& filter_rates();

/// What is believed after some views of a query: masses of all cells and rates, up to a factor.
/// 60 bytes a place, and 4 for its value.
struct FilterState {
  FilterSettings settings;
  FilterCells cells;
  FilterKernels kernels;
  std::vector<float> likelihood_of;  ///< by score / kScoresPerLikelihood
  std::vector<uint32_t> logarithms;  ///< of mantissas, in units of values / 256
  uint32_t octave = 0;               ///< what a factor of 2 is, in the same units

  std::vector<float> likelihoods;                 ///< of the view; 0 for a cell that is no place
  std::array<std::vector<float>, kRates> before;  ///< by rate: after changes of rate
  std::array<std::vector<float>, kRates> after;
  std::vector<float> masses;     ///< of every cell, over rates
  double nowhere = 0;            ///< mass of being nowhere
  double total = 1;              ///< all mass
  std::vector<uint32_t> values;  ///< of every cell: kScoreBias and -log(mass / total) / sharpness
  uint32_t nowhere_value = 0;
};

/// Scores that differ by less have one likelihood: 1/64 of a deviation.
inline constexpr uint32_t kScoresPerLikelihood = 16;

/// The value of a cell that is no place.
inline constexpr uint32_t kNoValue = std::numeric_limits<uint32_t>::max();

/// The state before the first view: half nowhere, half anywhere, at the rates' priors. Throws
/// Error(usage) for settings out of range. `least_change`: of a view, a frame distance.
FilterState start_filter(const FrameDistances& distances, const FilterSettings& settings,
                         double least_change);

/// Takes other places; all views are forgotten.
void place_filter(FilterState& state, FilterCells cells);

/// Forgets all views.
void restart_filter(FilterState& state);

/// Takes a view of the query: its standardized scores to all training frames, as
/// ScoreKernels::standardize writes them. Values, also that of being nowhere, are in units of
/// 1/1024 deviations, whole numbers; smaller is likelier. Time O(cells). Means nothing where there
/// are no places.
void advance_filter(FilterState& state, std::span<const uint16_t> scores);

/// No more views of a path are read again.
inline constexpr size_t kRereadViews = 48;

/// What the views of a path say by now.
struct PathReading {
  std::vector<int32_t> supports;  ///< -z at the best places of its views, in scores; oldest first
  uint32_t margin = 0;            ///< how much likelier it is than being nowhere, in scores
};

/// A view of a path, and how far it is from the places around its best one.
struct SeenView {
  size_t best = 0;                ///< cell
  size_t first = 0;               ///< cell
  std::vector<double> distances;  ///< centred, to the cells from `first` on, which are of one run
};

/// The early views of a walk are scored by little more than the training data. What is learned
/// later says more of them, too: standardized scores of a path are found anew, and a filter over
/// its places and being nowhere takes them, from the first view to the last.
struct SecondLook {
  FilterState filter;  ///< its cells are those around the path
  std::deque<SeenView> views;
};

/// `filter`: the one over all places.
SecondLook start_second_look(const FilterState& filter);

/// Takes a view of the path, whose best place is `cell`, and its scores to all training frames.
/// `scale`: what made them.
void see_view(SecondLook& look, const FilterCells& cells, std::span<const uint16_t> scores,
              const std::function<ScoreScale(size_t)>& scale, size_t cell);

/// What the views say if `scale` makes their scores. The margin is that of the likeliest place
/// within near_views of the last best one; views from before a training frame that can't be read
/// add nothing to it. There must be a view. Time O(views * near_views).
PathReading read_again(SecondLook& look, const FilterCells& cells,
                       const std::function<ScoreScale(size_t)>& scale);

}  // namespace vpr
