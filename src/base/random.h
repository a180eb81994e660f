// Seeded random numbers, the same with every standard library (std::*_distribution is not). Draw
// one number per statement or in braces: the compiler chooses the order in which function arguments
// are evaluated.
#pragma once

#include <cstdint>
#include <random>
#include <string_view>

namespace vpr {

/// The only random engine: the standard fixes its output for every seed.
using RandomEngine = std::mt19937_64;

/// A separate engine for each purpose, seeded by std::seed_seq from seed and name.
RandomEngine named_engine(uint64_t seed, std::string_view name);

/// Uniform in [0, bound), without bias. bound > 0.
uint64_t uniform_below(RandomEngine& engine, uint64_t bound);

/// Uniform in [0, 1), 53 bits.
double uniform_unit(RandomEngine& engine);

}  // namespace vpr
