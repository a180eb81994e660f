#include "matching/fabmap_model.h"

#include <cmath>

#include <fmt/format.h>

#include "base/error.h"

namespace vpr {
namespace {

/// One word's probabilities, by the names of the paper.
struct Word {
  double p = 0;            // P(z)
  double p_given = 0;      // P(z | z_parent)
  double p_given_not = 0;  // P(z | not z_parent)
  DetectorModel detector;

  double marginal(bool z) const { return z ? p : 1 - p; }
  double conditional(bool z, bool parent) const {
    const double given = parent ? p_given : p_given_not;
    return z ? given : 1 - given;
  }
  double seen(bool z, bool e) const {
    const double p_seen = e ? detector.p_seen_if_there : detector.p_seen_if_not;
    return z ? p_seen : 1 - p_seen;
  }
  // P(e = 1 | L) of a view that observed L itself.
  double there(bool observed) const {
    const double a = seen(observed, true) * marginal(true);
    const double b = seen(observed, false) * marginal(false);
    return a / (a + b);
  }
  // P(z | e, z_parent) as FAB-MAP approximates it from P(z | e) and P(z | z_parent).
  double observed(bool z, bool e, bool parent) const {
    const double a = marginal(z) * seen(!z, e) * conditional(!z, parent);
    const double b = marginal(!z) * seen(z, e) * conditional(z, parent);
    return b / (a + b);
  }
};

// Sum over e of P(e) P(z | e [, z_parent]).
double expectation(const Word& word, WordModel model, bool z, bool parent, double p_there) {
  const auto p_of = [&](bool e) {
    return model == WordModel::tree ? word.observed(z, e, parent) : word.seen(z, e);
  };
  return p_of(false) * (1 - p_there) + p_of(true) * p_there;
}

void check_detector(const DetectorModel& detector) {
  const double hit = detector.p_seen_if_there;
  const double miss = detector.p_seen_if_not;
  if (hit > 0 && hit < 1 && miss >= 0 && miss < hit) return;
  throw Error(
      ErrorKind::usage,
      fmt::format("the detector needs 0 <= P(z|not e) < P(z|e) < 1, found {} and {}", miss, hit));
}

}  // namespace

FabmapModel make_fabmap_model(const ChowLiuTree& tree, const DetectorModel& detector,
                              WordModel words) {
  check_detector(detector);
  FabmapModel model;
  const size_t count = tree.words();
  const bool naive = words == WordModel::naive_bayes;
  model.children.resize(count);
  for (size_t q = 0; q < count; ++q) {
    const Word word{tree.p[q], naive ? tree.p[q] : tree.p_given[q],
                    naive ? tree.p[q] : tree.p_given_not[q], detector};
    auto& log_p = model.log_p.emplace_back();
    auto& log_p_new = model.log_p_new.emplace_back();
    for (const bool z : {false, true}) {
      for (const bool parent : {false, true}) {
        const size_t row = 2 * size_t{z} + size_t{parent};
        for (const bool own : {false, true})
          log_p[2 * row + size_t{own}] =
              std::log(expectation(word, words, z, parent, word.there(own)));
        log_p_new[row] = std::log(expectation(word, words, z, parent, word.p));
      }
    }
    const uint32_t parent = naive ? static_cast<uint32_t>(q) : tree.parent[q];
    model.parent.push_back(parent);
    if (parent != q) model.children[parent].push_back(static_cast<uint32_t>(q));
    model.p.push_back(word.p);
    model.p_given.push_back(word.p_given);
    model.p_given_not.push_back(word.p_given_not);
  }
  return model;
}

std::vector<uint8_t> word_flags(std::span<const uint32_t> words, size_t count) {
  std::vector<uint8_t> flags(count, 0);
  for (const uint32_t word : words) flags[word] = 1;
  return flags;
}

}  // namespace vpr
