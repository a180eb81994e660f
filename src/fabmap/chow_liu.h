// The Chow-Liu tree of word occurrences (Chow & Liu 1968; Cummins & Newman, FAB-MAP).
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "base/monitor.h"
#include "fabmap/vocabulary.h"

namespace vpr {

/// Per word q. The root is its own parent, and both conditionals are its marginal.
struct ChowLiuTree {
  std::vector<uint32_t> parent;
  std::vector<double> p;            ///< P(z_q)
  std::vector<double> p_given;      ///< P(z_q | z_parent)
  std::vector<double> p_given_not;  ///< P(z_q | not z_parent)

  size_t words() const { return parent.size(); }
};

/// Mutual information of two words in natural units from counts: of `frames` frames, n_a show a,
/// n_b show b, n_ab both; the same if a and b change places. Joint probabilities unsmoothed,
/// marginals smoothed as 0.98 f + 0.01. The one function by which trees are built, so that the
/// oracle's ties are the fast path's.
class MutualInformation {
 public:
  explicit MutualInformation(size_t frames);
  double operator()(size_t n_a, size_t n_b, size_t n_ab) const;

 private:
  size_t frames_;
  std::vector<double> x_log_x_;  // n/N ln(n/N)
  std::vector<double>
      marginal_;  // sum over z of the frequency of z times ln(0.98 frequency + 0.01)
};

/// The maximum spanning tree over mutual information. `frames`: the word set of each pretraining
/// frame (empty ones count too). Edges are ordered by (information descending, smaller word, larger
/// word); the root is the smaller word of the best edge. Time O(words^2 frames / 64), memory
/// O(words + words frames / 8). At least one word and one frame.
ChowLiuTree train_chow_liu(std::span<const WordSet> frames, size_t words, const Monitor& monitor);

/// A tree as files hold it: 4 x words numbers, row by row: parent, P(z), P(z|parent),
/// P(z|not parent).
std::vector<double> tree_rows(const ChowLiuTree& tree);

/// The tree of such rows, none of which is trusted: parents are words and lead to a root (a word
/// that is its own parent), and probabilities lie strictly between 1e-300 and 1, so that logarithms
/// of their products are finite. `rows` holds a multiple of 4 numbers. Throws Error(data) that
/// starts with `name`.
ChowLiuTree tree_of_rows(std::span<const double> rows, const std::string& name);

}  // namespace vpr
