// The Chow-Liu tree of word occurrences (Chow & Liu 1968; Cummins & Newman, FAB-MAP).
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "base/monitor.h"
#include "fabmap/vocabulary.h"

namespace vpr {

/// One entry per word q. The root is its own parent, and both its conditionals are its marginal.
struct ChowLiuTree {
  std::vector<uint32_t> parent;
  std::vector<double> p;            ///< P(z_q)
  std::vector<double> p_given;      ///< P(z_q | z_parent)
  std::vector<double> p_given_not;  ///< P(z_q | not z_parent)

  size_t words() const { return parent.size(); }
};

/// Mutual information of two words in nats, from counts: of `frames` frames, n_a show a, n_b show
/// b, n_ab both. Symmetric in a and b. Joint probabilities are not smoothed, marginals are smoothed
/// as 0.98 f + 0.01. The fast path and the reference implementation share this function, so that
/// they have the same ties.
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
/// frame; empty ones count as well. Edges are ordered by (information descending, smaller word,
/// larger word); the root is the smaller word of the best edge. Time O(words^2 frames / 64), memory
/// O(words + words frames / 8). Needs at least one word and one frame.
ChowLiuTree train_chow_liu(std::span<const WordSet> frames, size_t words, const Monitor& monitor);

/// A tree as stored in files: 4 x words values, row by row: parent, P(z), P(z|parent), P(z|not
/// parent).
std::vector<double> tree_rows(const ChowLiuTree& tree);

/// The tree with these rows, which are not trusted: every parent must be a word and lead to a root
/// (a word that is its own parent), and probabilities must lie strictly between 1e-300 and 1, so
/// that logarithms of their products are finite. The size of `rows` is a multiple of 4. Throws
/// Error(data) that starts with `name`.
ChowLiuTree tree_of_rows(std::span<const double> rows, const std::string& name);

}  // namespace vpr
