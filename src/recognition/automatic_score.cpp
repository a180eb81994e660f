#include "recognition/automatic_score.h"

#include <tuple>

#include "matching/fastable_standardized.h"
#include "recognition/threshold.h"

namespace vpr {
namespace {

using ClosestTable = std::vector<std::optional<ClosestWindows>>;

void keep_closer(std::optional<ClosestWindows>& kept, const ClosestWindows& candidate) {
  const auto key = [](const ClosestWindows& c) {
    return std::tie(c.distance, c.window, c.other_sequence, c.other_window);
  };
  if (!kept || key(candidate) < key(*kept)) kept = candidate;
}

// One sequence as the query, against all others.
void compare_with_others(std::span<const CodeSpan> sequences, size_t own, const ScoreBasis& basis,
                         const MatchSettings& settings, const Monitor& monitor,
                         ClosestTable& table) {
  std::vector<CodeSpan> others(sequences.begin(), sequences.end());
  std::vector<uint8_t> keep(sequences.size(), 1);
  others[own] = {};
  keep[own] = 0;
  ScoreBasis rest = basis_of(basis, sequences, keep);
  rest.bits = without(basis.bits, count_bits(sequences.subspan(own, 1)));
  const HammingKernels& kernels = settings.kernels;
  match_standardized(
      make_train_codes(others), make_query_codes(sequences[own]), {&settings.window_length, 1},
      rest, settings, monitor, [&](size_t, const DistanceRow& row) {
        const uint32_t* scores = row.distances.data();
        const size_t count = row.distances.size();
        const uint32_t least = kernels.minimum(scores, count);
        const size_t first = kernels.find_below(scores, 0, count, least + 1);
        keep_closer(table[row.sequence], {least, row.train_window + first, own, row.query_window});
      });
}

}  // namespace

ClosestTable find_closest_scores(std::span<const CodeSpan> sequences, const ScoreBasis& basis,
                                 const MatchSettings& settings, const Monitor& monitor) {
  ClosestTable table(sequences.size());
  for (size_t own = 0; own < sequences.size(); ++own)
    compare_with_others(sequences, own, basis, settings, monitor, table);
  return table;
}

double automatic_score_threshold(const ClosestWindows& closest, size_t window_length,
                                 double margin) {
  return mean_z(closest.distance, window_length) - margin;
}

ScoreBasis basis_of(const ScoreBasis& all, std::span<const CodeSpan> sequences,
                    const std::vector<uint8_t>& keep) {
  ScoreBasis basis = all;
  basis.bias.clear();
  basis.variance.clear();
  ptrdiff_t first = 0;
  for (size_t s = 0; s < sequences.size(); ++s) {
    const auto end = first + static_cast<ptrdiff_t>(sequences[s].codes.size());
    if (keep[s] != 0) {
      basis.bias.insert(basis.bias.end(), all.bias.begin() + first, all.bias.begin() + end);
      basis.variance.insert(basis.variance.end(), all.variance.begin() + first,
                            all.variance.begin() + end);
    }
    first = end;
  }
  return basis;
}

}  // namespace vpr
