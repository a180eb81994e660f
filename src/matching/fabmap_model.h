// FAB-MAP's probabilities: how likely is an observation at a place? (Cummins & Newman, IJRR 2008)
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "database/chow_liu.h"
#include "database/view_words.h"
#include "matching/word_model.h"

namespace vpr {

/// How reliably a word is seen (z) where its cause is there (e): FAB-MAP's detector.
struct DetectorModel {
  double p_seen_if_there = 0.39;  ///< P(z = 1 | e = 1)
  double p_seen_if_not = 0;       ///< P(z = 1 | e = 0)
};

/// Logarithms of P(z_q | z_parent, L) for both observations, both of the parent's and both of the
/// view's own: a view's log-likelihood is the sum of one entry per word. With naive Bayes the
/// parent does not matter.
struct FabmapModel {
  /// log_p[q][4 z_q + 2 z_parent + L_q]
  std::vector<std::array<double, 8>> log_p;
  /// New place by mean field: log of sum over e of P(z_q = e) P(z_q | e, z_parent);
  /// [q][2 z_q + z_parent].
  std::vector<std::array<double, 4>> log_p_new;
  std::vector<uint32_t> parent;                 ///< of the tree; of itself with naive Bayes
  std::vector<std::vector<uint32_t>> children;  ///< words whose parent this is, itself left out
  std::vector<double> p;                        ///< P(z_q)
  std::vector<double> p_given;                  ///< P(z_q | z_parent); p with naive Bayes
  std::vector<double> p_given_not;

  size_t words() const { return log_p.size(); }
};

/// The model of a tree and a detector. Throws Error(usage) unless the detector's probabilities are
/// in [0, 1), and seeing what is there is possible and more likely than what is not.
FabmapModel make_fabmap_model(const ChowLiuTree& tree, const DetectorModel& detector,
                              WordModel words);

/// Which words a frame shows, for look-up by word.
std::vector<uint8_t> word_flags(std::span<const uint32_t> words, size_t count);

}  // namespace vpr
