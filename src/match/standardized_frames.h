// Standardized frame distances: of one query frame after the other, z instead of distances.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "base/monitor.h"
#include "match/components.h"
#include "match/frame_distances.h"
#include "match/score_kernels.h"
#include "match/standardization.h"

namespace vpr {

/// The rows of distances of so many pending views are kept until they are learned, 2 bytes a
/// training frame each; with a longer lag they are computed again.
inline constexpr size_t kMostKeptRows = 8;

/// What is taken from the distances of a query frame.
struct FrameTerms {
  float offset = 0;  ///< the mean over the training frames; the typical distance where rows keep it
  CommonWeights common = {};  ///< of the training frames' components
};

/// What is known of every training frame's centred distances: 12 bytes a frame, and the rows that
/// are kept.
struct StandardizedState {
  FrameDistances distances;  ///< that are standardized
  StandardizationSettings settings;
  bool offline = false;
  double typical_distance = 0;
  std::vector<float> mean;
  std::vector<float> variance;
  double weight = 0;              ///< of both, in views
  std::vector<float> start_mean;  ///< both before anything was learned
  float start_variance = 0;
  double start_weight = 0;  ///< what is left of it, in views
  double light_weight = 0;  ///< of one that counts for little, and is not forgotten
  double forgetting = 1;
  ViewQueue views;
  std::vector<uint8_t> readable;  ///< per query frame
  TrainComponents components;
  Projector project;              ///< not set: no component is taken away
  std::vector<FrameTerms> terms;  ///< per query frame, of those that began
  ScoreKernels kernels;
  float least_variance = 0;
  float most_variance = 0;

  /// A view whose distances are learned together with the next pass over the training frames.
  struct ViewUpdate {
    size_t view = 0;
    float gain = 0;
  };
  std::optional<ViewUpdate> update;
  /// Of the pending views, where they are kept. That of the frame, the last one, still has the
  /// distances of the view that is learned, stretch by stretch, until its own come.
  std::vector<std::vector<uint16_t>> rows;
  bool keeps_row = false;  ///< whether the frame's distances are kept
  size_t frame = 0;
  std::vector<uint16_t> row;  ///< the frame's distances, where their sum takes as long as the row
};

/// A query that begins. The views of one whose basis is offline are all learned here, and none
/// later. Throws Error(interrupted) once the user wants to stop.
std::shared_ptr<StandardizedState> start_standardized(FrameDistances distances,
                                                      const ScoreBasis& basis,
                                                      const Monitor& monitor);

/// The frame distances of that query: scores (score_kernels.h), which come in order, for what a
/// frame teaches is known to later ones. start_row decides what is learned before a frame is
/// scored; a frame that can't be read is no view. Copies share the state.
FrameDistances standardized(const std::shared_ptr<StandardizedState>& state);

/// Both, where the state is nobody else's business, and what FAB-MAP says taken from them.
FrameDistances standardized(FrameDistances distances, const ScoreBasis& basis,
                            const Monitor& monitor);

}  // namespace vpr
