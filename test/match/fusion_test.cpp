// The effect of FAB-MAP's words on scores: by hand, and compared with the reference implementation.
#include "match/fusion.h"

#include <cmath>

#include <catch2/catch.hpp>

#include "base/random.h"
#include "reference/reference_fusion.h"

using namespace vpr;

namespace {

/// Views of independent words that occur in half of all frames: view 0 shows all words, view 1
/// none. Each is a sequence of one frame.
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
  return views;
}

WordSet words_of_first_view(const FusedViews& views) {
  const auto words = views.fabmap.views.view(0);
  return {words.begin(), words.end()};
}

// A fusion of sequences with random words.
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
  index_views(views->fabmap);
  return make_fusion_basis(views, weight, {});
}

}  // namespace

TEST_CASE("the effect of words on scores equals values computed by hand") {
  // P(z|L) is 0.39 if the view shows the word, otherwise 0.39 * 0.61 / 1.61 = 0.14776: a word in
  // the frame favors view 0 by ln(0.39 / 0.14776) = 0.97054 nats.
  const auto row_is = [](const std::shared_ptr<FusedViews>& views, double weight, double behind) {
    const FusionRow row =
        fusion_row(make_fusion_basis(views, 0.2, {0, 0}), words_of_first_view(*views), weight);
    CHECK(row.likeliest == 0);
    CHECK(std::abs(row.added[0] + weight * behind / 2) < 0.002 * weight + 1e-12);
    CHECK(std::abs(row.added[1] - weight * behind / 2) < 0.002 * weight + 1e-12);
    const double deviation = weight * behind / 2;
    CHECK(std::abs(row.scale - 1 / std::sqrt(1 + deviation * deviation)) < 0.002);
  };
  row_is(all_and_none(1), 0.2, 0.97054);
  row_is(all_and_none(6), 0.2, 5.82327);
  row_is(all_and_none(6), 1, 5.82327);
  row_is(all_and_none(6), 0, 5.82327);
  row_is(all_and_none(60), 0.5, 40);  // clamped
  // A frame without words has no evidence, and an unreadable one is never counted.
  const FusionRow silent = fusion_row(make_fusion_basis(all_and_none(60), 0.2, {0, 0}), {}, 1);
  CHECK(silent.added == std::vector<double>{0, 0});
  CHECK(silent.scale == 1);
  CHECK_FALSE(silent.likeliest);
  const auto gap = all_and_none(60);
  gap->views[0] = FusedViews::kNoView;
  const FusionRow other =
      fusion_row(make_fusion_basis(gap, 0.2, {0, 0}), words_of_first_view(*gap), 1);
  CHECK(other.added == std::vector<double>{0, 0});
  CHECK(other.likeliest == 1);
}

TEST_CASE("the weight of FAB-MAP follows the agreement of matches, computed by hand") {
  // Among 100 frames, 11 are near one of the first sequence, and 5 near one of the second.
  const std::vector<FusedSequence> sequences = {{60, 5}, {40, 2}};
  FusionBasis basis;
  basis.weight = 0.2;
  FusionState agreement;
  CHECK(agreement.ratio() == 0.6);
  CHECK(std::abs(fusion_weight(basis, agreement) - 0.2 * std::pow(0.6, 1.5)) < 1e-12);
  agreement.count({{}, {}}, sequences);
  agreement.count({10, 70}, sequences);  // no previous frame, and different places
  CHECK(std::abs(agreement.together + 0.11) < 1e-12);
  CHECK(agreement.likeliest_steps == 0);
  agreement.count({15, 73}, sequences);  // a step of 5, and one of 3
  CHECK(std::abs(agreement.likeliest_steps - 0.89) < 1e-12);
  CHECK(std::abs(agreement.closest_steps + 0.11) < 1e-12);
  agreement.count({61, 59}, sequences);  // adjacent frames of different sequences
  CHECK(std::abs(agreement.likeliest_steps - 0.78) < 1e-12);
  CHECK(std::abs(agreement.closest_steps + 0.22) < 1e-12);
  CHECK(std::abs(agreement.together + 0.27) < 1e-12);
  agreement.count({{}, 58}, sequences);  // without words
  agreement.count({63, 61}, sequences);
  CHECK(std::abs(agreement.closest_steps + 0.22) < 1e-12);
  CHECK(std::abs(agreement.together - 0.68) < 1e-12);
  CHECK(std::abs(agreement.ratio() - (0.73 + 3) / 5) < 1e-12);
  for (int frame = 0; frame < 1000; ++frame) {
    agreement.count({0, frame % 2 == 0 ? 0U : 99U}, sequences);
  }
  CHECK(agreement.ratio() > 20);
  CHECK(fusion_weight(basis, agreement) == 1);
}

TEST_CASE("integer rows equal the reference implementation") {
  for (const double weight : {0.2, 0.01, 1.0}) {
    const FusionBasis basis = random_basis(7, weight);
    RandomEngine engine(3);
    for (int trial = 0; trial < 40; ++trial) {
      WordSet words;
      const uint64_t share = uniform_below(engine, 11);
      for (uint32_t word = 0; word < 30; ++word)
        if (uniform_below(engine, 10) < share) words.push_back(word);
      const FusionRow row = fusion_row(basis, words, weight);
      const FusionRow plain = reference_fusion_row(basis, words, weight);
      REQUIRE(row.added.size() == plain.added.size());
      CHECK(row.likeliest.has_value() == plain.likeliest.has_value());
      for (size_t i = 0; i < row.added.size(); ++i)
        for (const double z : {-32.0, -2.0, 0.0, 31.0})
          CHECK(std::abs((z + row.added[i]) * row.scale - (z + plain.added[i]) * plain.scale) <=
                fusion_tolerance(basis) / 1024);
    }
  }
}
