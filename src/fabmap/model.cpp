#include "fabmap/model.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include <hwy/cache_control.h>

#include "base/error.h"
#include "base/exponentials.h"
#include "base/named_table.h"

namespace vpr {

namespace {

constexpr size_t kListsAhead = 4;

constexpr std::array<FabmapVariant, 4> kVariants = {{
    {"fabmap2", "inverted index: only words of the query and their children",
     fabmap2_log_likelihoods},
    {"fabmap1", "the definition: all words of all views", fabmap1_log_likelihoods},
    {"lut", "as fabmap1 with a table of rounded logarithms", lut_log_likelihoods},
    {"fbo", "fast bail-out: drops views that cannot win", fbo_log_likelihoods},
}};

size_t entry(bool z, bool parent, bool own) {
  return 4 * size_t{z} + 2 * size_t{parent} + size_t{own};
}

// For each view, the sum of one entry per word.
template <class T>
std::vector<T> sums_over_words(const FabmapQuery& query,
                               const std::vector<std::array<T, 8>>& table) {
  const FabmapModel& model = query.model;
  const std::vector<uint8_t> seen = word_flags(query.words, model.words());
  std::vector<T> sums(query.known_views, 0);
  for (size_t v = 0; v < sums.size(); ++v) {
    const std::vector<uint8_t> own = word_flags(query.views.view(v), model.words());
    for (size_t q = 0; q < model.words(); ++q)
      sums[v] += table[q][entry(seen[q] != 0, seen[model.parent[q]] != 0, own[q] != 0)];
  }
  return sums;
}

struct WordTerm {
  uint32_t word = 0;
  double to_its_views = 0;
};

struct QueryTerms {
  /// The words whose entry differs from their entry in an empty frame: the words of the query and
  /// their children, without duplicates.
  std::vector<WordTerm> words;
  double to_all = 0;  ///< what every view adds to the index's constant
};

QueryTerms query_terms(const FabmapQuery& query) {
  const FabmapModel& model = query.model;
  const std::vector<uint8_t> seen = word_flags(query.words, model.words());
  QueryTerms terms;
  std::vector<uint32_t> touched(query.words.begin(), query.words.end());
  for (const uint32_t word : query.words)
    for (const uint32_t child : model.children[word])
      if (seen[child] == 0) touched.push_back(child);
  for (const uint32_t word : touched) {
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

// Adds the term of each word to the sums of the views that show it, block by block, so that the
// sums stay in a cache. Four views at a time: the views of a list are distinct, so their additions
// are independent.
void add_terms(const WordIndex& index, std::span<const WordTerm> terms, double* sums) {
  for (size_t block = 0; block < index.blocks(); ++block, sums += kIndexBlock) {
    for (size_t t = 0; t < terms.size(); ++t) {
      if (t + kListsAhead < terms.size()) {
        // The start of a list; the processor prefetches the rest.
        const uint16_t* const ahead = index.list(block, terms[t + kListsAhead].word).data();
        hwy::Prefetch(ahead);
        hwy::Prefetch(ahead + 32);
      }
      const std::span<const uint16_t> views = index.list(block, terms[t].word);
      const double step = terms[t].to_its_views;
      size_t i = 0;
      for (; i + 4 <= views.size(); i += 4) {
        const double a = sums[views[i]] + step;
        const double b = sums[views[i + 1]] + step;
        const double c = sums[views[i + 2]] + step;
        const double d = sums[views[i + 3]] + step;
        sums[views[i]] = a;
        sums[views[i + 1]] = b;
        sums[views[i + 2]] = c;
        sums[views[i + 3]] = d;
      }
      for (; i < views.size(); ++i) sums[views[i]] += step;
    }
  }
}

/// The probabilities of one word, with the paper's names.
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
  // P(e = 1 | L) of a view that observed L.
  double there(bool observed) const {
    const double a = seen(observed, true) * marginal(true);
    const double b = seen(observed, false) * marginal(false);
    return a / (a + b);
  }
  // FAB-MAP's approximation of P(z | e, z_parent) from P(z | e) and P(z | z_parent).
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

const double kLogProbability = std::log(1e-6);

constexpr size_t kStepsBetween = 32;  // words between two checks that drop views

/// A word in the order of evaluation, with bounds for the words from here on.
struct Step {
  uint32_t word = 0;
  double p_observed = 0;  // P(z_q | z_parent) of the observation: smaller values discriminate more
  double without = 0;     // log-likelihood of a view that does not show the word
  double with = 0;
  // a view whose gap to the best before this step is larger is dropped; 0: keep all
  double gap = 0;
};

std::vector<Step> plan_steps(const FabmapQuery& query) {
  const FabmapModel& model = query.model;
  const std::vector<uint8_t> seen = word_flags(query.words, model.words());
  std::vector<Step> steps;
  for (uint32_t q = 0; q < model.words(); ++q) {
    const bool z = seen[q] != 0;
    const bool parent = seen[model.parent[q]] != 0;
    const double given = parent ? model.p_given[q] : model.p_given_not[q];
    const size_t row = 4 * size_t{z} + 2 * size_t{parent};
    steps.push_back({q, z ? given : 1 - given, model.log_p[q][row], model.log_p[q][row + 1], 0});
  }
  std::ranges::stable_sort(steps, {}, &Step::p_observed);
  double variance = 0;
  double largest = 0;
  for (size_t s = steps.size(); s-- > 0;) {
    Step& step = steps[s];
    const double difference = step.with - step.without;
    const double p = model.p[step.word];
    // If only one of two views shows the word, their log-likelihoods differ by plus or minus
    // `difference`.
    variance += 2 * p * (1 - p) * difference * difference;
    largest = std::max(largest, std::abs(difference));
    if (s % kStepsBetween == 0) step.gap = bail_out_gap(variance, largest);
  }
  return steps;
}

double best_of(const std::vector<uint32_t>& views, const std::vector<double>& sums) {
  double best = -std::numeric_limits<double>::infinity();
  for (const uint32_t v : views) best = std::max(best, sums[v]);
  return best;
}

}  // namespace

FabmapIndex make_fabmap_index(const FabmapModel& model, const ViewWords& views,
                              const WordIndex& lists) {
  FabmapIndex index{lists, {}, 0};
  std::vector<double> step;  // of a word that a view shows and the query does not
  for (const auto& log_p : model.log_p) {
    const double all = log_p[entry(false, false, false)];
    step.push_back(log_p[entry(false, false, true)] - all);
    index.constant += all;
  }
  index.defaults.resize(views.views());
  for (size_t v = 0; v < views.views(); ++v) {
    double sum = 0;
    for (const uint32_t word : views.view(v)) sum += step[word];
    index.defaults[v] = sum;
  }
  return index;
}

std::span<const FabmapVariant> fabmap_variants() { return kVariants; }

const FabmapVariant& find_fabmap_variant(std::string_view name) {
  return find_named(kVariants, "variant", name);
}

std::vector<double> fabmap1_log_likelihoods(const FabmapQuery& query) {
  return sums_over_words(query, query.model.log_p);
}

std::vector<double> lut_log_likelihoods(const FabmapQuery& query) {
  const double scale = std::pow(10.0, query.lut_digits);
  std::vector<std::array<int64_t, 8>> table;
  for (const auto& log_p : query.model.log_p)
    std::ranges::transform(log_p, table.emplace_back().begin(),
                           [&](double value) { return std::llround(value * scale); });
  std::vector<double> likelihoods;
  for (const int64_t sum : sums_over_words(query, table))
    likelihoods.push_back(static_cast<double>(sum) / scale);
  return likelihoods;
}

std::vector<double> fabmap2_log_likelihoods(const FabmapQuery& query) {
  const QueryTerms terms = query_terms(query);
  const double to_all = query.index.constant + terms.to_all;
  std::vector<double> sums = query.index.defaults;
  add_terms(query.index.lists, terms.words, sums.data());
  sums.resize(query.known_views);
  for (double& sum : sums) sum += to_all;
  return sums;
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

FabmapModel make_fabmap_model(const ChowLiuTree& tree, const DetectorModel& detector,
                              WordModel words) {
  const double hit = detector.p_seen_if_there;
  const double false_alarm = detector.p_seen_if_not;
  if (!(false_alarm >= 0 && false_alarm < hit && hit < 1))
    throw Error(ErrorKind::usage,
                "the detector needs 0 <= P(z|not e) < P(z|e) < 1, found {} and {}", false_alarm,
                hit);
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

double bail_out_gap(double variance, double largest) {
  if (variance <= 0 || largest <= 0) return -kLogProbability;
  const auto log_bound = [&](double gap) {
    const double x = gap * largest / variance;
    const double f = std::asinh(x);
    return variance / (largest * largest) * (std::cosh(f) - 1 - x * f);
  };
  double low = 0;
  double high = 1;
  while (log_bound(high) > kLogProbability) high *= 2;
  for (int i = 0; i < 60; ++i) {
    const double middle = (low + high) / 2;
    (log_bound(middle) > kLogProbability ? low : high) = middle;
  }
  return std::max(-kLogProbability, high);
}

std::vector<double> fbo_log_likelihoods(const FabmapQuery& query) {
  const FabmapIndex& index = query.index;
  std::vector<double> sums(index.lists.views, 0);  // without the part common to all views
  std::vector<uint32_t> alive(query.known_views);
  std::iota(alive.begin(), alive.end(), 0U);
  std::erase_if(alive, [&](uint32_t v) { return std::ranges::binary_search(query.unreadable, v); });
  double to_all = 0;
  for (const Step& step : plan_steps(query)) {
    if (step.gap > 0) {
      const double best = best_of(alive, sums);
      std::erase_if(alive, [&](uint32_t v) { return sums[v] < best - step.gap; });
    }
    to_all += step.without;
    for (size_t block = 0; block < index.lists.blocks(); ++block)
      for (const uint16_t v : index.lists.list(block, step.word))
        sums[block * kIndexBlock + v] += step.with - step.without;
  }
  const double best = best_of(alive, sums);
  std::vector<double> result(query.known_views, best + to_all + kLogProbability);
  for (const uint32_t v : alive) result[v] = sums[v] + to_all;
  return result;
}

std::vector<double> fabmap_posterior(std::span<const double> log_likelihoods, double new_place,
                                     std::span<const double> previous,
                                     const PosteriorSettings& settings) {
  const size_t views = log_likelihoods.size();
  std::vector<double> posterior(views + 1);
  posterior[0] = new_place;
  std::copy(log_likelihoods.begin(), log_likelihoods.end(), posterior.begin() + 1);
  if (settings.motion_model && views >= 2 && !previous.empty()) {
    posterior[0] += std::log(settings.new_place_prior);
    const std::span<const double> p = previous.subspan(1);
    for (size_t i = 0; i < views; ++i) {
      const double before = p[i == 0 ? i : i - 1];
      const double after = p[i + 1 == views ? i : i + 1];
      posterior[i + 1] += std::log(
          (2 * (1 - settings.motion_bias) * before + p[i] + 2 * settings.motion_bias * after) / 3);
    }
  }
  const double share = settings.smoothing / exponentiate(posterior);
  const double floor = (1 - settings.smoothing) / static_cast<double>(views + 1);
  for (double& value : posterior) value = share * value + floor;
  return posterior;
}

void ViewWindow::add(std::span<const double> posterior, double t_p, size_t views) {
  run.resize(views, 0);
  for (size_t i = 0; i < views; ++i)
    run[i] = !posterior.empty() && posterior[i + 1] > t_p ? run[i] + 1 : 0;
}

}  // namespace vpr
