#include "database/chow_liu.h"

#include <cmath>

#include <catch2/catch.hpp>

#include "base/random.h"
#include "base/simd.h"
#include "reference/plain_words.h"

using namespace vpr;

namespace {

std::vector<WordSet> random_frames(size_t frames, size_t words, uint64_t seed) {
  RandomEngine engine(seed);
  std::vector<WordSet> sets(frames);
  for (WordSet& set : sets)
    for (uint32_t q = 0; q < words; ++q)
      if (uniform_below(engine, 5 + q % 7) == 0) set.push_back(q);
  if (frames > 2) sets[1].clear();  // a frame without features
  return sets;
}

bool same_tree(const ChowLiuTree& a, const ChowLiuTree& b) {
  return a.parent == b.parent && a.p == b.p && a.p_given == b.p_given &&
         a.p_given_not == b.p_given_not;
}

}  // namespace

TEST_CASE("mutual information, worked out by hand") {
  // Two words that always occur together, in half of four frames.
  const double p = 0.98 * 0.5 + 0.01;
  const double expected = 0.5 * std::log(0.5 / (p * p)) * 2;
  CHECK(MutualInformation(4)(2, 2, 2) == Approx(expected));
  // Independent words: all four cells a quarter.
  CHECK(MutualInformation(4)(2, 2, 1) == Approx(4 * 0.25 * std::log(0.25 / (p * p))).margin(1e-15));
}

TEST_CASE("a tree of three words, worked out by hand") {
  // Words 1 and 2 go together; word 0 is in one frame of its own.
  const std::vector<WordSet> frames = {{1, 2}, {1, 2}, {0}, {}};
  const ChowLiuTree tree = train_chow_liu(frames, 3, {});
  CHECK(tree.parent[1] == 1);  // the smaller word of the best edge is the root
  CHECK(tree.parent[2] == 1);
  CHECK(tree.p[1] == Approx(0.98 * 0.5 + 0.01));
  CHECK(tree.p_given[1] == tree.p[1]);
  CHECK(tree.p_given[2] == Approx(0.99));
  CHECK(tree.p_given_not[2] == Approx(0.01));
}

TEST_CASE("a conditional whose condition never occurs has frequency 0") {
  const ChowLiuTree tree = train_chow_liu(std::vector<WordSet>{{0}, {0}}, 2, {});
  const size_t child = tree.parent[0] == 0 ? 1 : 0;
  CHECK((child == 1 ? tree.p_given_not[1] : tree.p_given[0]) == Approx(0.01));
}

TEST_CASE("a single word is its own root") {
  const ChowLiuTree tree = train_chow_liu(std::vector<WordSet>{{0}, {}}, 1, {});
  CHECK(tree.parent == std::vector<uint32_t>{0});
}

TEST_CASE("the fast tree is the obvious one, ties included, on every SIMD target") {
  for (const std::string& target : simd_targets()) {
    use_simd_target(target);
    for (const auto& [frames, words] : std::vector<std::pair<size_t, size_t>>{
             {1, 2}, {5, 3}, {63, 17}, {64, 16}, {65, 40}, {200, 90}})
      for (uint64_t seed = 0; seed < 3; ++seed) {
        const auto sets = random_frames(frames, words, seed);
        REQUIRE(same_tree(train_chow_liu(sets, words, {}), plain_chow_liu(sets, words)));
      }
  }
  use_simd_target("");
}
