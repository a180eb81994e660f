// FAB-MAP: the word model, the variants that compute the log-likelihoods of all views for one
// observation, and the posterior over views and the new place.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "fabmap/chow_liu.h"
#include "fabmap/vocabulary.h"
#include "query/fabmap_settings.h"

namespace vpr {

/// FAB-MAP's detector: how reliably a word is seen (z) if its cause exists (e).
struct DetectorModel {
  double p_seen_if_there = 0.39;  ///< P(z = 1 | e = 1)
  double p_seen_if_not = 0;       ///< P(z = 1 | e = 0)
};

/// Logarithms of P(z_q | z_parent, L) for both values of the observation, of the parent's
/// observation and of the view's own observation: a view's log-likelihood is the sum of one entry
/// per word. With naive Bayes the parent has no effect.
struct FabmapModel {
  /// log_p[q][4 z_q + 2 z_parent + L_q]
  std::vector<std::array<double, 8>> log_p;
  /// New place by mean field: log of the sum over e of P(z_q = e) P(z_q | e, z_parent); [q][2 z_q +
  /// z_parent].
  std::vector<std::array<double, 4>> log_p_new;
  std::vector<uint32_t> parent;                 ///< in the tree; the word itself with naive Bayes
  std::vector<std::vector<uint32_t>> children;  ///< words with this parent, except the word itself
  std::vector<double> p;                        ///< P(z_q)
  std::vector<double> p_given;                  ///< P(z_q | z_parent); p with naive Bayes
  std::vector<double> p_given_not;

  size_t words() const { return log_p.size(); }
};

/// The model of a tree and a detector. Throws Error(usage) unless the detector's probabilities are
/// in [0, 1) and P(z = 1 | e = 1) is above P(z = 1 | e = 0).
FabmapModel make_fabmap_model(const ChowLiuTree& tree, const DetectorModel& detector,
                              WordModel words);

/// One flag per word: whether a frame shows it.
std::vector<uint8_t> word_flags(std::span<const uint32_t> words, size_t count);

/// The gap of a view to the best view beyond which, by Bennett's inequality, the remaining terms
/// close the gap with a probability of at most 1e-6. `variance`: of the sum of the remaining
/// log-likelihood ratios; `largest`: their largest step. At least -ln 1e-6.
double bail_out_gap(double variance, double largest);

/// The data that a query uses in addition to the inverted index of the views.
struct FabmapIndex {
  const WordIndex& lists;
  /// Per view: sum over its words of log P(0 | 0, L = 1) - log P(0 | 0, L = 0).
  std::vector<double> defaults;
  /// Sum over all words of log P(0 | 0, L = 0).
  double constant = 0;
};

/// `lists` are those of `views`, and must outlive the result.
FabmapIndex make_fabmap_index(const FabmapModel& model, const ViewWords& views,
                              const WordIndex& lists);

/// The input of a variant.
struct FabmapQuery {
  const FabmapModel& model;
  const ViewWords& views;
  const FabmapIndex& index;
  std::span<const uint32_t> words;  ///< the observation: word ids, increasing, without duplicates
  size_t known_views;               ///< only views below this index are scored
  int lut_digits = 6;               ///< decimal digits of the `lut` variant
  /// Views to ignore because their frames could not be decoded: they do not affect other views, and
  /// their own results are unspecified. Increasing.
  std::span<const size_t> unreadable = {};
};

/// An entry of the table of variants: one way to compute the log-likelihoods of views.
struct FabmapVariant {
  std::string_view name;
  std::string_view summary;
  /// One log-likelihood per known view. The same for any number of threads and any SIMD target.
  std::vector<double> (*log_likelihoods)(const FabmapQuery&);
};

/// All variants, in the order of the help text.
std::span<const FabmapVariant> fabmap_variants();
/// The variant with this name. Throws Error(usage), which lists the names, for an unknown name.
const FabmapVariant& find_fabmap_variant(std::string_view name);

/// The definition: every word of every view. The reference implementation; sums run in the order of
/// words.
std::vector<double> fabmap1_log_likelihoods(const FabmapQuery& query);

/// As fabmap1, from a table of integers in units of 10^-digits: the error is at most words / 2
/// units.
std::vector<double> lut_log_likelihoods(const FabmapQuery& query);

/// Uses the inverted index; equals fabmap1 within rounding (1e-9).
std::vector<double> fabmap2_log_likelihoods(const FabmapQuery& query);

/// Fast bail-out: evaluates words by increasing P(z_q | z_parent). A view whose gap to the best is
/// too large for the remaining words to close (Bennett's bound, probability 1e-6) is dropped and
/// gets best + ln 1e-6.
std::vector<double> fbo_log_likelihoods(const FabmapQuery& query);

/// The log-likelihood of the new place by mean field.
double new_place_mean_field(const FabmapModel& model, std::span<const uint32_t> words);

/// The log-likelihood of the new place: the logarithm of the mean likelihood over views.
double log_mean_exp(std::span<const double> log_values);

/// Posterior of the new place (first) and of each view, from log-likelihoods, normalized by
/// log-sum-exp. `previous`: the posterior of the previous frame, for the motion model; empty for
/// the first frame. The prior of view i, for at least two views, is (2 (1 - b) p[i-1] + p[i] + 2 b
/// p[i+1]) / 3, where the first and last view replace their missing neighbor.
std::vector<double> fabmap_posterior(std::span<const double> log_likelihoods, double new_place,
                                     std::span<const double> previous,
                                     const PosteriorSettings& settings);

/// For each view, counts the consecutive frames up to the current one with a posterior above t_p.
struct ViewWindow {
  std::vector<uint32_t> run;

  /// Adds the posterior of a frame (new place first). An empty posterior (an unreadable frame, or a
  /// frame without words) ends every run.
  void add(std::span<const double> posterior, double t_p, size_t views);
};

}  // namespace vpr
