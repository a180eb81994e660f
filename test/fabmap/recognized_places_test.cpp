#include <limits>

#include <catch2/catch.hpp>

#include "base/random.h"
#include "fabmap/place_query.h"
#include "queries.h"

using namespace vpr;
using test::random_words;

namespace {

/// A database of views that show a third of the words each; undecodable views (`unreadable`) show
/// none.
FabmapDatabase make_database(size_t words, size_t views, const std::vector<size_t>& unreadable,
                             uint64_t seed) {
  RandomEngine engine(seed);
  FabmapDatabase database;
  std::vector<WordSet> pretrain;
  for (int f = 0; f < 40; ++f) pretrain.push_back(random_words(words, 3, engine));
  database.tree = train_chow_liu(pretrain, words, {});
  for (const WordSet& frame : pretrain) database.pretrain.add(frame);
  std::vector<WordSet> frames;
  for (size_t v = 0; v < views; ++v) frames.push_back(random_words(words, 3, engine));
  for (const size_t v : unreadable) frames[v].clear();
  add_group(database, {{"walk", views, {}, unreadable}}, frames);
  index_views(database);
  return database;
}

// The same database without undecodable views.
FabmapDatabase without_unreadable(const FabmapDatabase& database) {
  FabmapDatabase fewer = database;
  const std::vector<size_t> unreadable = database.unreadable_views();
  fewer.groups.clear();
  fewer.views = {};
  std::vector<WordSet> frames;
  for (size_t v = 0; v < database.views.views(); ++v)
    if (std::find(unreadable.begin(), unreadable.end(), v) == unreadable.end())
      frames.emplace_back(database.views.view(v).begin(), database.views.view(v).end());
  add_group(fewer, {{"walk", frames.size()}}, frames);
  index_views(fewer);
  return fewer;
}

}  // namespace

TEST_CASE("undecodable views do not change the likelihoods of other views, for any variant") {
  const std::vector<size_t> unreadable = {0, 7};
  for (uint64_t seed = 1; seed <= 4; ++seed) {
    const FabmapDatabase database = make_database(200, 12, unreadable, seed);
    const FabmapDatabase fewer = without_unreadable(database);
    RandomEngine engine(seed);
    // Few words or none: a view without words is the likeliest, and would drop the others.
    for (const WordSet& query :
         {WordSet{}, random_words(200, 60, engine), random_words(200, 3, engine)}) {
      for (const FabmapVariant& variant : fabmap_variants()) {
        INFO(variant.name << ", " << query.size() << " words");
        FabmapQuerySettings settings;
        settings.variant = variant.name;
        const std::vector<double> found =
            FabmapMatcher(database, settings, 1).views(query, database.views.views());
        std::vector<double> expected =
            FabmapMatcher(fewer, settings, 1).views(query, fewer.views.views());
        for (const size_t v : unreadable)
          expected.insert(expected.begin() + static_cast<ptrdiff_t>(v),
                          -std::numeric_limits<double>::infinity());
        CHECK(found == expected);
      }
    }
  }
}

TEST_CASE("frames without words are counted separately from undecodable ones") {
  FabmapDatabase database = make_database(50, 4, {1}, 1);
  add_group(database, {{"more", 3, {"a", "b", "c"}, {2, 2}}}, std::vector<WordSet>{{}, {3}, {}});
  CHECK(featureless_frames(database) == std::vector<size_t>{0, 1});
}

TEST_CASE("a resampled FAB-MAP query repeats the words of the recording") {
  const FabmapDatabase database = make_database(100, 12, {}, 3);
  RandomEngine engine(5);
  SequenceWords recording;
  recording.sequence = {"q", 45, std::vector<std::string>(45), {9}};
  for (int f = 0; f < 45; ++f) recording.words.push_back(random_words(100, 3, engine));
  recording.words[9].clear();
  FabmapQuerySettings settings;
  settings.posterior.motion_model = false;  // so that a frame does not depend on earlier ones
  const auto best_of = [&](const SequenceWords& words) {
    return query_fabmap(database, words, "q", settings, 1, {}, {}).result;
  };
  const Result plain = best_of(recording);
  for (const SpeedRule& rule : speed_rules()) {
    INFO(rule.name);
    const Result result = best_of(selected(recording, at_speed(std::string(rule.name), 45, 2)));
    REQUIRE_FALSE(result.query.selection.is_all());
    REQUIRE(result.best.size() == result.query.selection.frames());
    for (size_t k = 0; k < result.best.size(); ++k) {
      const auto& expected = plain.best[result.query.selection.sources[k]];
      REQUIRE(result.best[k].has_value() == expected.has_value());
      if (expected) CHECK(result.best[k]->train == expected->train);
    }
  }
  settings.loop = true;
  CHECK_THROWS_WITH(best_of(selected(recording, at_speed("2", 45, 1))),
                    Catch::Contains("vpr-query loops"));
}
