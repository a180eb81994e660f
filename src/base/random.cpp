#include "base/random.h"

#include <cassert>

namespace vpr {

uint64_t uniform_below(RandomEngine& engine, uint64_t bound) {
  assert(bound > 0);
  const uint64_t reject_below = (0 - bound) % bound;  // 2^64 mod bound: the rest is a multiple
  for (;;) {
    const uint64_t value = engine();
    if (value >= reject_below) return value % bound;
  }
}

double uniform_unit(RandomEngine& engine) { return static_cast<double>(engine() >> 11) * 0x1p-53; }

}  // namespace vpr
