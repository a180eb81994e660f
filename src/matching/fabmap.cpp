#include "matching/fabmap.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "matching/fabmap_fbo.h"

namespace vpr {
namespace {

constexpr double kFixedScale = 1 << 20;
constexpr double kMostFixed = 2000;  // of a term: 2^31 / 2^20 with room to spare

constexpr std::array<FabmapVariant, 5> kVariants = {{
    {"fabmap2", "inverted index: only words of the query and their children",
     fabmap2_log_likelihoods},
    {"fabmap2-fixed", "the same in fixed point, faster", fabmap2_fixed_log_likelihoods},
    {"fabmap1", "the definition: every word of every view", fabmap1_log_likelihoods},
    {"lut", "the definition from a table of rounded logarithms", lut_log_likelihoods},
    {"fbo", "fast bail-out: drops views that can't win any more", fbo_log_likelihoods},
}};

int32_t as_fixed(double value) {
  return static_cast<int32_t>(
      std::lround(std::clamp(value, -kMostFixed, kMostFixed) * kFixedScale));
}

// Sums may leave the range on the way; what counts is that they end in it.
int32_t add_wrapping(int32_t a, int32_t b) {
  return static_cast<int32_t>(static_cast<uint32_t>(a) + static_cast<uint32_t>(b));
}

size_t entry(bool z, bool parent, bool own) {
  return 4 * size_t{z} + 2 * size_t{parent} + size_t{own};
}

// Words whose entry differs from the one of an empty frame: those of the query, and children of
// these. Each once.
std::vector<uint32_t> touched_words(const FabmapModel& model, std::span<const uint32_t> words) {
  std::vector<uint32_t> touched(words.begin(), words.end());
  for (const uint32_t word : words)
    touched.insert(touched.end(), model.children[word].begin(), model.children[word].end());
  std::sort(touched.begin(), touched.end());
  touched.erase(std::unique(touched.begin(), touched.end()), touched.end());
  return touched;
}

/// What one touched word adds to views that show it, and to all.
struct WordTerm {
  uint32_t word = 0;
  double to_its_views = 0;
  double to_all = 0;
};

std::vector<WordTerm> query_terms(const FabmapQuery& query) {
  const FabmapModel& model = query.model;
  const std::vector<uint8_t> seen = word_flags(query.words, model.words());
  std::vector<WordTerm> terms;
  for (const uint32_t word : touched_words(model, query.words)) {
    const bool z = seen[word] != 0;
    const bool parent = seen[model.parent[word]] != 0;
    const auto& log_p = model.log_p[word];
    const double all = log_p[entry(z, parent, false)];
    const double all_empty = log_p[entry(false, false, false)];
    terms.push_back(
        {word,
         (log_p[entry(z, parent, true)] - all) - (log_p[entry(false, false, true)] - all_empty),
         all - all_empty});
  }
  return terms;
}

}  // namespace

FabmapIndex make_fabmap_index(const FabmapModel& model, const ViewWords& views) {
  FabmapIndex index;
  index.views = views.views();
  index.offsets.assign(model.words() + 1, 0);
  for (const uint32_t word : views.words) ++index.offsets[word + 1];
  std::partial_sum(index.offsets.begin(), index.offsets.end(), index.offsets.begin());
  index.lists.resize(views.words.size());
  index.defaults.assign(index.views, 0);
  std::vector<uint64_t> at(index.offsets.begin(), index.offsets.end() - 1);
  for (size_t v = 0; v < index.views; ++v) {
    for (const uint32_t word : views.view(v)) {
      index.lists[at[word]++] = static_cast<uint32_t>(v);
      index.defaults[v] += model.log_p[word][entry(false, false, true)] -
                           model.log_p[word][entry(false, false, false)];
    }
  }
  for (const double value : index.defaults) index.fixed_defaults.push_back(as_fixed(value));
  for (const auto& log_p : model.log_p) index.constant += log_p[entry(false, false, false)];
  return index;
}

std::span<const FabmapVariant> fabmap_variants() { return kVariants; }

const FabmapVariant& find_fabmap_variant(std::string_view name) {
  std::vector<std::string_view> names;
  for (const FabmapVariant& variant : kVariants) {
    if (variant.name == name) return variant;
    names.push_back(variant.name);
  }
  throw Error(ErrorKind::usage, fmt::format("unknown variant \"{}\"; choose one of {}", name,
                                            fmt::join(names, ", ")));
}

std::vector<double> fabmap1_log_likelihoods(const FabmapQuery& query) {
  const FabmapModel& model = query.model;
  const std::vector<uint8_t> seen = word_flags(query.words, model.words());
  std::vector<double> sums(query.views.views(), 0);
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
  std::vector<double> sums(query.views.views());
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
  const FabmapIndex& index = query.index;
  std::vector<double> sums = index.defaults;
  double to_all = index.constant;
  for (const WordTerm& term : query_terms(query)) {
    to_all += term.to_all;
    for (uint64_t i = index.offsets[term.word]; i < index.offsets[term.word + 1]; ++i)
      sums[index.lists[i]] += term.to_its_views;
  }
  for (double& sum : sums) sum += to_all;
  return sums;
}

std::vector<double> fabmap2_fixed_log_likelihoods(const FabmapQuery& query) {
  const FabmapIndex& index = query.index;
  std::vector<int32_t> sums = index.fixed_defaults;
  double to_all = index.constant;
  for (const WordTerm& term : query_terms(query)) {
    to_all += term.to_all;
    const int32_t step = as_fixed(term.to_its_views);
    for (uint64_t i = index.offsets[term.word]; i < index.offsets[term.word + 1]; ++i)
      sums[index.lists[i]] = add_wrapping(sums[index.lists[i]], step);
  }
  std::vector<double> result(index.views);
  for (size_t v = 0; v < index.views; ++v) result[v] = sums[v] / kFixedScale + to_all;
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
