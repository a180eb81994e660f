// The variants of FAB-MAP: log-likelihoods of all views for one observation.
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "database/word_index.h"
#include "matching/fabmap_model.h"

namespace vpr {

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

}  // namespace vpr
