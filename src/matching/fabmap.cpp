#include "matching/fabmap.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <hwy/cache_control.h>

#include "base/error.h"
#include "base/named_table.h"
#include "matching/fabmap_fbo.h"

namespace vpr {
namespace {

constexpr double kFixedScale = 1 << 20;
constexpr size_t kListsAhead = 4;
constexpr double kMostFixed = 2000;  // of a term: 2^31 / 2^20 with room to spare

constexpr std::array<FabmapVariant, 5> kVariants = {{
    {"fabmap2", "inverted index: only words of the query and their children",
     fabmap2_log_likelihoods},
    {"fabmap2-fixed", "the same in fixed point, faster", fabmap2_fixed_log_likelihoods},
    {"fabmap1", "the definition: every word of every view", fabmap1_log_likelihoods},
    {"lut", "the definition from a table of rounded logarithms", lut_log_likelihoods},
    {"fbo", "fast bail-out: drops views that can't win any more", fbo_log_likelihoods, false},
}};

int32_t as_fixed(double value) {
  return static_cast<int32_t>(
      std::lround(std::clamp(value, -kMostFixed, kMostFixed) * kFixedScale));
}

size_t entry(bool z, bool parent, bool own) {
  return 4 * size_t{z} + 2 * size_t{parent} + size_t{own};
}

// Words whose entry differs from the one of an empty frame: those of the query, and children of
// these. Each once.
std::vector<uint32_t> touched_words(const FabmapModel& model, std::span<const uint32_t> words,
                                    const std::vector<uint8_t>& seen) {
  std::vector<uint32_t> touched(words.begin(), words.end());
  for (const uint32_t word : words)
    for (const uint32_t child : model.children[word])
      if (seen[child] == 0) touched.push_back(child);
  return touched;
}

struct WordTerm {
  uint32_t word = 0;
  double to_its_views = 0;
};

struct QueryTerms {
  std::vector<WordTerm> words;  ///< touched, each once
  double to_all = 0;            ///< what every view gets, beside the index's constant
};

QueryTerms query_terms(const FabmapQuery& query) {
  const FabmapModel& model = query.model;
  const std::vector<uint8_t> seen = word_flags(query.words, model.words());
  QueryTerms terms;
  for (const uint32_t word : touched_words(model, query.words, seen)) {
    const bool z = seen[word] != 0;
    const bool parent = seen[model.parent[word]] != 0;
    const auto& log_p = model.log_p[word];
    const double all = log_p[entry(z, parent, false)];
    const double all_empty = log_p[entry(false, false, false)];
    terms.words.push_back({word, (log_p[entry(z, parent, true)] - all) -
                                     (log_p[entry(false, false, true)] - all_empty)});
    terms.to_all += all - all_empty;
  }
  return terms;
}

// The start of a list; the processor finds the rest by itself.
void prefetch(std::span<const uint16_t> list) {
  hwy::Prefetch(list.data());
  hwy::Prefetch(list.data() + 32);
}

// Adds each word's term to the sums of the views that show it, block by block, so that sums stay in
// a cache. Four at a time: the views of a list differ, so that none waits for another.
template <class T, class Convert>
void add_terms(const WordIndex& index, std::span<const WordTerm> terms, T* sums,
               Convert&& convert) {
  for (size_t block = 0; block < index.blocks(); ++block, sums += kIndexBlock) {
    for (size_t t = 0; t < terms.size(); ++t) {
      if (t + kListsAhead < terms.size()) prefetch(index.list(block, terms[t + kListsAhead].word));
      const std::span<const uint16_t> views = index.list(block, terms[t].word);
      const T step = convert(terms[t].to_its_views);
      size_t i = 0;
      for (; i + 4 <= views.size(); i += 4) {
        const T a = sums[views[i]] + step;
        const T b = sums[views[i + 1]] + step;
        const T c = sums[views[i + 2]] + step;
        const T d = sums[views[i + 3]] + step;
        sums[views[i]] = a;
        sums[views[i + 1]] = b;
        sums[views[i + 2]] = c;
        sums[views[i + 3]] = d;
      }
      for (; i < views.size(); ++i) sums[views[i]] += step;
    }
  }
}

}  // namespace

FabmapIndex make_fabmap_index(const FabmapModel& model, const ViewWords& views,
                              const WordIndex& lists) {
  FabmapIndex index{lists, {}, {}, true, 0};
  std::vector<double> step;  // of a word that a view shows and the query does not
  for (const auto& log_p : model.log_p) {
    const double all = log_p[entry(false, false, false)];
    step.push_back(log_p[entry(false, false, true)] - all);
    index.constant += all;
  }
  index.defaults.resize(views.views());
  index.fixed_defaults.resize(views.views());
  for (size_t v = 0; v < views.views(); ++v) {
    double sum = 0;
    for (const uint32_t word : views.view(v)) sum += step[word];
    index.defaults[v] = sum;
    index.fixed_defaults[v] = as_fixed(sum);
    index.fits_fixed = index.fits_fixed && std::abs(sum) < kMostFixed / 2;
  }
  return index;
}

std::span<const FabmapVariant> fabmap_variants() { return kVariants; }

const FabmapVariant& find_fabmap_variant(std::string_view name) {
  return find_named(kVariants, "variant", name);
}

std::vector<double> fabmap1_log_likelihoods(const FabmapQuery& query) {
  const FabmapModel& model = query.model;
  const std::vector<uint8_t> seen = word_flags(query.words, model.words());
  std::vector<double> sums(query.known_views, 0);
  for (size_t v = 0; v < sums.size(); ++v) {
    const std::vector<uint8_t> own = word_flags(query.views.view(v), model.words());
    for (size_t q = 0; q < model.words(); ++q)
      sums[v] += model.log_p[q][entry(seen[q] != 0, seen[model.parent[q]] != 0, own[q] != 0)];
  }
  return sums;
}

std::vector<double> lut_log_likelihoods(const FabmapQuery& query) {
  const FabmapModel& model = query.model;
  const double scale = std::pow(10.0, query.lut_digits);
  std::vector<std::array<int64_t, 8>> table(model.words());
  for (size_t q = 0; q < model.words(); ++q)
    for (size_t e = 0; e < 8; ++e) table[q][e] = std::llround(model.log_p[q][e] * scale);
  const std::vector<uint8_t> seen = word_flags(query.words, model.words());
  std::vector<double> sums(query.known_views);
  for (size_t v = 0; v < sums.size(); ++v) {
    const std::vector<uint8_t> own = word_flags(query.views.view(v), model.words());
    int64_t sum = 0;
    for (size_t q = 0; q < model.words(); ++q)
      sum += table[q][entry(seen[q] != 0, seen[model.parent[q]] != 0, own[q] != 0)];
    sums[v] = static_cast<double>(sum) / scale;
  }
  return sums;
}

std::vector<double> fabmap2_log_likelihoods(const FabmapQuery& query) {
  const QueryTerms terms = query_terms(query);
  const double to_all = query.index.constant + terms.to_all;
  std::vector<double> sums = query.index.defaults;
  add_terms(query.index.lists, terms.words, sums.data(), [](double step) { return step; });
  sums.resize(query.known_views);
  for (double& sum : sums) sum += to_all;
  return sums;
}

std::vector<double> fabmap2_fixed_log_likelihoods(const FabmapQuery& query) {
  const QueryTerms terms = query_terms(query);
  double largest = 0;  // that a query may add to a view
  for (const WordTerm& term : terms.words) largest += std::abs(term.to_its_views);
  if (!query.index.fits_fixed || largest > kMostFixed / 2) return fabmap2_log_likelihoods(query);
  const double to_all = query.index.constant + terms.to_all;
  // Unsigned: sums may leave the range on the way, as long as they end in it.
  std::vector<uint32_t> sums(query.index.fixed_defaults.begin(), query.index.fixed_defaults.end());
  add_terms(query.index.lists, terms.words, sums.data(),
            [](double step) { return static_cast<uint32_t>(as_fixed(step)); });
  std::vector<double> result(query.known_views);
  for (size_t v = 0; v < result.size(); ++v)
    result[v] = static_cast<int32_t>(sums[v]) * (1 / kFixedScale) + to_all;
  return result;
}

double new_place_mean_field(const FabmapModel& model, std::span<const uint32_t> words) {
  const std::vector<uint8_t> seen = word_flags(words, model.words());
  double sum = 0;
  for (size_t q = 0; q < model.words(); ++q)
    sum += model.log_p_new[q][2 * size_t{seen[q]} + size_t{seen[model.parent[q]]}];
  return sum;
}

double log_mean_exp(std::span<const double> log_values) {
  const double most = *std::max_element(log_values.begin(), log_values.end());
  double sum = 0;
  for (const double value : log_values) sum += std::exp(value - most);
  return most + std::log(sum / static_cast<double>(log_values.size()));
}

}  // namespace vpr
