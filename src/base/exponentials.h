// Logarithms to probabilities, many at once and alike on every SIMD target.
#pragma once

#include <span>

namespace vpr {

/// Replaces each value by exp(value - the largest value), within 4 units in the last place; 0 where
/// that is below 1e-300. Returns the sum of the new values: eight partial sums over every eighth
/// value, added in order. No value may be NaN or +infinity; `values` must not be empty.
double exponentiate(std::span<double> values);

}  // namespace vpr
