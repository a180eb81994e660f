// Z-scores fused with FAB-MAP: training sequences, and whole queries.
#include <cmath>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "base/parallel.h"
#include "examples.h"
#include "match/fusion.h"
#include "match/zscores.h"
#include "queries.h"
#include "reference/verified_query.h"
#include "run/open.h"
#include "run/query.h"
#include "run/train_sequences.h"
#include "support.h"

using namespace vpr;

namespace {

/// Two sequences and a query through parts of both; some frames are unreadable.
struct Walks {
  SequenceDatabase database;
  DescriptorSet query;

  Walks() {
    const std::vector<std::vector<LdbCode>> train = {
        test::walk_codes(60, 1), test::walk_codes(70, 2), test::walk_codes(30, 5)};
    database = test::make_database(train);
    database.sequences[0].sequence.unreadable = {31, 32};
    ensure_statistics(database, {});
    fuse_views(database, test::make_fabmap(database), "f");
    std::vector<LdbCode> codes = test::walk_codes(12, 3);
    codes.insert(codes.end(), train[0].begin() + 5, train[0].begin() + 25);
    codes.insert(codes.end(), train[1].begin() + 40, train[1].begin() + 65);
    query = test::make_query(codes);
    query.sequence.unreadable = {20};
    for (const LdbCode& code : codes) query.words.push_back(test::words_of(code));
    query.words[20].clear();
    query.words[3].clear();
  }
};

SequenceQuerySettings fused_settings(uint64_t length) {
  SequenceQuerySettings settings;
  settings.score = Score::zscore;
  settings.window_length = length;
  settings.fusion_weight = 0.25;
  settings.distance_threshold = -2;
  return settings;
}

void check_row(const std::vector<uint16_t>& fused, const std::vector<uint16_t>& scores,
               const FusionRow& row) {
  for (size_t i = 0; i < row.added.size(); ++i) {
    const double score = (scores[i] - 32768.0 + 1024 * row.added[i]) * row.scale + 32768;
    CHECK(fused[i] == std::floor(std::clamp(score + 0.5, 0.0, 65535.0)));
  }
}

Result query_all(const Walks& walks, const SequenceQuerySettings& settings, size_t verify = 200) {
  const QueryResources resources;
  const QueryPlan plan = plan_query(walks.database, walks.query, "q", settings, resources, {});
  return test::run_verified(plan, verify).result;
}

}  // namespace

TEST_CASE("fused scores are scores plus evidence with the weight of earlier frames, clamped") {
  const Walks walks;
  const ScoreStages stages = stages_of(fused_settings(1), &*walks.database.statistics);
  const ScoreBasis& basis = *stages.basis;
  const std::vector<DescribedFrames> train = descriptor_spans(walks.database);
  const FrameDistances distances = frame_distances(train, walks.query.span());
  const FrameDistances scores = zscores(distances, basis);
  const FrameDistances both = scored(distances, stages);
  std::vector<uint16_t> plain(192);
  std::vector<uint16_t> fast(192);
  FusionState agreement;
  BestFrames best;
  for (uint32_t frame = 0; frame < scores.query_frames; ++frame) {
    scores.start_row(frame);
    both.start_row(frame);
    scores.tile({&frame, 1}, 0, 160, plain.data(), 192);
    agreement.count(best, basis.fusion.sequences);
    const FusionRow row =
        fusion_row(basis.fusion, walks.query.words[frame], fusion_weight(basis.fusion, agreement));
    std::optional<size_t> closest;
    for (size_t i = 0; i < 160; ++i)
      if (i != 31 && i != 32 && (!closest || plain[i] < plain[*closest])) closest = i;
    best = {row.likeliest, closest};
    both.tile({&frame, 1}, 0, 72, fast.data(), 192);  // in two parts
    both.tile({&frame, 1}, 72, 160, fast.data() + 72, 192);
    check_row(fast, plain, row);
  }
  CHECK(agreement.likeliest_steps > 5);  // the agreement has been estimated
  CHECK(agreement.closest_steps > 5);
}

