// Exponentials of many values, and logarithms, with the same bytes on every machine.
#pragma once

#include <span>

namespace vpr {

/// Replaces each value x by exp(x - max), within 4 units in the last place; results below 1e-300
/// become 0. Returns the sum of the new values: eight partial sums, each over every eighth value,
/// added in order. No value may be NaN or +infinity; `values` must not be empty.
double exponentiate(std::span<double> values);

/// ln(x) of a finite x > 0, within 4 units in the last place.
double natural_logarithm(double x);

}  // namespace vpr
