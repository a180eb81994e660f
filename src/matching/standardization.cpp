#include "matching/standardization.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include <fmt/format.h>

#include "base/error.h"

namespace vpr {
namespace {

void require(bool is_fine, const char* key, const char* range, double found) {
  if (!is_fine)
    throw Error(ErrorKind::usage,
                fmt::format("standardization.{} must be {}, found {}", key, range, found));
}

}  // namespace

void check_standardization(const StandardizationSettings& settings) {
  constexpr double kMostWeight = 1e6;
  constexpr uint64_t kMostLag = 10'000;
  require(settings.forgetting > 0 && settings.forgetting <= 1, "forgetting", "above 0, at most 1",
          settings.forgetting);
  require(settings.start_weight >= 0 && settings.start_weight <= kMostWeight, "start_weight",
          "from 0 to 1000000", settings.start_weight);
  require(settings.offline_start_weight >= 0 && settings.offline_start_weight <= kMostWeight,
          "offline_start_weight", "from 0 to 1000000", settings.offline_start_weight);
  require(settings.deviation_floor >= 1 && settings.deviation_floor <= kLdbBits, "deviation_floor",
          "from 1 to 1386 bits", settings.deviation_floor);
  require(settings.view_change >= 0 && settings.view_change <= 10, "view_change", "from 0 to 10",
          settings.view_change);
  require(settings.lag_views >= 1 && settings.lag_views <= kMostLag, "lag_views", "from 1 to 10000",
          static_cast<double>(settings.lag_views));
}

float row_offset(const ScoreBasis& basis, const CodeWords& frame) {
  return static_cast<float>(basis.settings.centre ? mean_distance(basis.bits, frame)
                                                  : basis.typical_distance);
}

uint32_t code_distance(const CodeWords& a, const CodeWords& b) {
  int distance = 0;
  uint64_t before = 0;
  for (size_t w = 0; w < kCodeWords; ++w) {
    const uint64_t parity = a[w] ^ b[w];
    distance += std::popcount(parity ^ before);
    before = parity;
  }
  return static_cast<uint32_t>(distance);
}

ViewQueue make_view_queue(const ScoreBasis& basis) {
  return {basis.settings.view_change * basis.typical_distance, basis.settings.lag_views, {}};
}

bool is_new_view(const ViewQueue& queue, const CodeWords& frame) {
  return std::all_of(queue.pending.begin(), queue.pending.end(), [&](const CodeWords& view) {
    return code_distance(view, frame) >= queue.least_change;
  });
}

std::optional<CodeWords> push_view(ViewQueue& queue, const CodeWords& view) {
  queue.pending.push_back(view);
  if (queue.pending.size() <= queue.lag) return std::nullopt;
  const CodeWords oldest = queue.pending.front();
  queue.pending.erase(queue.pending.begin());
  return oldest;
}

}  // namespace vpr
