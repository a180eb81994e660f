// Z-scores: frame distances without the bias of hubs, frames that are close to everything. Computed
// one query frame after the other, because each one uses statistics of earlier frames.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "database/train_statistics.h"
#include "match/components.h"
#include "match/frame_distances.h"
#include "match/score_kernels.h"

namespace vpr {

/// The weight of learned statistics after one more keyframe.
inline constexpr double kForgetting = 0.98;
/// The weight of the training statistics, in keyframes; the filter has its own.
inline constexpr double kStartWeight = 20;
/// The share of a training frame's bias toward other training frames that is assumed toward query
/// frames.
inline constexpr double kStartBias = 0.5;
/// A frame is a new keyframe if it differs from the last kKeyframeLag ones by at least this share
/// of the typical distance of training frames.
inline constexpr double kKeyframeChange = 0.25;
/// A keyframe is learned after this number of newer ones.
inline constexpr size_t kKeyframeLag = 5;

/// Sums of 16-bit scores stay below 2^32.
inline constexpr size_t kMaxScoredWindow = 65536;

/// The initial state of a query's z-scores.
struct ScoreBasis {
  double start_weight = kStartWeight;
  double typical_distance = 0;
  std::vector<float> mean;     ///< of centered distances; one per matched training frame
  float variance = 0;          ///< of centered distances, the same for all training frames
  TrainComponents components;  ///< loadings: one per matched training frame
};

/// The initial state from training statistics: for every frame kStartBias of its bias, minus the
/// part explained by components, and the mean variance of all frames, because the variance of a
/// frame's own distances to the training sequence says almost nothing about its distances to a
/// query.
ScoreBasis make_score_basis(const TrainStatistics& statistics, double start_weight = kStartWeight);

/// The minimum standard deviation, in units of distances whose largest is `largest`: 10 bits of
/// LDB, or the same share.
constexpr double deviation_floor(uint16_t largest) { return 10 * reference_bit(largest); }

/// The last keyframes of a query. Time is counted in keyframes: their number depends neither on the
/// walking speed nor on the frame rate, and a stop has none.
struct KeyframeQueue {
  double least_change = 0;  ///< a frame distance
  /// frames seen and not learned yet; at most kKeyframeLag, oldest first
  std::vector<size_t> pending = {};
};

/// An empty queue. typical_distance is the typical distance of training frames.
KeyframeQueue make_keyframe_queue(double typical_distance);

/// Whether a frame of `rows` differs from every pending keyframe, also of `rows`, by at least
/// least_change.
bool is_new_keyframe(const KeyframeQueue& queue, const DescriptorRows& rows, size_t frame);

/// Adds a keyframe; returns the one that is now old enough to be learned, if any.
std::optional<size_t> push_keyframe(KeyframeQueue& queue, size_t keyframe);

/// The first frames of keyframes, increasing; the first frame always is one. A frame is a new
/// keyframe if it differs from each of the last five by at least a quarter of `typical_distance`
/// (is_new_keyframe). Unreadable frames belong to the previous keyframe. Empty without frames.
std::vector<uint32_t> keyframe_starts(const DescribedFrames& sequence, double typical_distance);

/// The terms subtracted from the distances of a query frame.
struct FrameTerms {
  float offset = 0;              ///< mean over the training frames
  ComponentWeights common = {};  ///< of the training frames' components
};

/// Statistics of every training frame's centered distances: 12 bytes per training frame, and the
/// rows of the pending keyframes.
struct ZScoreState {
  FrameDistances distances;  ///< the input distances
  ScoreBasis basis;          ///< the statistics before any learning
  std::vector<float> mean;
  std::vector<float> variance;
  double weight = 0;  ///< of both, in keyframes
  KeyframeQueue keyframes;
  std::vector<uint8_t> readable;  ///< per query frame
  Projector project;              ///< not set: no component is subtracted
  std::vector<FrameTerms> terms;  ///< per query frame, of those begun
  ScoreKernels kernels;
  float least_variance = 0;

  /// The keyframe whose distances are learned during the row of `frame`.
  struct KeyframeUpdate {
    size_t keyframe = 0;
    float gain = 0;
  };
  std::optional<KeyframeUpdate> update;
  size_t frame = 0;
  bool is_keyframe = false;
  std::vector<uint16_t> row;  ///< the frame's distances, if row_total is not set
  /// The distances of the pending keyframes. Those of `frame`, the last row, replace those of the
  /// learned keyframe range by range.
  std::vector<std::vector<uint16_t>> rows;
};

/// Begins a query.
std::shared_ptr<ZScoreState> start_zscores(FrameDistances distances, const ScoreBasis& basis);

/// The query's frame distances as scores (score_kernels.h), in order, because later frames use
/// statistics of earlier ones. start_row determines what is learned before a frame is scored; an
/// unreadable frame is not a keyframe. Copies share the state.
FrameDistances zscores(const std::shared_ptr<ZScoreState>& state);

/// Convenience: starts the state and normalizes.
FrameDistances zscores(FrameDistances distances, const ScoreBasis& basis);

/// The state after a part of a query, for its next one (StartedStage).
void continue_zscores(ZScoreState& state, FrameDistances part, std::span<const size_t> kept);

/// Z-scores of a sequence against its own past: causal, because they depend only on frames up to
/// the query frame. `distances` are those of the sequence to itself, with `past`. With P(j) the
/// readable frames of the past of frame j, and h the distances of readable frames:
/// - rows: x(j, i) = h(j, i) - r(j), where r(j) is the mean of h(j, .) over P(j);
/// - columns start with the mean kStartBias * (r(i) - R(i)), where R(i) is the mean of r up to
///   frame i, or 0 if frame i has no past; and with the variance V(j) of the row in whose past they
///   enter: the mean of x^2 over all pairs so far and kStartWeight values with the variance of
///   unknown frames. Earlier rows have their own V;
/// - keyframes are learned as in zscores(), with the typical distance R of the previous frame, but
///   only by the columns in their past, each with an initial weight of kStartWeight keyframes.
/// Memory: 16 bytes per frame plus its entry in the past. Distances of keyframes are computed
/// twice.
FrameDistances past_zscores(FrameDistances distances);

}  // namespace vpr
