// Re-scoring of a path: by hand, compared with the reference implementation, and the statistics of
// scores.
#include <cmath>
#include <limits>

#include <catch2/catch.hpp>

#include "base/random.h"
#include "examples.h"
#include "match/distance_statistics.h"
#include "match/filter.h"
#include "match/reference.h"
#include "match/score_kernels.h"
#include "match/zscores.h"
#include "reference/plain_filter.h"
#include "support.h"

using namespace vpr;

namespace {

constexpr uint16_t kWorst = std::numeric_limits<uint16_t>::max();

/// Sequences of places with two frames each, and the keyframes of a path.
struct Path {
  FilterState filter;
  Rescoring rescoring;
  std::vector<uint16_t> scores;  ///< of the next keyframe, to all frames
  std::vector<ScoreScale> made;  ///< their statistics
  std::vector<ScoreScale> known;

  explicit Path(const std::vector<size_t>& places, const FilterSettings& settings = {}) {
    test::Example example;
    for (size_t s = 0; s < places.size(); ++s) {
      std::vector<LdbCode>& codes = example.train.emplace_back();
      for (const LdbCode& code : test::random_codes(places[s], 30 + s))
        codes.insert(codes.end(), 2, code);
    }
    example.train_unreadable.resize(places.size());
    const std::vector<DescribedFrames> spans = example.spans();
    filter = start_filter(frame_distances(spans, {spans[0].rows.first(0), {}}), settings, 1);
    rescoring = start_rescoring(filter);
    const size_t frames = filter.cells.runs.back().frames_end;
    scores.assign(frames, static_cast<uint16_t>(kScoreBias));
    made.resize(frames);
    known.resize(frames);
  }

  size_t cell(size_t sequence, size_t place) const {
    return filter.cells.runs[sequence].first + place;
  }

  void see(size_t best) {
    add_keyframe(
        rescoring, filter.cells, scores, [this](size_t frame) { return made[frame]; }, best);
  }

  RescoredPath read() {
    return rescore(rescoring, filter.cells, [this](size_t frame) { return known[frame]; });
  }
};

}  // namespace

TEST_CASE("supporting places are scored with current statistics") {
  Path path({5, 4});
  const size_t best = path.cell(1, 2);
  const size_t frame = path.filter.cells.frames[best];
  path.scores[frame] = static_cast<uint16_t>(kScoreBias - 2 * kScoreUnit);
  path.made[frame] = {4, 10};  // a centered distance of -16
  path.see(best);
  path.known[frame] = {4, 10};
  CHECK(path.read().supports == std::vector<int32_t>{2 * kScoreUnit});
  path.known[frame] = {-8, 16};
  CHECK(path.read().supports == std::vector<int32_t>{kScoreUnit / 2});
  path.scores[frame] = static_cast<uint16_t>(kScoreBias + kScoreUnit);  // z = 14
  path.see(best);
  path.known[frame] = {-2, 8};
  CHECK(path.read().supports ==
        std::vector<int32_t>{7 * kScoreUnit / 4, -2 * static_cast<int32_t>(kScoreUnit)});
}

TEST_CASE("at most the last 48 keyframes are re-scored") {
  Path path({60});
  for (size_t view = 0; view < 60; ++view) {
    path.scores[2 * view] = static_cast<uint16_t>(kScoreBias - view);
    path.see(path.cell(0, view));
  }
  const RescoredPath reading = path.read();
  REQUIRE(reading.supports.size() == kRescoredKeyframes);
  CHECK(reading.supports.front() == 12);
  CHECK(reading.supports.back() == 59);
}

TEST_CASE("a matching path is likelier than the off-map state, another one is not") {
  for (const double z : {-3.0, 1.0}) {
    Path path({30, 20});
    uint32_t margin = 0;
    for (size_t view = 0; view < 12; ++view) {
      path.scores[2 * view] = static_cast<uint16_t>(kScoreBias + z * kScoreUnit);
      path.see(path.cell(0, view));
      margin = path.read().margin;
    }
    if (z < 0)
      CHECK(margin > 6 * kScoreUnit);
    else
      CHECK(margin == 0);
  }
}

