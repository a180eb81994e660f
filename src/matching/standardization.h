// Standardized scores: frame distances without the bias of frames that are close to everything.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "base/enum_names.h"
#include "database/train_statistics.h"
#include "matching/bit_counts.h"

namespace vpr {

/// What a window's score is the sum of. raw: Hamming distances. standardized: z, from what was
/// learned before the frame; causal. standardized_offline: z, from what the whole query shows.
enum class Score { raw, standardized, standardized_offline };
template <>
inline constexpr std::array<std::string_view, 3> kEnumNames<Score> = {"raw", "standardized",
                                                                      "standardized-offline"};

struct StandardizationSettings {
  double forgetting = 0.98;         ///< weight that is left of what was learned, one view later
  double start_weight = 20;         ///< of the training statistics, in views
  double offline_start_weight = 2;  ///< the same where the whole query is known
  double deviation_floor = 10;      ///< smallest standard deviation, in bits
  /// A frame shows a new view if it differs from the last ones by at least this share of the
  /// typical distance of training frames. 0: every frame does.
  double view_change = 0.25;
  uint64_t lag_views = 5;  ///< a view is learned when so many newer ones have been seen
  bool centre = true;      ///< false: rows keep their mean
  bool learn = true;       ///< false: the training statistics only
  bool divide = true;      ///< false: every standard deviation is kUnknownDeviation
};

template <class Visitor>
void visit_fields(StandardizationSettings& settings, Visitor&& visit) {
  visit("forgetting", settings.forgetting);
  visit("start_weight", settings.start_weight);
  visit("offline_start_weight", settings.offline_start_weight);
  visit("deviation_floor", settings.deviation_floor);
  visit("view_change", settings.view_change);
  visit("lag_views", settings.lag_views);
  visit("centre", settings.centre);
  visit("learn", settings.learn);
  visit("divide", settings.divide);
}

/// Throws Error(usage) for settings out of range.
void check_standardization(const StandardizationSettings& settings);

/// Sums of 16-bit scores stay below 2^32.
inline constexpr size_t kMaxScoredWindow = 65536;

/// What standardized scores of a query start from. `bias` and `variance` have one entry a frame of
/// the TrainCodes that are matched.
struct ScoreBasis {
  StandardizationSettings settings;
  bool offline = false;
  double typical_distance = 0;
  std::vector<float> bias;
  std::vector<float> variance;
  BitCounts bits;  ///< of the training frames that rows are centred over
};

/// What is taken from the distances of a frame: the mean over the training frames, or, for rows
/// that keep theirs, the typical distance.
float row_offset(const ScoreBasis& basis, const CodeWords& frame);

/// Bits in which two codes differ.
uint32_t code_distance(const CodeWords& a, const CodeWords& b);

/// The last views of a query. Time is counted in views: a walk that is slower, or filmed with more
/// frames a second, shows as many, and one that stands still shows none.
struct ViewQueue {
  double least_change = 0;  ///< in bits
  size_t lag = 1;
  std::vector<CodeWords> pending;  ///< seen and not learned yet; at most `lag`, oldest first
};

ViewQueue make_view_queue(const ScoreBasis& basis);

/// Whether the frame differs from every pending view by at least least_change.
bool is_new_view(const ViewQueue& queue, const CodeWords& frame);

/// Adds a view; gives the one that thereby becomes old enough to be learned, if any.
std::optional<CodeWords> push_view(ViewQueue& queue, const CodeWords& view);

}  // namespace vpr
