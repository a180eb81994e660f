// The filter over places and rates: the evidence of the paths that end at each place.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "match/match.h"
#include "match/score_kernels.h"

namespace vpr {

/// Training keyframes per query keyframe: 0, 1/2, 2/3, 1, 3/2, 2.
inline constexpr size_t kRateCount = 6;

/// The number of steps of a rate, beginning with the shortest one.
inline constexpr size_t kSteps = 3;
inline constexpr std::array<size_t, kRateCount> kFirstSteps = {0, 0, 0, 0, 1, 1};

/// The longest step of the filter: this number of cells before a run are not places, so that no
/// mass enters from there.
inline constexpr size_t kLongestStep = 3;

/// The cells of a stretch of readable training frames.
struct CellStretch {
  size_t first = 0;  ///< cell
  size_t count = 0;
  size_t sequence = 0;
  size_t frames_end = 0;  ///< one past the last frame of the run
};

/// The cells of all runs, and after them decoys: the same runs in reverse order, last run first.
/// Paths through decoys show what chance, a standing camera and the way back look like.
struct FilterCells {
  /// The first frame of every cell's keyframe, in all training frames. Unspecified for a cell that
  /// is not a place.
  std::vector<uint32_t> frames;
  std::vector<CellStretch> runs;  ///< increasing; the second half are decoys
  size_t places = 0;              ///< number of cells that are places, without decoys
  size_t decoys = 0;              ///< the first cell of the decoys
  /// The cell of the first pass through the place of each trained cell: its own, unless it repeats
  /// an earlier one. Empty: no place has several passes.
  std::vector<uint32_t> first_passes;

  size_t size() const { return frames.size(); }
  std::span<const CellStretch> trained() const { return std::span(runs).first(runs.size() / 2); }
  bool is_decoy(size_t cell) const { return cell >= decoys; }
  /// The trained cell of a place, which may be a decoy.
  size_t trained_cell(size_t cell) const {
    return is_decoy(cell) ? size() - 1 - cell + kLongestStep : cell;
  }
};

/// Adds the decoys of all runs, as the second half of the runs.
void add_decoys(FilterCells& cells);

/// Sets first_passes of the cells. Repeated places of frames that are not in a cell have no effect.
void apply_passes(FilterCells& cells, std::span<const RepeatedPlace> passes);

/// A range of cells.
struct CellRange {
  size_t first = 0;
  size_t last = 0;  ///< exclusive

  bool contains(size_t cell) const { return cell >= first && cell < last; }
};

/// The cells of first passes that are the same place as this one: at most `near` cells away from
/// its own first pass, in one sequence.
CellRange same_place(const FilterCells& cells, size_t cell, size_t near);

/// The descriptor of the keyframe of a place.
DescriptorRow descriptor_of(const FilterCells& cells, const FrameDistances& distances, size_t cell);

/// The training frames of the run of a place. Decoys are in reverse order.
const FrameStretch& stretch_of(const FilterCells& cells, const FrameDistances& distances,
                               size_t cell);

/// The run that contains a place.
const CellStretch& run_of(const FilterCells& cells, size_t cell);

/// One past the last frame of the keyframe of a place in the run, which is not a decoy.
size_t keyframe_end(const FilterCells& cells, const CellStretch& run, size_t cell);

/// The prior of a rate, and of each of its steps: kFirstSteps[r] and more keyframes of the training
/// sequence per keyframe of the query.
struct FilterRate {
  double prior = 0;
  std::array<double, kSteps> steps = {};
};
const std::array<FilterRate, kRateCount>& filter_rates();

/// The model: a place supports a path by kSharpness * (kUnrelated - z), in nats. A path keeps its
/// rate for a keyframe with probability 1 - kRateChange. kMostEvidence bounds the evidence of a
/// path, in nats.
inline constexpr double kSharpness = 0.3;
inline constexpr double kUnrelated = -0.75;
inline constexpr double kRateChange = 0.05;
inline constexpr double kMostEvidence = 8;
inline constexpr double kMostMass = 2980.9579870417283;  ///< exp(kMostEvidence)

/// The state after some keyframes of a query: the mass of each cell and rate is the sum over all
/// paths that end there, each the product of its likelihood ratios to unrelated places. At each
/// keyframe a path of mass 1 begins at every place. 64 bytes per cell, and 4 for each of the
/// earlier values.
struct FilterState {
  FilterCells cells;
  std::vector<float> likelihood_of;  ///< by score / kScoresPerLikelihood
  std::vector<uint32_t> logarithms;  ///< of mantissas, in units of values / 256
  uint32_t octave = 0;               ///< logarithm of 2, in the same units

  std::vector<float> likelihoods;  ///< of the keyframe; 0 for a cell that is not a place
  std::array<std::vector<float>, kRateCount> before;  ///< by rate: after changes of the rate
  std::array<std::vector<float>, kRateCount> after;
  std::vector<float> masses;                          ///< of every cell, summed over rates
  size_t known = std::numeric_limits<size_t>::max();  ///< trained cells from here on have no mass
  double kept = 1;               ///< factor of all masses: no evidence exceeds kMostEvidence
  std::vector<uint32_t> values;  ///< of every cell: kScoreBias - log(kept * mass) / kSharpness
  std::vector<std::vector<uint32_t>> earlier;  ///< values of earlier keyframes, the latest first
};

/// Scores that differ by less have equal likelihoods: 1/64 of a deviation.
inline constexpr uint32_t kScoresPerLikelihood = 16;

/// The value of a cell that is not a place.
inline constexpr uint32_t kNoValue = std::numeric_limits<uint32_t>::max();

/// The value of a path that begins: evidence 0.
inline constexpr uint32_t kNewPathValue = kScoreBias;

/// The settings for the frame rate of the training sequences: the more alike consecutive frames
/// are, the farther apart are keyframes, and the more of them are near the best one. With frames
/// that differ on average by at least 0.35 of `typical_distance`, the settings stay as they are;
/// from there to 0.2, keyframe_change increases by up to a third. Then near_keyframes increases, by
/// up to half, until that many consecutive keyframes change by a total of 0.4 typical distances per
/// near_keyframes of `settings`. Unchanged without consecutive frames.
FilterSettings adapted_settings(const FrameDistances& distances, const FilterSettings& settings,
                                double typical_distance);

/// The state before the first keyframe: no path. Throws Error(usage) for settings out of range.
/// `least_change`: frame distance between keyframes.
FilterState start_filter(const FrameDistances& distances, const FilterSettings& settings,
                         double least_change);

/// The same for these cells.
FilterState start_filter(FilterCells cells, const FilterSettings& settings);

/// The cells of all training runs, and their decoys. Every run begins with a keyframe; a frame that
/// differs by at least least_change from the last keyframe of its run is a keyframe.
FilterCells find_cells(const FrameDistances& distances, double least_change);

/// Forgets all keyframes.
void restart_filter(FilterState& state);

/// Adds a keyframe of the query: its z-scores to all training frames, in the format of
/// ScoreKernels::to_zscores. Values are integers in units of 1/1024 deviations; smaller is
/// likelier. The last path_keyframes / 2 values are kept. Time O(cells before `known`), which must
/// not decrease. Unspecified without places.
void advance_filter(FilterState& state, std::span<const uint16_t> scores);

}  // namespace vpr