TEST_CASE("the margin of a path equals the reference implementation") {
  for (uint64_t seed = 1; seed <= 30; ++seed) {
    RandomEngine engine(seed);
    FilterSettings settings;
    settings.near_keyframes = seed % 3 == 0 ? 2 : 10;
    Path path({40, 1 + uniform_below(engine, 30)}, settings);
    const size_t sequence = uniform_below(engine, 2);
    const size_t places = path.filter.cells.runs[sequence].count;
    size_t place = uniform_below(engine, places);
    for (size_t view = 0; view < 20 + 10 * (seed % 4); ++view) {
      place = std::min(place + uniform_below(engine, 3), places - 1);
      for (uint16_t& score : path.scores)
        score = static_cast<uint16_t>(kScoreBias - 4 * kScoreUnit +
                                      uniform_below(engine, 6 * kScoreUnit));
      path.see(path.cell(sequence, place));
    }
    const RescoredPath reading = path.read();

    const CellRun& run = path.filter.cells.runs[sequence];
    std::vector<std::vector<uint16_t>> plain;
    for (const PathKeyframe& view : path.rescoring.views) {
      std::vector<uint16_t>& scores = plain.emplace_back(run.count, kWorst);
      for (size_t k = 0; k < view.distances.size(); ++k)
        scores[view.first + k - run.first] =
            static_cast<uint16_t>(kScoreBias + std::lround(view.distances[k] * kScoreUnit));
    }
    // Only the places around the path are used.
    size_t first = run.count;
    size_t end = 0;
    for (const PathKeyframe& view : path.rescoring.views) {
      first = std::min(first, view.first - run.first);
      end = std::max(end, view.first + view.distances.size() - run.first);
    }
    for (std::vector<uint16_t>& scores : plain)
      scores = {scores.begin() + static_cast<ptrdiff_t>(first),
                scores.begin() + static_cast<ptrdiff_t>(end)};
    const double expected =
        plain_path_margin(plain, place - first, path.filter.cells.places, settings);
    INFO("seed " << seed);
    CHECK(static_cast<double>(reading.margin) / kScoreUnit ==
          Approx(expected).margin(filter_tolerance(plain.size())));
  }
}

TEST_CASE("keyframes before an unreadable training frame only count as support") {
  test::Example example;
  example.train = {test::random_codes(30, 7)};
  example.train_unreadable = {{10}};
  const std::vector<DescribedFrames> spans = example.spans();
  const FilterState filter =
      start_filter(frame_distances(spans, {spans[0].rows.first(0), {}}), {}, 1);
  Rescoring rescoring = start_rescoring(filter);
  const auto scale = [](size_t) { return ScoreScale{}; };
  const std::vector<uint16_t> scores(30, static_cast<uint16_t>(kScoreBias - 3 * kScoreUnit));
  const CellRun& behind = filter.cells.runs[1];
  for (size_t view = 0; view < 8; ++view)
    add_keyframe(rescoring, filter.cells, scores, scale, filter.cells.runs[0].first + view);
  add_keyframe(rescoring, filter.cells, scores, scale, behind.first);
  const RescoredPath both = rescore(rescoring, filter.cells, scale);
  rescoring.views.erase(rescoring.views.begin(), rescoring.views.end() - 1);
  const RescoredPath one = rescore(rescoring, filter.cells, scale);
  CHECK(both.supports.size() == 9);
  CHECK(both.margin == one.margin);
}

TEST_CASE("scores report their statistics, and those with a small weight of the training data") {
  test::Example example;
  example.train = {test::walk_codes(60, 1, 25), test::walk_codes(50, 2, 25)};
  example.train_unreadable.resize(2);
  example.query = test::walk_codes(300, 3, 60);
  const std::vector<DescribedFrames> spans = example.spans();
  TrainStatistics statistics = compute_statistics(spans, {}, {});
  statistics.components = compute_components(spans, statistics.typical_distance, {});
  const ScoreBasis basis = make_score_basis({}, false, statistics);
  const FrameDistances scores = zscores(frame_distances(spans, {example.query, {}}), basis, {});
  const ReferenceUpdates updates = reference_updates(spans, {example.query, {}}, basis, {});
  const ZScoreSettings settings;
  std::vector<std::vector<double>> centered;  // by query and training frame
  std::vector<size_t> learned;
  std::vector<uint16_t> row(scores.train_frames + kBlockFrames);
  for (uint32_t query = 0; query < scores.query_frames; ++query) {
    scores.start_row(query);
    scores.tile({&query, 1}, 0, scores.train_frames, row.data(), 0);
    if (updates.learned[query]) learned.push_back(*updates.learned[query]);
    std::vector<double>& x = centered.emplace_back();
    for (size_t i = 0; i < scores.train_frames; ++i) {
      const ScoreScale made = scores.scale(i);
      x.push_back(made.mean + made.deviation * (row[i] - double{kScoreBias}) / kScoreUnit);
    }
    if (query % 31 != 0) continue;
    for (size_t i = 0; i < scores.train_frames; i += 7) {
      double weight = settings.offline_start_weight;
      double sum = weight * basis.mean[i];
      double squares = weight * (basis.variance + basis.mean[i] * basis.mean[i]);
      for (size_t k = 0; k < learned.size(); ++k) {
        const double share =
            std::pow(settings.forgetting, static_cast<double>(learned.size() - 1 - k));
        const double past = centered[learned[k]][i];
        weight += share;
        sum += share * past;
        squares += share * past * past;
      }
      const double mean = sum / weight;
      const double deviation = std::sqrt(std::max(squares / weight - mean * mean, 100.0));
      INFO("query frame " << query << ", training frame " << i);
      CHECK(scores.learned_scale(i).mean == Approx(mean).margin(0.1));
      CHECK(scores.learned_scale(i).deviation == Approx(deviation).margin(0.1));
    }
  }
  CHECK(learned.size() > 20);
}
