#include "evaluation/ground_truth/fingerprint.h"

#include <array>
#include <span>

#include "base/checksum.h"
#include "evaluation/ground_truth.h"
#include "evaluation/ground_truth/writing.h"

namespace vpr {

std::string ground_truth_fingerprint(const GroundTruth& truth, const GroundTruthScope& scope) {
  ChecksumStream sum;
  const auto add = [&](const auto& numbers) { sum.add(std::as_bytes(std::span(numbers))); };
  add(std::array<uint64_t, 1>{truth.pairs.size()});
  for (size_t query = 0; query < truth.pairs.size(); ++query) {
    uint64_t searched = 0;
    for (size_t s = 0; s < scope.sequences.size(); ++s) {
      if (!scope.sequences[s].searched) continue;
      for (const LabelRun& run : label_runs(truth, query, s, scope.sequences[s].frames))
        add(std::array<uint64_t, 5>{query, searched, run.first, run.last,
                                    static_cast<uint64_t>(run.label)});
      ++searched;
    }
  }
  return sum.text();
}

}  // namespace vpr
