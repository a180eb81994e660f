// FAB-MAP's queries, recognitions and sweeps on tiny databases.
#include "fabmap/place_query.h"

#include <cmath>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "evaluate/outcomes.h"
#include "support.h"

using namespace vpr;

namespace {

/// Two words without parents, each in half of all frames. View 0 shows word 0 and view 1 word 1:
/// two views of the place "lift". View 2, of a sequence, shows both.
FabmapDatabase two_words() {
  FabmapDatabase database;
  database.tree = {{0, 1}, {0.5, 0.5}, {0.5, 0.5}, {0.5, 0.5}};
  add_group(database, {{"lift", 2, {"a.jpg", "b.jpg"}}, true}, std::vector<WordSet>{{0}, {1}});
  add_group(database, {{"walk", 1, {""}}}, std::vector<WordSet>{{0, 1}});
  index_views(database);
  return database;
}

/// With P(z|e) = 0.4 and P(z|not e) = 0, P(e|L) is 1 if the view shows the word, otherwise 0.375
/// (0.6 x 0.5 / (0.6 x 0.5 + 0.5)). Therefore P(z|L) is 0.4 or 0.15; for a new place 0.2.
FabmapQuerySettings by_hand() {
  FabmapQuerySettings settings;
  settings.word_model = WordModel::naive_bayes;
  settings.new_place = NewPlaceModel::mean_field;
  settings.p_seen_if_there = 0.4;
  settings.place_threshold = 0.4;
  settings.posterior.smoothing = 1;
  return settings;
}

/// Likelihoods of the new place and the three views for a frame with word 0 only.
constexpr std::array<double, 4> kWord0 = {0.2 * 0.8, 0.4 * 0.85, 0.15 * 0.6, 0.4 * 0.6};
constexpr std::array<double, 4> kWord1 = {0.8 * 0.2, 0.6 * 0.15, 0.85 * 0.4, 0.6 * 0.4};
constexpr std::array<double, 4> kNothing = {0.8 * 0.8, 0.6 * 0.85, 0.85 * 0.6, 0.6 * 0.6};

double share(const std::array<double, 4>& likelihoods, size_t which) {
  double sum = 0;
  for (const double value : likelihoods) sum += value;
  return likelihoods[which] / sum;
}

/// Frame 2 cannot be decoded, frame 5 shows no word.
SequenceWords query_words() { return {{"q", 7, {}, {2}}, {{0}, {0}, {}, {0}, {1}, {}, {0}}}; }

Result run(const FabmapDatabase& database, const FabmapQuerySettings& settings,
           const PosteriorObserver& observe = {}) {
  return query_fabmap(database, query_words(), "q", settings, 1, observe, {}).result;
}

std::vector<std::pair<uint32_t, uint32_t>> frames_and_views(
    const std::vector<Match>& recognitions) {
  std::vector<std::pair<uint32_t, uint32_t>> pairs;
  for (const Match& recognition : recognitions)
    pairs.emplace_back(recognition.query, recognition.view);
  return pairs;
}

}  // namespace

TEST_CASE("posteriors of FAB-MAP equal values computed by hand, for every variant") {
  const FabmapDatabase database = two_words();
  FabmapQuerySettings settings = by_hand();
  const std::vector<const std::array<double, 4>*> expected = {&kWord0, &kWord0,   nullptr, &kWord0,
                                                              &kWord1, &kNothing, &kWord0};
  for (const char* variant : {"fabmap1", "fabmap2", "lut", "fbo"}) {
    settings.variant = variant;
    size_t frames = 0;
    run(database, settings, [&](size_t frame, std::span<const double> posterior) {
      INFO(variant << ", frame " << frame);
      REQUIRE(frame == frames++);
      REQUIRE(posterior.size() == (expected[frame] == nullptr ? 0 : 4));
      for (size_t i = 0; i < posterior.size(); ++i)
        CHECK(posterior[i] == Approx(share(*expected[frame], i)).epsilon(1e-5));
    });
    CHECK(frames == 7);
  }
}

