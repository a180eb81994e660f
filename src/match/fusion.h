// Fusion of standardized scores with FAB-MAP: the evidence of words for each training frame, and
// how reliable either method has been so far.
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

/// Whole numbers a nat.
inline constexpr int32_t kNatUnit = 1024;

/// FAB-MAP of a database as it is unless something else is set: Chow-Liu tree, P(z|e) = 0.39,
/// P(z|not e) = 0.
struct ViewEvidence {
  std::shared_ptr<const FusedViews> of;
  FabmapModel model;
  FabmapIndex index;
};

/// `views` is not null.
std::shared_ptr<const ViewEvidence> make_view_evidence(std::shared_ptr<const FusedViews> views);

/// The log-likelihood of every view in 1/1024 nat, rounded to the nearest, a half up; less
/// something that is the same for all views of the frame. From the fixed-point sums of
/// fabmap2_fixed_log_likelihoods, within 1e-4 nat and half a unit.
std::vector<int32_t> view_likelihoods(const ViewEvidence& evidence, const WordSet& words);

/// A training sequence whose frames are matched.
struct FusedWalk {
  size_t sequence = 0;  ///< of the database
  size_t frames = 0;
  size_t neighbours = 0;  ///< frames so far apart may show the same place
};

/// The training frames that a query frame matches best, by either method; none where it says
/// nothing.
struct BestFrames {
  std::optional<size_t> likeliest;  ///< by FAB-MAP
  std::optional<size_t> closest;    ///< by score
};

/// Who walks is near where he was a frame ago. So of a method that knows the place, the best match
/// is near that of the frame before, and near the other method's where that knows it, too; of one
/// that guesses, it is so by chance only. Counts of both, less what chance gives.
struct Agreement {
  double likeliest_steps = 0;
  double closest_steps = 0;
  double together = 0;
  BestFrames last;  ///< of the frame before

  /// Of two consecutive frames, both with words, and of the later one alone.
  void count(const BestFrames& best, std::span<const FusedWalk> walks);

  /// By how many times FAB-MAP knows more than scores do: what it was right by more than chance
  /// (the mean of likeliest_steps and together) over closest_steps; none below 0, and five frames
  /// of 0.6 and 1 added, which stand for what is not known yet.
  double ratio() const;
};

/// The closest frame of a row of scores that comes in parts, from several threads at once: of equal
/// scores the first.
class ClosestFrame {
 public:
  void reset() { best_.store(kNone, std::memory_order_relaxed); }
  void add(uint16_t score, size_t frame);
  std::optional<size_t> frame() const;

 private:
  static constexpr uint64_t kNone = ~uint64_t{0};
  std::atomic<uint64_t> best_{kNone};  ///< score and frame
};

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
