// FAB-MAP and sequences together: standardized frame distances with what the words of the frame say
// of training frames.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "database/train_statistics.h"
#include "matching/agreement.h"
#include "matching/frame_distances.h"

namespace vpr {

struct ViewEvidence;

/// The deviations that a nat is worth where FAB-MAP and scores know as much, unless something else
/// is said, and at most.
inline constexpr double kFusionWeight = 0.2;
inline constexpr double kMostFusionWeight = 1;

/// What is fused with scores: nothing where there is no evidence.
struct FusionBasis {
  std::shared_ptr<const ViewEvidence> evidence;
  double weight = kFusionWeight;  ///< beta: deviations a nat
  std::vector<uint32_t> views;    ///< of the training frames that are matched
  std::vector<FusedWalk> walks;   ///< that they belong to, in their order
};

/// Of all training frames. Frames count as neighbours as training statistics have it.
FusionBasis make_fusion_basis(std::shared_ptr<const FusedViews> views, double weight,
                              const StatisticsSettings& neighbours);

/// Of the sequences whose `keep` is not 0.
FusionBasis fusion_of(const FusionBasis& all, const std::vector<uint8_t>& keep);

/// What a frame's words make of its scores: (z + added) * scale.
struct FusionRow {
  /// In deviations, one number a training frame: -w (behind - mean of behind), where behind is the
  /// log-likelihood of a training frame's view less that of the likeliest one, -40 nats at least.
  /// 0 for a frame that could not be decoded, which counts nowhere, and of a query frame without
  /// words.
  std::vector<double> added;
  /// 1 / sqrt(1 + the mean of added^2): so that scores stay in deviations.
  double scale = 1;
  std::optional<size_t> likeliest;  ///< the first such training frame
};

/// `weight`: w, deviations a nat.
///
/// `own`: which of all training frames the words are of, where a training walk is the query; then
/// it and its neighbours count as if they could not be decoded, since a query that comes by
/// another place has no such view.
FusionRow fusion_row(const FusionBasis& basis, const WordSet& words, double weight,
                     std::optional<size_t> own = std::nullopt);

/// w of the next frame: beta ratio^1.5, 1 at most.
double fusion_weight(const FusionBasis& basis, const Agreement& agreement);

/// What is known of the query so far.
struct FusionState {
  Agreement agreement;
  std::optional<size_t> likeliest;  ///< of the frame whose row was started last
  ClosestFrame closest;             ///< of that row, by scores before they are fused
};

/// Scores (score_kernels.h) with fusion_row, rounded to the nearest, a half up, and cut off as
/// scores are; with the weight that the frames before lead to. `scores` come in order, all of a
/// row's; the query has words. One whose words are those of FusedViews (not copies) is a training
/// walk, of which nothing is learned: w is beta / 2. Without a `state` a query begins.
FrameDistances fused(FrameDistances scores, const FusionBasis& basis,
                     std::shared_ptr<FusionState> state = nullptr);

}  // namespace vpr
