// A Chow-Liu tree as files hold it: 4 x words numbers, row by row: parent, P(z), P(z|parent),
// P(z|not parent).
#pragma once

#include <span>
#include <string>
#include <vector>

#include "database/chow_liu.h"

namespace vpr {

/// A tree as such rows: 4 x words numbers.
std::vector<double> tree_rows(const ChowLiuTree& tree);

/// The tree of such rows, none of which is trusted: parents are words and lead to a root (a word
/// that is its own parent), and probabilities lie strictly between 1e-300 and 1, so that logarithms
/// of their products are finite. `rows` holds a multiple of 4 numbers. Throws Error(data) that
/// starts with `name`.
ChowLiuTree tree_of_rows(std::span<const double> rows, const std::string& name);

}  // namespace vpr