TEST_CASE("a FAB-MAP result holds places, best views and the probability of a new place") {
  const Result result = run(two_words(), by_hand());
  CHECK(result.query.frames == 7);
  CHECK(result.query.unreadable == std::vector<size_t>{2});
  REQUIRE(result.places);
  CHECK(result.places->names == std::vector<std::string>{"lift", "walk#0"});
  CHECK(result.places->views == 3);
  CHECK(result.places->featureless == 1);
  REQUIRE(result.sequences.size() == 1);
  CHECK(result.sequences[0].sequence.frames == 2);
  REQUIRE(result.best.size() == 7);
  REQUIRE(result.best[0]);
  CHECK(result.best[0]->train == 0);
  CHECK(result.best[0]->view == 0);
  CHECK(result.best[0]->score == Approx(share(kWord0, 1)));
  CHECK(result.best[4]->view == 1);
  CHECK_FALSE(result.best[2]);  // unreadable
  CHECK_FALSE(result.best[5]);  // without words
  REQUIRE(result.places->new_place.size() == 7);
  CHECK(result.places->new_place[0] == Approx(share(kWord0, 0)));
  CHECK(result.places->new_place[2] == 0);
  CHECK(result.places->new_place[5] == Approx(share(kNothing, 0)));
}

TEST_CASE("a recognition is a view above t_p in c_w consecutive frames, none of them unreadable") {
  // 0.34 of 0.83: view 0 for word 0, view 1 for word 1.
  FabmapQuerySettings settings = by_hand();
  using Pairs = std::vector<std::pair<uint32_t, uint32_t>>;
  CHECK(frames_and_views(run(two_words(), settings).recognitions) ==
        Pairs{{0, 0}, {1, 0}, {3, 0}, {4, 1}, {6, 0}});
  settings.window = 2;  // frames 3 and 4 show one place, but not one view
  CHECK(frames_and_views(run(two_words(), settings).recognitions) == Pairs{{1, 0}});
  settings.window = 1;
  settings.place_threshold = share(kWord0, 1) + 1e-9;
  CHECK(run(two_words(), settings).recognitions.empty());
  // a view of the sequence and both of the place: one recognition per place
  settings.place_threshold = 0.25;
  const Result both = run(two_words(), settings);
  CHECK(frames_and_views(both.recognitions) ==
        Pairs{{0, 0}, {0, 2}, {1, 0}, {1, 2}, {3, 0}, {3, 2}, {4, 1}, {4, 2}, {6, 0}, {6, 2}});
}

TEST_CASE("a frame without words is never a recognition and ends a run of frames") {
  // Frame 5 shows no word. Views 0 and 1 have 0.51 / 2.02 of its posterior each, and the view of
  // the sequence has more than 0.25 in frames 4 and 6.
  FabmapQuerySettings settings = by_hand();
  settings.place_threshold = 0.25;
  REQUIRE(share(kNothing, 1) > 0.25);
  REQUIRE(share(kWord1, 3) > 0.25);
  const auto recognitions_from_4 = [&](uint64_t window) {
    settings.window = window;
    std::vector<std::pair<uint32_t, uint32_t>> pairs;
    for (const Match& recognition : run(two_words(), settings).recognitions)
      if (recognition.query >= 4) pairs.emplace_back(recognition.query, recognition.view);
    return pairs;
  };
  using Pairs = std::vector<std::pair<uint32_t, uint32_t>>;
  CHECK(recognitions_from_4(1) == Pairs{{4, 1}, {4, 2}, {6, 0}, {6, 2}});
  CHECK(recognitions_from_4(2) == Pairs{{4, 2}});
}

TEST_CASE("among several views of a place, the likeliest one represents it") {
  std::vector<Match> recognitions;
  ViewWindow window;
  const std::vector<double> posterior = {0.1, 0.2, 0.3, 0.25, 0.15};
  window.add(posterior, 0.18, 4);
  append_recognitions(recognitions, 3, posterior, window, 1, {1, 1, 0, 0});
  CHECK(recognitions == std::vector<Match>{{3, 0, 0, 2, 0.25}, {3, 0, 1, 1, 0.3}});
  append_recognitions(recognitions, 3, posterior, window, 2, {1, 1, 0, 0});
  CHECK(recognitions.size() == 2);
}

TEST_CASE("in loop mode, a frame matches frames that are older than the gap") {
  FabmapDatabase database = two_words();
  database.groups.clear();
  database.views = {};
  index_views(database);
  FabmapQuerySettings settings = by_hand();
  CHECK(test::error_kind([&] { run(database, settings); }) == ErrorKind::usage);
  settings.loop = true;
  settings.loop_gap = 1;
  std::vector<size_t> sizes;
  const Result result = run(database, settings, [&](size_t, std::span<const double> posterior) {
    sizes.push_back(posterior.size());
  });
  CHECK(sizes == std::vector<size_t>{1, 1, 0, 3, 4, 5, 6});
  CHECK_FALSE(result.best[1]);
  REQUIRE(result.best[3]);
  CHECK(result.best[3]->view == 0);
  REQUIRE(result.best[6]);
  CHECK(result.best[6]->train == 0);  // the first of the equal frames 0, 1 and 3
  CHECK(result.places->names.at(6) == "q#6");
}