TEST_CASE("whole queries equal the definition, for every method, score and number of threads") {
  const Walks walks;
  const SequenceQuerySettings settings = fused_settings(5);
  const Result result = query_all(walks, settings);
  CHECK(recognized_windows(result) > 10);
  CHECK(result.best[14]->train == 7);
  for (const size_t threads : {1, 3}) {
    const ThreadLimit limit(threads);
    SequenceQuerySettings online = settings;
    online.method = "fastable-online";
    const Result same = query_all(walks, online);
    CHECK(same.recognitions == result.recognitions);
    CHECK(same.best == result.best);
    CHECK(same.margins == result.margins);
  }
  SequenceQuerySettings other = settings;
  other.only_sequences = {"b"};
  query_all(walks, other);
  other = settings;
  other.decision = Decision::margin;
  other.distance_threshold.reset();
  CHECK(recognized_windows(query_all(walks, other)) > 10);
}

TEST_CASE("words decide between frames that look alike") {
  // All training frames have the same image: distances carry no information.
  const std::vector<std::vector<LdbCode>> train = {
      std::vector<LdbCode>(40, test::walk_codes(1, 1).front())};
  Walks walks;
  walks.database = test::make_database(train);
  ensure_statistics(walks.database, {});
  FabmapDatabase fabmap = test::make_fabmap(walks.database);
  std::vector<WordSet> words;
  for (const LdbCode& code : test::walk_codes(40, 9, 300)) words.push_back(test::words_of(code));
  fabmap.views = {};
  fabmap.groups.clear();
  add_group(fabmap, {walks.database.sequences.front().sequence}, words);
  fabmap.tree = train_chow_liu(words, 40, {});
  index_views(fabmap);
  fuse_views(walks.database, std::move(fabmap), "f");
  walks.query = test::make_query(train.front());
  walks.query.words = words;
  const Result result = query_all(walks, fused_settings(3), 50);
  for (size_t window = 0; window < result.best.size(); ++window)
    CHECK(result.best[window]->train == window);
}

TEST_CASE("databases of other sequences are refused for fusion") {
  Walks walks;
  const auto refused = [&](const auto& change) {
    FabmapDatabase fabmap = test::make_fabmap(walks.database);
    change(fabmap);
    return test::error_kind([&] { fuse_views(walks.database, std::move(fabmap), "f"); });
  };
  CHECK_FALSE(refused([](FabmapDatabase&) {}));
  CHECK(refused([](FabmapDatabase& f) { f.groups[1].sequence.name = "other"; }) == ErrorKind::data);
  CHECK(refused([](FabmapDatabase& f) { f.groups[1].sequence.frame_names[4] = "x"; }) ==
        ErrorKind::data);
  CHECK(refused([](FabmapDatabase& f) {
          --f.groups[1].sequence.frames;
          f.groups[1].sequence.frame_names.pop_back();
        }) == ErrorKind::data);
  CHECK(refused([](FabmapDatabase& f) { f.groups[0].sequence.unreadable = {31}; }) ==
        ErrorKind::data);
  // There are groups with other names, and frames of a place are views as well.
  CHECK_FALSE(refused([](FabmapDatabase& f) {
    FabmapDatabase more;
    more.tree = f.tree;
    more.vocabulary = f.vocabulary;
    add_group(more, {{"elsewhere", 1, {"0"}}}, std::vector<WordSet>{{1, 2}});
    size_t view = 0;
    for (ViewGroup group : f.groups) {
      std::vector<WordSet> words;
      for (size_t i = 0; i < group.sequence.frames; ++i, ++view)
        words.emplace_back(f.views.view(view).begin(), f.views.view(view).end());
      group.is_place = true;
      add_group(more, group, words);
    }
    index_views(more);
    f = more;
  }));
  CHECK(query_all(walks, fused_settings(5)).best[14]->train == 7);

  const auto rejects = [&](const SequenceQuerySettings& settings) {
    const QueryResources resources;
    return test::error_kind(
        [&] { plan_query(walks.database, walks.query, "q", settings, resources, {}); });
  };
  const SequenceQuerySettings settings = fused_settings(5);
  CHECK_FALSE(rejects(settings));
  walks.database.statistics->fused.reset();
  CHECK(rejects(settings) == ErrorKind::usage);
}
