// Z-scores of frame distances, one query frame after the other.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "base/monitor.h"
#include "match/components.h"
#include "match/frame_distances.h"
#include "match/score_kernels.h"
#include "match/zscore_model.h"

namespace vpr {

/// The maximum number of pending keyframes whose rows of distances are kept until they are learned,
/// 2 bytes per training frame each; with a longer lag they are recomputed.
inline constexpr size_t kMostKeptRows = 8;

/// The terms subtracted from the distances of a query frame.
struct FrameTerms {
  float offset = 0;           ///< mean over the training frames, or the typical distance
  CommonWeights common = {};  ///< of the training frames' components
};

/// Statistics of every training frame's centered distances: 12 bytes per frame, and the kept rows.
struct ZScoreState {
  FrameDistances distances;  ///< the input distances
  ZScoreSettings settings;
  bool offline = false;
  double typical_distance = 0;
  std::vector<float> mean;
  std::vector<float> variance;
  double weight = 0;              ///< of both, in keyframes
  std::vector<float> start_mean;  ///< both before any learning
  float start_variance = 0;
  double start_weight = 0;  ///< the remaining initial weight, in keyframes
  double light_weight = 0;  ///< a small initial weight without forgetting
  double forgetting = 1;
  ViewQueue views;
  std::vector<uint8_t> readable;  ///< per query frame
  TrainComponents components;
  Projector project;              ///< not set: no component is subtracted
  std::vector<FrameTerms> terms;  ///< per query frame, of those begun
  ScoreKernels kernels;
  float least_variance = 0;
  float most_variance = 0;

  /// A keyframe whose distances are learned in the next pass over the training frames.
  struct ViewUpdate {
    size_t view = 0;
    float gain = 0;
  };
  std::optional<ViewUpdate> update;
  /// Rows of the pending keyframes, if kept. The row of the current frame, the last one, holds the
  /// distances of the learned keyframe until its own replace them, range by range.
  std::vector<std::vector<uint16_t>> rows;
  bool keeps_row = false;  ///< whether the frame's distances are kept
  size_t frame = 0;
  std::vector<uint16_t> row;  ///< the frame's distances, if row_total is not set
};

/// Begins a query. With an offline basis, learns all keyframes here and none later. Throws
/// Error(interrupted) once the user wants to stop.
std::shared_ptr<ZScoreState> start_zscores(FrameDistances distances, const ScoreBasis& basis,
                                           const Monitor& monitor);

/// The query's frame distances as scores (score_kernels.h), in order, because later frames use
/// statistics of earlier ones. start_row determines what is learned before a frame is scored; an
/// unreadable frame is not a keyframe. Copies share the state.
FrameDistances zscores(const std::shared_ptr<ZScoreState>& state);

/// Convenience: starts the state, normalizes, and fuses with FAB-MAP.
FrameDistances zscores(FrameDistances distances, const ScoreBasis& basis, const Monitor& monitor);

}  // namespace vpr
