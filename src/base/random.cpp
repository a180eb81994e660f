#include "base/random.h"

#include <cassert>
#include <vector>

namespace vpr {

RandomEngine named_engine(uint64_t seed, std::string_view name) {
  std::vector<uint32_t> words = {static_cast<uint32_t>(seed), static_cast<uint32_t>(seed >> 32)};
  for (const char c : name) words.push_back(static_cast<uint8_t>(c));
  std::seed_seq sequence(words.begin(), words.end());
  return RandomEngine(sequence);
}

uint64_t uniform_below(RandomEngine& engine, uint64_t bound) {
  assert(bound > 0);
  // 2^64 mod bound: the number of accepted values is a multiple of bound
  const uint64_t reject_below = (0 - bound) % bound;
  for (;;) {
    const uint64_t value = engine();
    if (value >= reject_below) return value % bound;
  }
}

double uniform_unit(RandomEngine& engine) { return static_cast<double>(engine() >> 11) * 0x1p-53; }

}  // namespace vpr
