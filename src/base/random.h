// Seeded random numbers, the same with every standard library (std::*_distribution is not). Draw
// one a statement or in braces: in which order a call's arguments are drawn is the compiler's.
#pragma once

#include <cstdint>
#include <random>
#include <string_view>

namespace vpr {

/// The only source of chance: the standard fixes its numbers for every seed.
using RandomEngine = std::mt19937_64;

/// An engine of its own for every purpose: (seed, name) starts it, by the standard's seed_seq.
RandomEngine named_engine(uint64_t seed, std::string_view name);

/// Uniform in [0, bound), without bias. bound > 0.
uint64_t uniform_below(RandomEngine& engine, uint64_t bound);

/// Uniform in [0, 1), 53 bits.
double uniform_unit(RandomEngine& engine);

}  // namespace vpr
