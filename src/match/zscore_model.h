// Z-scores: frame distances without the bias of hubs, frames that are close to everything.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "base/enum_names.h"
#include "describe/descriptor_rows.h"
#include "match/frame_distances.h"
#include "match/fusion.h"
#include "store/train_statistics.h"

namespace vpr {

/// The terms of a window's score. raw: frame distances. zscore: z-scores, from statistics of
/// earlier frames; causal. zscore_offline: z, from statistics of the whole query.
enum class Score { raw, zscore, zscore_offline };
template <>
inline constexpr std::array<std::string_view, 3> kEnumNames<Score> = {"raw", "zscore",
                                                                      "zscore-offline"};

/// The computation of z-scores, and what is learned from the query.
struct ZScoreSettings {
  double forgetting = 0.98;         ///< weight of learned statistics after one more keyframe
  double start_weight = 20;         ///< of the training statistics, in keyframes
  double offline_start_weight = 2;  ///< of the training statistics if the whole query is known
  /// Share of a training frame's bias among the training frames that is assumed for the query's
  /// frames as well.
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

template <class Visitor>
void visit_fields(ZScoreSettings& settings, Visitor&& visit) {
  visit("forgetting", settings.forgetting);
  visit("start_weight", settings.start_weight);
  visit("offline_start_weight", settings.offline_start_weight);
  visit("start_bias", settings.start_bias);
  visit("deviation_floor", settings.deviation_floor);
  visit("keyframe_change", settings.keyframe_change);
  visit("lag_keyframes", settings.lag_keyframes);
  visit("components", settings.components);
  visit("center", settings.center);
  visit("learn", settings.learn);
  visit("divide", settings.divide);
}

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
  FusionBasis fusion = {};     ///< FAB-MAP's part, subtracted from z
};

/// The initial state from training statistics: for every frame `start_bias` of its bias, minus the
/// part explained by components, and the mean variance of all frames, because the variance of a
/// frame's own distances to the training sequence says almost nothing about its distances to a
/// query.
ScoreBasis make_score_basis(const ZScoreSettings& settings, bool offline,
                            const TrainStatistics& statistics);

/// The basis for the training sequences whose `keep` is not 0; the others have no frames. `all` is
/// the basis of all sequences together.
ScoreBasis basis_of(const ScoreBasis& all, std::span<const DescriptorSpan> sequences,
                    const std::vector<uint8_t>& keep);

/// The minimum standard deviation, in units of distances whose largest is `largest`.
double deviation_floor(const ZScoreSettings& settings, uint16_t largest);

/// The last keyframes of a query. Time is counted in keyframes: a slower walk, or one recorded with
/// more frames per second, has the same number, and a stop has none.
struct ViewQueue {
  double least_change = 0;  ///< a frame distance
  size_t lag = 1;
  std::vector<size_t> pending;  ///< frames seen and not learned yet; at most `lag`, oldest first
};

/// An empty queue. typical_distance is the typical distance of training frames.
ViewQueue make_view_queue(const ZScoreSettings& settings, double typical_distance);

/// Whether a frame of `rows` differs from every pending keyframe, also of `rows`, by at least
/// least_change.
bool is_new_view(const ViewQueue& queue, const DescriptorRows& rows, size_t frame);

/// Adds a keyframe; returns the one that is now old enough to be learned, if any.
std::optional<size_t> push_view(ViewQueue& queue, size_t view);

/// The first frames of keyframes, increasing; the first frame always is one. A frame is a new
/// keyframe if it differs from the last ones as for z-scores (is_new_view) with the default
/// settings: from each of the last five by at least a quarter of `typical_distance`. Unreadable
/// frames belong to the previous keyframe. Without frames there are no keyframes.
std::vector<uint32_t> view_starts(const DescriptorSpan& sequence, double typical_distance);

}  // namespace vpr
