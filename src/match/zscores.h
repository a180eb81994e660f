// Z-scores: frame distances without the bias of hubs, frames that are close to everything. Computed
// one query frame after the other, because each one uses statistics of earlier frames.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "base/json_fwd.h"
#include "base/monitor.h"
#include "match/components.h"
#include "match/frame_distances.h"
#include "match/score_kernels.h"
#include "store/train_statistics.h"

namespace vpr {

/// Settings of z-scores and of learning from the query.
struct ZScoreSettings {
  double forgetting = 0.98;         ///< weight of learned statistics after one more keyframe
  double start_weight = 20;         ///< of the training statistics, in keyframes
  double offline_start_weight = 2;  ///< of the training statistics if the whole query is known
  /// Share of a training frame's bias toward other training frames that is assumed toward query
  /// frames.
  double start_bias = 0.5;
  /// Minimum standard deviation, in bits of LDB; for other largest distances, the same share.
  double deviation_floor = 10;
  /// A frame is a new keyframe if it differs from the last ones by at least this share of the
  /// typical distance of training frames. 0: every frame is.
  double keyframe_change = 0.25;
  uint64_t lag_keyframes = 5;  ///< a keyframe is learned after this number of newer ones
  /// Number of training components that are subtracted in part from distances; at most 6. 0: none.
  uint64_t components = kMaxComponents;
  bool center = true;  ///< false: rows keep their mean
  bool learn = true;   ///< false: the training statistics only
  bool divide = true;  ///< false: every standard deviation is unknown_deviation
};

VPR_FIELDS(ZScoreSettings, forgetting, start_weight, offline_start_weight, start_bias,
           deviation_floor, keyframe_change, lag_keyframes, components, center, learn, divide)

/// Throws Error(usage) for settings out of range.
void check_zscore_settings(const ZScoreSettings& settings);

/// Sums of 16-bit scores stay below 2^32.
inline constexpr size_t kMaxScoredWindow = 65536;

/// The initial state of a query's z-scores.
struct ScoreBasis {
  ZScoreSettings settings;
  bool offline = false;
  double typical_distance = 0;
  std::vector<float> mean;     ///< of centered distances; one per matched training frame
  float variance = 0;          ///< of centered distances, the same for all training frames
  TrainComponents components;  ///< loadings: one per matched training frame
};

/// The initial state from training statistics: for every frame `start_bias` of its bias, minus the
/// part explained by components, and the mean variance of all frames, because the variance of a
/// frame's own distances to the training sequence says almost nothing about its distances to a
/// query.
ScoreBasis make_score_basis(const ZScoreSettings& settings, bool offline,
                            const TrainStatistics& statistics);

/// The minimum standard deviation, in units of distances whose largest is `largest`.
double deviation_floor(const ZScoreSettings& settings, uint16_t largest);

/// The last keyframes of a query. Time is counted in keyframes: their number depends neither on the
/// walking speed nor on the frame rate, and a stop has none.
struct KeyframeQueue {
  double least_change = 0;  ///< a frame distance
  size_t lag = 1;
  std::vector<size_t> pending;  ///< frames seen and not learned yet; at most `lag`, oldest first
};

/// An empty queue. typical_distance is the typical distance of training frames.
KeyframeQueue make_keyframe_queue(const ZScoreSettings& settings, double typical_distance);

/// Whether a frame of `rows` differs from every pending keyframe, also of `rows`, by at least
/// least_change.
bool is_new_keyframe(const KeyframeQueue& queue, const DescriptorRows& rows, size_t frame);

/// Adds a keyframe; returns the one that is now old enough to be learned, if any.
std::optional<size_t> push_keyframe(KeyframeQueue& queue, size_t keyframe);

/// The first frames of keyframes, increasing; the first frame always is one. A frame is a new
/// keyframe if it differs from the last ones as for z-scores (is_new_keyframe) with the default
/// settings: from each of the last five by at least a quarter of `typical_distance`. Unreadable
/// frames belong to the previous keyframe. Empty without frames.
std::vector<uint32_t> keyframe_starts(const DescribedFrames& sequence, double typical_distance);

/// The terms subtracted from the distances of a query frame.
struct FrameTerms {
  float offset = 0;              ///< mean over the training frames, or the typical distance
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
  float most_variance = 0;

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

/// Begins a query. With an offline basis, learns all keyframes here and none later. Throws
/// Error(interrupted) once the user wants to stop.
std::shared_ptr<ZScoreState> start_zscores(FrameDistances distances, const ScoreBasis& basis,
                                           const Monitor& monitor);

/// The query's frame distances as scores (score_kernels.h), in order, because later frames use
/// statistics of earlier ones. start_row determines what is learned before a frame is scored; an
/// unreadable frame is not a keyframe. Copies share the state.
FrameDistances zscores(const std::shared_ptr<ZScoreState>& state);

/// Convenience: starts the state and normalizes.
FrameDistances zscores(FrameDistances distances, const ScoreBasis& basis, const Monitor& monitor);

/// The state after a part of a query, for its next one (StartedStage).
void continue_zscores(ZScoreState& state, FrameDistances part, std::span<const size_t> kept);

/// Throws Error(usage) for settings that need a complete training sequence: a number of components
/// other than 0 and the default, which counts as 0 here.
void check_past_settings(const ZScoreSettings& settings);

/// Z-scores of a sequence against its own past: causal, because they depend only on frames up to
/// the query frame. `distances` are those of the sequence to itself, with `past`. With P(j) the
/// readable frames of the past of frame j, and h the distances of readable frames:
/// - rows: x(j, i) = h(j, i) - r(j), where r(j) is the mean of h(j, .) over P(j);
/// - columns start with the mean start_bias * (r(i) - R(i)), where R(i) is the mean of r up to
///   frame i, or 0 if frame i has no past; and with the variance V(j) of the row in whose past they
///   enter: the mean of x^2 over all pairs so far and start_weight values with the variance of
///   unknown frames. Earlier rows have their own V;
/// - keyframes are learned as in zscores(), with the typical distance R of the previous frame, but
///   only by the columns in their past, each with an initial weight of start_weight keyframes.
/// Memory: 16 bytes per frame plus its entry in the past. Distances of keyframes are computed
/// twice.
FrameDistances past_zscores(FrameDistances distances, const ZScoreSettings& settings);

}  // namespace vpr
