// FAB-MAP: the word model, and the variants that compute log-likelihoods of all views for one
// observation.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "base/enum_names.h"
#include "fabmap/chow_liu.h"
#include "fabmap/word_index.h"

namespace vpr {

/// Whether a word depends on its parent in the Chow-Liu tree, or on no other one.
enum class WordModel { tree, naive_bayes };
template <>
inline constexpr std::array<std::string_view, 2> kEnumNames<WordModel> = {"tree", "naive-bayes"};

/// How likely an unknown place is: by the probabilities of its words, or on average over
/// pretraining frames.
enum class NewPlaceModel { mean_field, pretrain };
template <>
inline constexpr std::array<std::string_view, 2> kEnumNames<NewPlaceModel> = {"mean-field",
                                                                              "pretrain"};

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

/// How far a view must be behind the best so that, by Bennett's inequality, sums of the remaining
/// terms make it good with probability 1e-6 at most. `variance`: of the sum of the remaining
/// log-likelihood ratios; `largest`: their largest step. At least -ln 1e-6.
double bail_out_gap(double variance, double largest);

/// What a query needs beside the inverted index of the views.
struct FabmapIndex {
  const WordIndex& lists;
  /// Per view: sum over its words of log P(0 | 0, L = 1) - log P(0 | 0, L = 0).
  std::vector<double> defaults;
  std::vector<int32_t> fixed_defaults;  ///< the same in units of 2^-20
  bool fits_fixed = true;               ///< whether all of them do, with room for a query
  /// Sum over all words of log P(0 | 0, L = 0).
  double constant = 0;
};

/// `lists` are those of `views`, and must outlive the result.
FabmapIndex make_fabmap_index(const FabmapModel& model, const ViewWords& views,
                              const WordIndex& lists);

/// What a variant may use.
struct FabmapQuery {
  const FabmapModel& model;
  const ViewWords& views;
  const FabmapIndex& index;
  std::span<const uint32_t> words;  ///< the observation: word ids, rising, each once
  size_t known_views;               ///< only views below are asked about
  int lut_digits = 6;               ///< decimal digits of the `lut` variant
  /// Views that take no part, for their frames could not be decoded: no other view's likelihood
  /// depends on them, and what is given for them means nothing. Rising.
  std::span<const size_t> unreadable = {};
};

/// A row of the table of variants: a way to compute the log-likelihoods of views.
struct FabmapVariant {
  std::string_view name;
  std::string_view summary;
  /// One log-likelihood for each known view. Same for any number of threads and any SIMD target.
  std::vector<double> (*log_likelihoods)(const FabmapQuery&);
  bool is_by_view = true;  ///< a view's does not depend on the others
};

/// All variants, in the order in which help lists them.
std::span<const FabmapVariant> fabmap_variants();
/// The variant of a name. Throws Error(usage), listing the names, for an unknown one.
const FabmapVariant& find_fabmap_variant(std::string_view name);

/// The definition: every word of every view. The oracle. Sums run in the order of words.
std::vector<double> fabmap1_log_likelihoods(const FabmapQuery& query);

/// The same from a table of integers in units of 10^-digits: off by at most words / 2 units.
std::vector<double> lut_log_likelihoods(const FabmapQuery& query);

/// The inverted index; the same as fabmap1 within rounding (1e-9).
std::vector<double> fabmap2_log_likelihoods(const FabmapQuery& query);

/// The inverted index with sums in units of 2^-20, whose order does not matter: off by at most
/// (words the view shows + 1) / 2 units, under 1e-4 for a view of 200 words. Where
/// a view's sum could leave +-2000, the sums of fabmap2 are given instead.
std::vector<double> fabmap2_fixed_log_likelihoods(const FabmapQuery& query);

/// Fast bail-out: words by rising P(z_q | z_parent); a view that has fallen behind the best by more
/// than the rest can make good (Bennett's bound, probability 1e-6) is dropped and gets
/// best + ln 1e-6.
std::vector<double> fbo_log_likelihoods(const FabmapQuery& query);

/// The new place by mean field.
double new_place_mean_field(const FabmapModel& model, std::span<const uint32_t> words);

/// The new place as the average likelihood over given views (logarithm).
double log_mean_exp(std::span<const double> log_values);

/// What one word says for or against a view.
struct WordEvidence {
  uint32_t word = 0;
  bool in_frame = false;
  bool in_view = false;
  /// log P(z_q | z_parent, view) - log P(z_q | z_parent, new place by mean field): above 0 speaks
  /// for the view. Over all words they add up to the log-odds of the view against that new place.
  double log_odds = 0;
};

/// Every word of the model, those that speak for the view first; ties to the lower word. `frame`
/// and `view`: word ids, rising, each once.
std::vector<WordEvidence> word_evidence(const FabmapModel& model, std::span<const uint32_t> frame,
                                        std::span<const uint32_t> view);

}  // namespace vpr
