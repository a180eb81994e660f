// Fusion of z-scores with FAB-MAP: the evidence of words for each training frame.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "match/frame_distances.h"
#include "store/train_statistics.h"
#include "words/database.h"
#include "words/model.h"

namespace vpr {

/// FAB-MAP of a database with default settings: Chow-Liu tree, P(z|e) = 0.39, P(z|not e) = 0.
struct ViewEvidence {
  std::shared_ptr<const FusedViews> of;
  FabmapModel model;
  FabmapIndex index;
};

/// A training sequence whose frames are matched.
struct FusedSequence {
  size_t frames = 0;
  size_t neighbors = 0;  ///< frames within this distance may show the same place
};

/// The best training frame of a query frame for each method; unset without information.
struct BestFrames {
  std::optional<size_t> likeliest;  ///< by FAB-MAP
  std::optional<size_t> closest;    ///< by score
};

/// The reliability of both methods so far. Motion is continuous: the best match of a reliable
/// method is near its previous best match, and near the best match of another reliable method.
/// Random matches are near each other only by chance. Counts both events, minus their expected
/// number by chance.
struct FusionState {
  double likeliest_steps = 0;
  double closest_steps = 0;
  double together = 0;
  BestFrames last;  ///< of the previous frame

  /// Counts steps for two consecutive frames that both have words, and agreement for the later
  /// frame.
  void count(const BestFrames& best, std::span<const FusedSequence> sequences);

  /// The estimated reliability of FAB-MAP relative to the scores: counts above chance (the mean of
  /// likeliest_steps and together) over closest_steps; negative counts are 0, and five frames of
  /// 0.6 and 1 are added as a prior.
  double ratio() const;
};

/// The fusion weight in deviations per nat for equally reliable methods (default), and its maximum.
inline constexpr double kFusionWeight = 0.2;
inline constexpr double kMostFusionWeight = 1;

/// The evidence that is fused with scores.
struct FusionBasis {
  std::shared_ptr<const ViewEvidence> evidence;
  double weight = kFusionWeight;         ///< beta: deviations per nat
  std::vector<uint32_t> views;           ///< of the matched training frames
  std::vector<FusedSequence> sequences;  ///< of these frames, in their order
};

/// The fusion basis of all training frames. Neighbors are defined as for training statistics.
FusionBasis make_fusion_basis(std::shared_ptr<const FusedViews> views, double weight,
                              const StatisticsSettings& neighbors);

/// The effect of a frame's words on its scores: (z + added) * scale.
struct FusionRow {
  /// In deviations, one value per training frame: -w (gap - mean gap), where the gap is the
  /// log-likelihood of the frame's view minus the likeliest view's, at least -40 nats.
  /// Log-likelihoods are rounded to 1/1024 nat, ties up. 0 for an undecodable frame, which is not
  /// counted, and for a query frame without words.
  std::vector<double> added;
  /// 1 / sqrt(1 + the mean of added^2), so that scores remain in deviations.
  double scale = 1;
  std::optional<size_t> likeliest;  ///< the first of these training frames
};

/// `weight`: w, in deviations per nat.
FusionRow fusion_row(const FusionBasis& basis, const WordSet& words, double weight);

/// w of the next frame: beta * ratio^1.5, at most 1.
double fusion_weight(const FusionBasis& basis, const FusionState& state);

/// Scores (score_kernels.h) with fusion_row, rounded to nearest, ties up, and clamped like scores,
/// with the weight determined by earlier frames, which `state` counts. `scores` are in order; the
/// query has words.
FrameDistances fused(FrameDistances scores, std::shared_ptr<const FusionBasis> basis,
                     std::shared_ptr<FusionState> state);

}  // namespace vpr
