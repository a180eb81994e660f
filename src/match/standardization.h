// Standardized scores: frame distances without the bias of frames that are close to everything.
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

/// What a window's score is the sum of. raw: frame distances. standardized: z, from what was
/// learned before the frame; causal. standardized_offline: z, from what the whole query shows.
enum class Score { raw, standardized, standardized_offline };
template <>
inline constexpr std::array<std::string_view, 3> kEnumNames<Score> = {"raw", "standardized",
                                                                      "standardized-offline"};

/// How z-scores are taken, and what of the query is learned.
struct StandardizationSettings {
  double forgetting = 0.98;         ///< weight that is left of what was learned, one view later
  double start_weight = 20;         ///< of the training statistics, in views
  double offline_start_weight = 2;  ///< the same where the whole query is known
  /// Share of how much closer than others a frame is to the training frames that is taken to hold
  /// for the query's frames, too.
  double start_bias = 0.5;
  /// Smallest standard deviation, in bits of LDB: of another largest distance, the same share.
  double deviation_floor = 10;
  /// A frame shows a new view if it differs from the last ones by at least this share of the
  /// typical distance of training frames. 0: every frame does.
  double view_change = 0.25;
  uint64_t lag_views = 5;  ///< a view is learned when so many newer ones have been seen
  /// Of the training frames, that are taken from distances in part; at most 6. 0: none.
  uint64_t components = kMostComponents;
  bool centre = true;  ///< false: rows keep their mean
  bool learn = true;   ///< false: the training statistics only
  bool divide = true;  ///< false: every standard deviation is unknown_deviation
};

template <class Visitor>
void visit_fields(StandardizationSettings& settings, Visitor&& visit) {
  visit("forgetting", settings.forgetting);
  visit("start_weight", settings.start_weight);
  visit("offline_start_weight", settings.offline_start_weight);
  visit("start_bias", settings.start_bias);
  visit("deviation_floor", settings.deviation_floor);
  visit("view_change", settings.view_change);
  visit("lag_views", settings.lag_views);
  visit("components", settings.components);
  visit("centre", settings.centre);
  visit("learn", settings.learn);
  visit("divide", settings.divide);
}

/// Checks settings. Throws Error(usage) for what is out of range.
void check_standardization(const StandardizationSettings& settings);

/// Sums of 16-bit scores stay below 2^32.
inline constexpr size_t kMaxScoredWindow = 65536;

/// What standardized scores of a query start from.
struct ScoreBasis {
  StandardizationSettings settings;
  bool offline = false;
  double typical_distance = 0;
  std::vector<float> mean;     ///< of centred distances; one a training frame that is matched
  float variance = 0;          ///< of centred distances, the same for all training frames
  TrainComponents components;  ///< loadings: one a training frame that is matched
  FusionBasis fusion = {};     ///< what FAB-MAP says takes from z
};

/// The start that training statistics give: of every frame `start_bias` of its bias, less what is
/// taken from distances because of it, and the mean variance of all, for how far a frame's own
/// distances to the training walk spread says next to nothing of those to a query.
ScoreBasis make_score_basis(const StandardizationSettings& settings, bool offline,
                            const TrainStatistics& statistics);

/// The basis for the training sequences that are left when those whose `keep` is 0 have no frames.
/// `all` is that of all of them together.
ScoreBasis basis_of(const ScoreBasis& all, std::span<const DescriptorSpan> sequences,
                    const std::vector<uint8_t>& keep);

/// The smallest standard deviation, in units of distances whose largest is `largest`.
double deviation_floor(const StandardizationSettings& settings, uint16_t largest);

/// The last views of a query. Time is counted in views: a walk that is slower, or filmed with more
/// frames a second, shows as many, and one that stands still shows none.
struct ViewQueue {
  double least_change = 0;  ///< a frame distance
  size_t lag = 1;
  std::vector<size_t> pending;  ///< frames seen and not learned yet; at most `lag`, oldest first
};

/// An empty queue. typical_distance is that of training frames.
ViewQueue make_view_queue(const StandardizationSettings& settings, double typical_distance);

/// Whether a frame of `rows` differs from every pending view, also of `rows`, by at least
/// least_change.
bool is_new_view(const ViewQueue& queue, const DescriptorRows& rows, size_t frame);

/// Adds a view; gives the one that thereby becomes old enough to be learned, if any.
std::optional<size_t> push_view(ViewQueue& queue, size_t view);

/// The frames that start a new view, rising; the first frame always does. A frame is a new view if
/// it differs from the last views as standardized scores define it (is_new_view), with the default
/// settings: from each of the last five by at least a quarter of `typical_distance`. Unreadable
/// frames belong to the view before them. No frames give no views.
std::vector<uint32_t> view_starts(const DescriptorSpan& sequence, double typical_distance);

}  // namespace vpr
