#include "evaluation/best_pairs.h"

#include <algorithm>
#include <numeric>

#include "base/parallel.h"

namespace vpr {

std::vector<BestPair> best_pairs(const ScoreMatrix& matrix, const ScoreLayout& layout, size_t most,
                                 const Monitor& monitor) {
  std::vector<std::vector<uint32_t>> columns(matrix.queries());
  matrix.for_each_row(
      thread_count(), monitor, "pairs", [&](size_t, size_t query, std::span<const uint64_t> keys) {
        std::vector<uint32_t> order(keys.size());
        std::iota(order.begin(), order.end(), uint32_t{0});
        const auto end = order.begin() + static_cast<ptrdiff_t>(std::min(most, order.size()));
        std::partial_sort(order.begin(), end, order.end(), [&](uint32_t a, uint32_t b) {
          return keys[a] != keys[b] ? keys[a] < keys[b] : a < b;
        });
        for (auto column = order.begin(); column != end && keys[*column] != kNoScore; ++column)
          columns[query].push_back(*column);
      });
  std::vector<BestPair> pairs;
  for (size_t query = 0; query < columns.size(); ++query)
    for (const uint32_t column : columns[query])
      pairs.push_back({layout.anchor(query), match_of_column(layout, column)});
  return pairs;
}

std::vector<BestPair> best_pairs(const Result& result) {
  std::vector<BestPair> pairs;
  const size_t length = result.window_length();
  for (const auto& best : result.best)
    if (best)
      pairs.push_back(
          {anchor_of(best->query, length), {best->target, anchor_of(best->train, length)}});
  return pairs;
}

}  // namespace vpr
