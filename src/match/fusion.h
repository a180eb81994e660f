// Fusion of z-scores with FAB-MAP: the evidence of words for each training frame, and the
// reliability of both methods so far.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "fabmap/database.h"
#include "fabmap/model.h"
#include "match/frame_distances.h"
#include "store/train_statistics.h"

namespace vpr {

/// Integers per nat.
inline constexpr int32_t kNatUnit = 1024;

/// FAB-MAP of a database with default settings: Chow-Liu tree, P(z|e) = 0.39, P(z|not e) = 0.
struct ViewEvidence {
  std::shared_ptr<const FusedViews> of;
  FabmapModel model;
  FabmapIndex index;
};

/// `views` is not null.
std::shared_ptr<const ViewEvidence> make_view_evidence(std::shared_ptr<const FusedViews> views);

/// The log-likelihood of every view in 1/1024 nat, rounded to nearest, ties up, minus a constant
/// that is the same for all views of the frame. From the fixed-point sums of
/// fabmap2_fixed_log_likelihoods, within 1e-4 nat and half a unit.
std::vector<int32_t> view_likelihoods(const ViewEvidence& evidence, const WordSet& words);

/// A training sequence whose frames are matched.
struct FusedWalk {
  size_t sequence = 0;  ///< of the database
  size_t frames = 0;
  size_t neighbors = 0;  ///< frames within this distance may show the same place
};

/// The best training frame of a query frame for each method; unset without information.
struct BestFrames {
  std::optional<size_t> likeliest;  ///< by FAB-MAP
  std::optional<size_t> closest;    ///< by score
};

/// Motion is continuous. The best match of a reliable method is therefore near its previous best
/// match, and near the best match of the other method if that is reliable as well; for random
/// matches this happens only by chance. Counts both events, minus their expected number by chance.
struct Agreement {
  double likeliest_steps = 0;
  double closest_steps = 0;
  double together = 0;
  BestFrames last;  ///< of the previous frame

  /// Counts steps for two consecutive frames that both have words, and agreement for the later
  /// frame.
  void count(const BestFrames& best, std::span<const FusedWalk> walks);

  /// The estimated reliability of FAB-MAP relative to the scores: counts above chance (the mean of
  /// likeliest_steps and together) over closest_steps; negative counts are 0, and five frames of
  /// 0.6 and 1 are added as a prior.
  double ratio() const;
};

/// The closest frame of a row of scores that arrives in parts, from several threads; the first one
/// on a tie.
class ClosestFrame {
 public:
  void reset() { best_.store(kNone, std::memory_order_relaxed); }
  void add(uint16_t score, size_t frame);
  std::optional<size_t> frame() const;

 private:
  static constexpr uint64_t kNone = ~uint64_t{0};
  std::atomic<uint64_t> best_{kNone};  ///< score and frame
};

/// The fusion weight in deviations per nat for equally reliable methods (default), and its maximum.
inline constexpr double kFusionWeight = 0.2;
inline constexpr double kMostFusionWeight = 1;

/// The evidence that is fused with scores; nothing is fused if it is null.
struct FusionBasis {
  std::shared_ptr<const ViewEvidence> evidence;
  double weight = kFusionWeight;  ///< beta: deviations per nat
  std::vector<uint32_t> views;    ///< of the matched training frames
  std::vector<FusedWalk> walks;   ///< the sequences of these frames, in their order
};

/// The fusion basis of all training frames. Neighbors are defined as for training statistics.
FusionBasis make_fusion_basis(std::shared_ptr<const FusedViews> views, double weight,
                              const StatisticsSettings& neighbors);

/// The fusion basis of the sequences whose `keep` is not 0.
FusionBasis fusion_of(const FusionBasis& all, const std::vector<uint8_t>& keep);

/// The effect of a frame's words on its scores: (z + added) * scale.
struct FusionRow {
  /// In deviations, one value per training frame: -w (behind - mean of behind), where behind is the
  /// log-likelihood of a training frame's view minus the value of the likeliest one, at least -40
  /// nats. 0 for an undecodable frame, which is not counted, and for a query frame without words.
  std::vector<double> added;
  /// 1 / sqrt(1 + the mean of added^2), so that scores remain in deviations.
  double scale = 1;
  std::optional<size_t> likeliest;  ///< the first of these training frames
};

/// `weight`: w, in deviations per nat.
///
/// `own`: if a training sequence is the query, the training frame of the words; it and its
/// neighbors then count as undecodable, because a query of another place has no view of its own.
FusionRow fusion_row(const FusionBasis& basis, const WordSet& words, double weight,
                     std::optional<size_t> own = std::nullopt);

/// w of the next frame: beta * ratio^1.5, at most 1.
double fusion_weight(const FusionBasis& basis, const Agreement& agreement);

/// The state of a query.
struct FusionState {
  Agreement agreement;
  std::optional<size_t> likeliest;  ///< of the frame whose row was started last
  ClosestFrame closest;             ///< of this row, by scores before the fusion
};

/// Scores (score_kernels.h) with fusion_row, rounded to nearest, ties up, and clamped like scores,
/// with the weight determined by earlier frames. `scores` come in order, with complete rows; the
/// query has words. If its words are those of FusedViews themselves (not copies), it is a training
/// sequence, from which nothing is learned: w is beta / 2. Without a `state`, a new query begins.
FrameDistances fused(FrameDistances scores, const FusionBasis& basis,
                     std::shared_ptr<FusionState> state = nullptr);

}  // namespace vpr
