#include "fabmap/model.h"

#include <algorithm>
#include <cmath>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "base/random.h"
#include "queries.h"
#include "support.h"

using namespace vpr;
using test::random_words;

namespace {

struct Example {
  ChowLiuTree tree;
  ViewWords views;
  std::vector<WordSet> queries;

  explicit Example(size_t words, size_t view_count, uint64_t seed) {
    RandomEngine engine(seed);
    std::vector<WordSet> frames;
    for (int f = 0; f < 60; ++f) frames.push_back(random_words(words, 4, engine));
    tree = train_chow_liu(frames, words, {});
    for (size_t v = 0; v < view_count; ++v) views.add(random_words(words, 5, engine));
    views.add(std::vector<uint32_t>{});
    queries = {{}, random_words(words, 5, engine), random_words(words, 2, engine)};
    for (uint32_t q = 0; q < words; ++q) queries[0].push_back(q);
    queries.emplace_back();
    queries.emplace_back(views.view(1).begin(), views.view(1).end());
  }
};

}  // namespace

TEST_CASE("the probabilities of a word equal values computed by hand") {
  // One word, P(z) = 0.2, naive Bayes. A view with the word: P(e) = 1, so P(z | L) = 0.39. A view
  // without it: P(e) = 0.61 * 0.2 / (0.61 * 0.2 + 0.8) = 0.122 / 0.922.
  ChowLiuTree tree{{0}, {0.2}, {0.2}, {0.2}};
  const FabmapModel model = make_fabmap_model(tree, {}, WordModel::naive_bayes);
  const double there = 0.122 / 0.922;
  CHECK(std::exp(model.log_p[0][4 + 1]) == Approx(0.39));
  CHECK(std::exp(model.log_p[0][0 + 1]) == Approx(0.61));
  CHECK(std::exp(model.log_p[0][4 + 0]) == Approx(0.39 * there));
  CHECK(std::exp(model.log_p[0][0 + 0]) == Approx(1 - 0.39 * there));
  CHECK(std::exp(model.log_p_new[0][2]) == Approx(0.39 * 0.2));
}

TEST_CASE("invalid detectors are refused") {
  const ChowLiuTree tree{{0}, {0.2}, {0.2}, {0.2}};
  for (const DetectorModel detector :
       {DetectorModel{0, 0}, DetectorModel{1, 0}, DetectorModel{0.3, 0.4}, DetectorModel{0.3, -0.1},
        DetectorModel{NAN, 0}})
    CHECK(test::error_kind([&] { make_fabmap_model(tree, detector, WordModel::tree); }) ==
          ErrorKind::usage);
}

TEST_CASE("every variant agrees with the reference implementation within its documented error") {
  for (const WordModel words : {WordModel::tree, WordModel::naive_bayes}) {
    for (const DetectorModel detector : {DetectorModel{}, DetectorModel{0.5, 0.05}}) {
      for (uint64_t seed = 0; seed < 3; ++seed) {
        const Example example(120, 40, seed);
        const FabmapModel model = make_fabmap_model(example.tree, detector, words);
        const WordIndex index_lists = make_word_index(example.views, model.words());
        const FabmapIndex index = make_fabmap_index(model, example.views, index_lists);
        for (const WordSet& query : example.queries) {
          const FabmapQuery input{model, example.views, index, query, example.views.views()};
          const auto expected = fabmap1_log_likelihoods(input);
          const auto check = [&](const std::vector<double>& found, double error) {
            REQUIRE(found.size() == expected.size());
            for (size_t v = 0; v < found.size(); ++v)
              REQUIRE(std::abs(found[v] - expected[v]) <= error);
          };
          check(fabmap2_log_likelihoods(input), 1e-9);
          check(lut_log_likelihoods(input), 120 * 0.5e-6 + 1e-9);
          const auto kept = fbo_log_likelihoods(input);
          const double best = *std::max_element(expected.begin(), expected.end());
          for (size_t v = 0; v < kept.size(); ++v) {
            // Either exact, or dropped: then it was far below the best and is best + ln 1e-6.
            const bool exact = std::abs(kept[v] - expected[v]) < 1e-9;
            REQUIRE((exact || std::abs(kept[v] - (best + std::log(1e-6))) < 1e-9));
            if (expected[v] > best - 5) REQUIRE(exact);
          }
        }
      }
    }
  }
}

TEST_CASE("the bail-out gap satisfies its bound, and is never below ln 1e6") {
  CHECK(bail_out_gap(0, 0) == Approx(-std::log(1e-6)));
  CHECK(bail_out_gap(1e-9, 1) == Approx(-std::log(1e-6)));
  for (const double variance : {10.0, 100.0, 5000.0}) {
    const double m = 2;
    const double gap = bail_out_gap(variance, m);
    const double x = gap * m / variance;
    const double f = std::asinh(x);
    const double bound = std::exp(variance / (m * m) * (std::cosh(f) - 1 - x * f));
    CHECK(bound == Approx(1e-6).epsilon(1e-3));
  }
}

TEST_CASE("the mean of likelihoods does not overflow") {
  CHECK(log_mean_exp(std::vector<double>{-5000, -5000}) == Approx(-5000));
  CHECK(log_mean_exp(std::vector<double>{0, -1e300}) == Approx(-std::log(2)));
}

TEST_CASE("unknown views do not affect known views") {
  const Example example(80, 10, 8);
  ViewWords fewer;
  for (size_t v = 0; v < 4; ++v) fewer.add(example.views.view(v));
  const FabmapModel model = make_fabmap_model(example.tree, {}, WordModel::tree);
  const WordIndex lists = make_word_index(example.views, model.words());
  const WordIndex fewer_lists = make_word_index(fewer, model.words());
  const FabmapIndex index = make_fabmap_index(model, example.views, lists);
  const FabmapIndex fewer_index = make_fabmap_index(model, fewer, fewer_lists);
  for (const FabmapVariant& variant : fabmap_variants())
    for (const WordSet& query : example.queries)
      CHECK(variant.log_likelihoods({model, example.views, index, query, 4}) ==
            variant.log_likelihoods({model, fewer, fewer_index, query, 4}));
}
