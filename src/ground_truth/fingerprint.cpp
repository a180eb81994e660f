#include "ground_truth/fingerprint.h"

#include <array>
#include <span>
#include <vector>

#include "base/checksum.h"
#include "ground_truth/ground_truth.h"
#include "ground_truth/label_runs.h"

namespace vpr {

std::string ground_truth_fingerprint(const GroundTruth& truth, const GroundTruthScope& scope,
                                     const Monitor& monitor) {
  std::vector<uint64_t> place_among_searched;
  uint64_t searched = 0;
  for (const auto& sequence : scope.sequences)
    place_among_searched.push_back(sequence.searched ? searched++ : searched);
  ChecksumStream sum;
  const auto add = [&](const auto& numbers) { sum.add(std::as_bytes(std::span(numbers))); };
  add(std::array<uint64_t, 1>{truth.pairs.size()});
  for (size_t query = 0; query < truth.pairs.size(); ++query) {
    check_stop(monitor);
    const auto& row = truth.pairs[query];
    for (size_t i = 0; i < row.size();) {
      const size_t s = row[i].sequence;
      i += truth.pairs_of(query, s).size();
      if (!scope.sequences[s].searched) continue;
      for (const LabelRun& run : label_runs(truth, query, s, scope.sequences[s].frames))
        add(std::array<uint64_t, 5>{query, place_among_searched[s], run.first, run.last,
                                    static_cast<uint64_t>(run.label)});
    }
  }
  return sum.text();
}

}  // namespace vpr
