#include "match/zscore_model.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include "base/error.h"
#include "match/components.h"

namespace vpr {

namespace {

void require(bool is_fine, const char* key, const char* range, double found) {
  if (!is_fine)
    throw Error(ErrorKind::usage, fmt::format("zscore.{} must be {}, found {}", key, range, found));
}

}  // namespace

void check_zscore_settings(const ZScoreSettings& settings) {
  constexpr double kMostWeight = 1e6;
  constexpr uint64_t kMostLag = 10'000;
  require(settings.forgetting > 0 && settings.forgetting <= 1, "forgetting", "above 0, at most 1",
          settings.forgetting);
  require(settings.start_weight >= 0 && settings.start_weight <= kMostWeight, "start_weight",
          "from 0 to 1000000", settings.start_weight);
  require(settings.offline_start_weight >= 0 && settings.offline_start_weight <= kMostWeight,
          "offline_start_weight", "from 0 to 1000000", settings.offline_start_weight);
  require(settings.start_bias >= 0 && settings.start_bias <= 1, "start_bias", "from 0 to 1",
          settings.start_bias);
  require(settings.deviation_floor >= 1 && settings.deviation_floor <= kLdbBits, "deviation_floor",
          "from 1 to 1386 bits", settings.deviation_floor);
  require(settings.keyframe_change >= 0 && settings.keyframe_change <= 10, "keyframe_change",
          "from 0 to 10", settings.keyframe_change);
  require(settings.components <= kMaxComponents, "components", "from 0 to 6",
          static_cast<double>(settings.components));
  require(settings.lag_keyframes >= 1 && settings.lag_keyframes <= kMostLag, "lag_keyframes",
          "from 1 to 10000", static_cast<double>(settings.lag_keyframes));
}

ScoreBasis make_score_basis(const ZScoreSettings& settings, bool offline,
                            const TrainStatistics& statistics) {
  ScoreBasis basis{settings, offline, statistics.typical_distance, {}, 0, {}};
  basis.components = statistics.components.value_or(no_components(statistics.bias.size()));
  ComponentValues of_bias = {};
  for (size_t l = 0; l < basis.components.landmarks.size(); ++l)
    for (size_t k = 0; k < kMaxComponents; ++k)
      of_bias[k] += settings.start_bias * statistics.bias[basis.components.landmarks[l]] *
                    basis.components.weights[l][k];
  const CommonWeights weights = common_weights(basis.components, settings.components, of_bias);
  const double unit = common_unit(basis.components.shape);
  for (size_t i = 0; i < statistics.bias.size(); ++i)
    basis.mean.push_back(static_cast<float>(settings.start_bias * statistics.bias[i] -
                                            unit * common_sum(basis.components, weights, i)));
  const double sum =
      std::accumulate(statistics.variance.begin(), statistics.variance.end(), double{0});
  const double frames = std::max<double>(1, static_cast<double>(statistics.variance.size()));
  basis.variance = static_cast<float>(sum / frames);
  return basis;
}

ScoreBasis basis_of(const ScoreBasis& all, std::span<const DescriptorSpan> sequences,
                    const std::vector<uint8_t>& keep) {
  ScoreBasis basis = all;
  if (all.fusion.evidence != nullptr) basis.fusion = fusion_of(all.fusion, keep);
  basis.mean.clear();
  for (std::vector<int8_t>& loadings : basis.components.loadings) loadings.clear();
  ptrdiff_t first = 0;
  for (size_t s = 0; s < sequences.size(); ++s) {
    const auto end = first + static_cast<ptrdiff_t>(sequences[s].rows.size());
    if (keep[s] != 0) {
      basis.mean.insert(basis.mean.end(), all.mean.begin() + first, all.mean.begin() + end);
      for (size_t k = 0; k < kMaxComponents; ++k) {
        const std::vector<int8_t>& from = all.components.loadings[k];
        std::vector<int8_t>& to = basis.components.loadings[k];
        to.insert(to.end(), from.begin() + first, from.begin() + end);
      }
    }
    first = end;
  }
  return basis;
}

double deviation_floor(const ZScoreSettings& settings, uint16_t largest) {
  return settings.deviation_floor * reference_bit(largest);
}

ViewQueue make_view_queue(const ZScoreSettings& settings, double typical_distance) {
  return {settings.keyframe_change * typical_distance, settings.lag_keyframes, {}};
}

bool is_new_view(const ViewQueue& queue, const DescriptorRows& rows, size_t frame) {
  return std::all_of(queue.pending.begin(), queue.pending.end(), [&](size_t view) {
    return frame_distance(rows, view, frame) >= queue.least_change;
  });
}

std::optional<size_t> push_view(ViewQueue& queue, size_t view) {
  queue.pending.push_back(view);
  if (queue.pending.size() <= queue.lag) return std::nullopt;
  const size_t oldest = queue.pending.front();
  queue.pending.erase(queue.pending.begin());
  return oldest;
}

std::vector<uint32_t> view_starts(const DescriptorSpan& sequence, double typical_distance) {
  ViewQueue views = make_view_queue({}, typical_distance);
  std::vector<uint32_t> starts;
  for (size_t frame = 0; frame < sequence.rows.size(); ++frame) {
    const auto& gaps = sequence.unreadable;
    const bool is_readable = !std::binary_search(gaps.begin(), gaps.end(), frame);
    const bool is_new = is_readable && is_new_view(views, sequence.rows, frame);
    if (is_new) push_view(views, frame);
    if (is_new || frame == 0) starts.push_back(static_cast<uint32_t>(frame));
  }
  return starts;
}

}  // namespace vpr
