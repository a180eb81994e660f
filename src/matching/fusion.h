// FAB-MAP and sequences together: standardized frame distances less what the words of the frame say
// for a training frame.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "database/train_statistics.h"
#include "matching/frame_distances.h"

namespace vpr {

struct ViewEvidence;

/// The deviations that a nat is worth, unless something else is said.
inline constexpr double kFusionWeight = 0.25;
inline constexpr double kMostFusionWeight = 2;

/// A training sequence whose frames are matched.
struct FusedWalk {
  size_t sequence = 0;  ///< of the database
  size_t frames = 0;
  size_t neighbours = 0;  ///< frames so far apart may show the same place
};

/// What is taken from scores: nothing where there is no evidence.
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

/// What a frame's words take from its scores, one number a training frame, in 1/1024 deviation:
/// weight * (level / 2 + lead), rounded to the nearest, a half up. With l the log-likelihood of a
/// training frame's view in 1/1024 nat, level is l less its mean over the training frames (rounded
/// down from a half up), within -4 and 6 nats, and lead is by how much more than 2 nats l exceeds
/// the largest of training frames elsewhere, 10 nats at most. Elsewhere are frames of its sequence
/// that are no neighbours, and those of sequences that show other places; where nothing is, there
/// is no lead. 0 for frames that could not be decoded, which count nowhere, and for a frame
/// without words.
///
/// `own`: which of all training frames the words are of, where a training walk is the query; then
/// it and its neighbours count as if they could not be decoded, since a query that comes by
/// another place has no such view.
std::vector<int16_t> fusion_row(const FusionBasis& basis, const WordSet& words,
                                std::optional<size_t> own = std::nullopt);

/// Scores (score_kernels.h) less fusion_row, cut off as scores are. `scores` come in order, and the
/// query has words; one whose words are those of FusedViews (not copies) is a training walk.
FrameDistances fused(FrameDistances scores, const FusionBasis& basis);

/// How far the oracle may be from a frame's part of fused scores, in 1/1024 deviation.
double fusion_tolerance(const FusionBasis& basis);

/// The oracle: the same in deviations, in double precision, from the likelihoods of the definition
/// (fabmap1) and without re-use.
std::vector<double> plain_fusion_row(const FusionBasis& basis, const WordSet& words);

}  // namespace vpr
