// Converts many logarithms to probabilities, with the same bytes on every SIMD target.
#pragma once

#include <span>

namespace vpr {

/// Replaces each value x by exp(x - max), within 4 units in the last place; results below 1e-300
/// become 0. Returns the sum of the new values: eight partial sums, each over every eighth value,
/// added in order. No value may be NaN or +infinity; `values` must not be empty.
double exponentiate(std::span<double> values);

}  // namespace vpr
