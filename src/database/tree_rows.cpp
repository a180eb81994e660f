#include "database/tree_rows.h"

#include <cassert>
#include <cmath>

#include <fmt/format.h>

#include "base/error.h"

namespace vpr {
namespace {

constexpr double kLeastProbability = 1e-300;

// Whether every word reaches a root: there are no cycles. Parents are words.
bool reach_roots(std::span<const uint32_t> parent) {
  std::vector<uint8_t> state(parent.size(), 0);  // 1: on the way, 2: reaches a root
  for (uint32_t start = 0; start < parent.size(); ++start) {
    std::vector<uint32_t> way;
    uint32_t q = start;
    while (state[q] == 0 && parent[q] != q) {
      state[q] = 1;
      way.push_back(q);
      q = parent[q];
    }
    if (state[q] == 1) return false;
    state[q] = 2;
    for (const uint32_t passed : way) state[passed] = 2;
  }
  return true;
}

}  // namespace

std::vector<double> tree_rows(const ChowLiuTree& tree) {
  std::vector<double> rows(tree.parent.begin(), tree.parent.end());
  for (const auto* row : {&tree.p, &tree.p_given, &tree.p_given_not})
    rows.insert(rows.end(), row->begin(), row->end());
  return rows;
}

ChowLiuTree tree_of_rows(std::span<const double> rows, const std::string& name) {
  assert(rows.size() % 4 == 0);
  const size_t words = rows.size() / 4;
  const auto fail = [&](const std::string& what) {
    throw Error(ErrorKind::data, fmt::format("{}: {}", name, what));
  };
  ChowLiuTree tree;
  for (size_t q = 0; q < words; ++q) {
    if (!(rows[q] >= 0 && rows[q] < static_cast<double>(words)) || rows[q] != std::floor(rows[q]))
      fail(fmt::format("the parent of word {} is no word", q));
    tree.parent.push_back(static_cast<uint32_t>(rows[q]));
    for (size_t row = 1; row < 4; ++row) {
      const double p = rows[row * words + q];
      if (!(p > kLeastProbability && p < 1))
        fail(fmt::format("a probability of word {} is not between {} and 1, but {}", q,
                         kLeastProbability, p));
    }
    tree.p.push_back(rows[words + q]);
    tree.p_given.push_back(rows[2 * words + q]);
    tree.p_given_not.push_back(rows[3 * words + q]);
  }
  if (!reach_roots(tree.parent)) fail("its words form a cycle, not a tree");
  return tree;
}

}  // namespace vpr
