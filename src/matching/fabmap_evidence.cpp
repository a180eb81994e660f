#include "matching/fabmap_evidence.h"

#include <algorithm>

namespace vpr {

std::vector<WordEvidence> word_evidence(const FabmapModel& model, std::span<const uint32_t> frame,
                                        std::span<const uint32_t> view) {
  const std::vector<uint8_t> seen = word_flags(frame, model.words());
  const std::vector<uint8_t> shown = word_flags(view, model.words());
  std::vector<WordEvidence> evidence;
  for (uint32_t q = 0; q < model.words(); ++q) {
    const size_t row = 2 * size_t{seen[q]} + size_t{seen[model.parent[q]]};
    evidence.push_back({q, seen[q] != 0, shown[q] != 0,
                        model.log_p[q][2 * row + shown[q]] - model.log_p_new[q][row]});
  }
  std::stable_sort(
      evidence.begin(), evidence.end(),
      [](const WordEvidence& a, const WordEvidence& b) { return a.log_odds > b.log_odds; });
  return evidence;
}

}  // namespace vpr
