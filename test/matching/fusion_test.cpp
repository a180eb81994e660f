// What FAB-MAP's words take from scores: by hand, and against the oracle.
#include "matching/fusion.h"

#include <cmath>

#include <catch2/catch.hpp>

#include "base/random.h"
#include "matching/view_evidence.h"

using namespace vpr;

namespace {

/// Views of so many words, each in half of all frames and independent of others: view 0 shows all,
/// view 1 none. Each is a sequence of one frame.
std::shared_ptr<FusedViews> all_and_none(uint32_t words) {
  auto views = std::make_shared<FusedViews>();
  FabmapDatabase& fabmap = views->fabmap;
  const std::vector<double> half(words, 0.5);
  fabmap.tree = {{}, half, half, half};
  WordSet all;
  for (uint32_t word = 0; word < words; ++word) {
    fabmap.tree.parent.push_back(word);
    all.push_back(word);
  }
  add_group(fabmap, {"a", false, {"0"}}, std::vector<WordSet>{all});
  add_group(fabmap, {"b", false, {"0"}}, std::vector<WordSet>{{}});
  index_views(fabmap);
  views->frames = {1, 1};
  views->views = {0, 1};
  views->words = {all, {}};
  return views;
}

// A fusion of walks of random words, of which two show one place.
FusionBasis random_basis(uint64_t seed, double weight) {
  RandomEngine engine(seed);
  auto views = std::make_shared<FusedViews>();
  const auto random_words = [&] {
    WordSet words;
    for (uint32_t word = 0; word < 30; ++word)
      if (uniform_below(engine, 10) < 3) words.push_back(word);
    return words;
  };
  std::vector<WordSet> all;
  for (const size_t frames : {40, 3, 25, 1}) {
    std::vector<WordSet> walk(frames);
    for (WordSet& words : walk) {
      if (uniform_below(engine, 8) > 0) words = random_words();
      views->views.push_back(static_cast<uint32_t>(views->views.size()));
      all.push_back(words);
    }
    views->frames.push_back(frames);
    add_group(views->fabmap, {std::to_string(frames), false, std::vector<std::string>(frames)},
              walk);
  }
  for (const size_t frame : {0, 7, 41, 68}) views->views[frame] = FusedViews::kNoView;
  views->fabmap.tree = train_chow_liu(all, 30, {});
  views->shared_places = {{0, 2}};
  views->words = all;
  index_views(views->fabmap);
  return make_fusion_basis(views, weight, {});
}

}  // namespace

TEST_CASE("what words take from scores, by hand") {
  // P(z|L) is 0.39 where the view shows the word, and 0.39 * 0.61 / 1.61 = 0.14776 elsewhere: a
  // word that the frame shows speaks for view 0 by ln(0.39 / 0.14776) = 0.97054 nats.
  const auto row = [](const std::shared_ptr<FusedViews>& views, double weight = 0.25) {
    return fusion_row(make_fusion_basis(views, weight, {0, 0}), views->words[0]);
  };
  const auto is_near = [](int value, double expected) { return std::abs(value - expected) < 1.5; };
  // One word: levels of +-0.48527 nats, and a lead that is no more than 2.
  CHECK(is_near(row(all_and_none(1))[0], 1024 * 0.25 * 0.48527 / 2));
  CHECK(is_near(row(all_and_none(1))[1], -1024 * 0.25 * 0.48527 / 2));
  // Four: 3.88218 nats apart, of which view 0 has a lead of 1.88218.
  CHECK(is_near(row(all_and_none(4))[0], 1024 * 0.25 * (1.94109 / 2 + 1.88218)));
  CHECK(is_near(row(all_and_none(4))[1], -1024 * 0.25 * 1.94109 / 2));
  CHECK(is_near(row(all_and_none(4), 1)[0], 1024 * (1.94109 / 2 + 1.88218)));
  CHECK(row(all_and_none(4), 0) == std::vector<int16_t>{0, 0});
  // Forty: all is cut off.
  CHECK(row(all_and_none(40)) == std::vector<int16_t>{1024 / 4 * (3 + 10), -1024 / 4 * 2});
  // Where both show one place, nothing is elsewhere.
  const auto shared = all_and_none(40);
  shared->shared_places = {{0, 1}};
  CHECK(row(shared) == std::vector<int16_t>{1024 / 4 * 3, -1024 / 4 * 2});
  // A frame without words says nothing, and one that can't be read counts nowhere.
  CHECK(fusion_row(make_fusion_basis(all_and_none(40), 0.25, {0, 0}), {}) ==
        std::vector<int16_t>{0, 0});
  const auto gap = all_and_none(40);
  gap->views[1] = FusedViews::kNoView;
  CHECK(row(gap) == std::vector<int16_t>{0, 0});
}

TEST_CASE("rows in whole numbers are those of the definition") {
  for (const double weight : {0.25, 0.1, 2.0}) {
    const FusionBasis all = random_basis(7, weight);
    const FusionBasis some = fusion_of(all, {1, 0, 1, 1});
    RandomEngine engine(3);
    for (int trial = 0; trial < 40; ++trial) {
      WordSet words;
      const uint64_t share = uniform_below(engine, 11);
      for (uint32_t word = 0; word < 30; ++word)
        if (uniform_below(engine, 10) < share) words.push_back(word);
      for (const FusionBasis* basis : {&all, &some}) {
        const std::vector<int16_t> row = fusion_row(*basis, words);
        const std::vector<double> plain = plain_fusion_row(*basis, words);
        REQUIRE(row.size() == plain.size());
        for (size_t i = 0; i < row.size(); ++i)
          CHECK(std::abs(row[i] - 1024 * plain[i]) <= fusion_tolerance(*basis));
      }
    }
  }
}

TEST_CASE("a training walk as the query does not know its own views") {
  const FusionBasis all = random_basis(7, 0.25);
  const FusionBasis some = fusion_of(all, {0, 1, 1, 1});
  const auto& views = *std::as_const(all).evidence->of;
  for (const size_t own : {0, 20, 39, 41, 43, 50, 67, 68}) {
    for (const FusionBasis* basis : {&all, &some}) {
      FusionBasis without = *basis;
      size_t frame = 0;
      size_t before = 0;  // of all training frames
      for (const FusedWalk& walk : all.walks) {
        const bool is_matched = basis == &all || walk.sequence > 0;
        for (size_t i = 0; i < walk.frames && is_matched; ++i, ++frame)
          if (own >= before && own < before + walk.frames &&
              std::abs(static_cast<int>(before + i) - static_cast<int>(own)) <= 5)
            without.views[frame] = FusedViews::kNoView;
        before += walk.frames;
      }
      CHECK(fusion_row(*basis, views.words[own], own) == fusion_row(without, views.words[own]));
    }
  }
}
