// Codes, distances, scores, words and posteriors of a small recording, frame by frame, compared
// with checksums in files: the same for every SIMD target, method and number of threads.
#include <cmath>
#include <map>
#include <mutex>
#include <tuple>

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "base/parallel.h"
#include "database/whole_frame.h"
#include "fabmap/chow_liu.h"
#include "fabmap/model.h"
#include "fabmap/place_query.h"
#include "fabmap/vocabulary.h"
#include "golden/checksums.h"
#include "golden/recording.h"
#include "query/prepare.h"
#include "query/run_query.h"
#include "support.h"

using namespace vpr;
using namespace vpr::test;

namespace {

constexpr uint64_t kWindow = 4;
constexpr size_t kUnreadable = 9;  // of the query

// Calls body once for each SIMD target and number of threads.
template <class Body>
void for_each_setting(Body&& body) {
  for (const std::string& target : simd_targets()) {
    const ChosenTarget chosen(target);
    for (const size_t threads : {1, 2, 5}) {
      INFO(target << ", " << threads << " threads");
      const ThreadLimit limit(threads);
      body();
    }
  }
}

std::vector<LdbCode> describe(const Walk& walk) {
  std::vector<LdbCode> codes;
  for (size_t frame = 0; frame < walk.frames; ++frame)
    codes.push_back(describe_ldb(draw_frame(walk, frame)));
  return codes;
}

std::vector<std::string> frame_names(const Walk& walk) {
  std::vector<std::string> names;
  for (size_t frame = 0; frame < walk.frames; ++frame)
    names.push_back(fmt::format("{} {}", walk.name, frame));
  return names;
}

SequenceDatabase make_database() {
  SequenceDatabase database;
  for (const Walk& walk : kTrain) {
    database.sequences.push_back({{walk.name, walk.frames, frame_names(walk)}});
    const std::vector<LdbCode> codes = describe(walk);
    database.descriptors.append(codes);
  }
  ensure_statistics(database, {});
  return database;
}

DescriptorSet make_query() {
  std::vector<LdbCode> codes = describe(kQuery);
  codes[kUnreadable] = {};
  DescriptorSet query;
  query.descriptors.append(codes);
  query.sequence = {"", codes.size(), frame_names(kQuery), {kUnreadable}};
  return query;
}

// One entry per query window, with its row of distances or biased scores.
std::vector<FrameChecksum> window_rows(const SequenceQuerySettings& settings) {
  const SequenceDatabase database = make_database();
  const DescriptorSet query = make_query();
  QueryResources resources;
  std::mutex mutex;
  std::map<std::tuple<size_t, size_t, size_t>, uint32_t> cells;
  const RowConsumer collect = [&](const ScoreRow& row) {
    const std::lock_guard lock(mutex);
    for (size_t x = 0; x < row.scores.size(); ++x)
      cells[{row.query_window, row.sequence, row.train_window + x}] = row.scores[x];
  };
  run_query(
      plan_query(prepare(database, settings, resources), query, "back", settings, resources, {}),
      {{collect}}, {});
  std::map<size_t, std::vector<uint32_t>> rows;
  for (const auto& [key, value] : cells) rows[std::get<0>(key)].push_back(value);
  std::vector<FrameChecksum> lines;
  for (const auto& [window, row] : rows)
    lines.push_back({fmt::format("window {}", window), short_checksum(row)});
  return lines;
}

SequenceQuerySettings settings_with(const std::string& method, Score score) {
  return {Threshold{{method, kWindow, score}, score == Score::raw ? 0.3 : -1}};
}

// The words are squares of pretraining frames: every other square of every fourth frame.
Vocabulary make_words() {
  cv::Mat words;
  for (size_t frame = 0; frame < kPretrain.frames; frame += 4) {
    const cv::Mat features = square_features(draw_frame(kPretrain, frame));
    for (int i = static_cast<int>(frame); i < features.rows; i += 2)
      words.push_back(features.row(i));
  }
  return make_vocabulary(words);
}

std::vector<WordSet> words_of(const Walk& walk, const Vocabulary& vocabulary) {
  std::vector<WordSet> frames;
  for (size_t frame = 0; frame < walk.frames; ++frame)
    frames.push_back(quantize(vocabulary, square_features(draw_frame(walk, frame))));
  return frames;
}

FabmapDatabase make_fabmap_database(const Vocabulary& vocabulary) {
  FabmapDatabase database;
  database.vocabulary = vocabulary.words;
  const std::vector<WordSet> pretrain = words_of(kPretrain, vocabulary);
  database.tree = train_chow_liu(pretrain, static_cast<size_t>(vocabulary.words.rows), {});
  for (const WordSet& frame : pretrain) database.pretrain.add(frame);
  for (const Walk& walk : kTrain)
    add_group(database, {{walk.name, walk.frames, frame_names(walk)}}, words_of(walk, vocabulary));
  index_views(database);
  return database;
}

// In millionths: on other machines, logarithms and exponentials may differ in the last digits.
std::string posterior_checksum(std::span<const double> posterior) {
  std::vector<int32_t> millionths;
  for (const double p : posterior) millionths.push_back(static_cast<int32_t>(std::lround(p * 1e6)));
  return short_checksum(millionths);
}

std::vector<FrameChecksum> posteriors(const FabmapDatabase& database, const SequenceWords& query,
                                      const std::string& variant) {
  FabmapQuerySettings settings;
  settings.variant = variant;
  std::vector<FrameChecksum> lines;
  query_fabmap(
      database, query, "back", settings, 1,
      [&](size_t frame, std::span<const double> posterior) {
        if (!posterior.empty())
          lines.push_back({query.sequence.frame_names[frame], posterior_checksum(posterior)});
      },
      {});
  return lines;
}

}  // namespace

TEST_CASE("codes of a small recording equal the golden file") {
  std::vector<FrameChecksum> lines;
  for (const Walk& walk : {kTrain[0], kTrain[1], kQuery}) {
    const std::vector<LdbCode> codes = describe(walk);
    for (size_t frame = 0; frame < walk.frames; ++frame)
      lines.push_back({frame_names(walk)[frame],
                       short_checksum(std::vector(codes[frame].begin(), codes[frame].end()))});
  }
  check_golden("codes", "Frame: its LDB code.", lines);
}

TEST_CASE("distances of its windows equal the golden file, for every exact method") {
  for_each_setting([] {
    for (const SequenceMethod& method : exact_methods()) {
      INFO(method.name);
      check_golden("distances", "Query window of 4 frames: its distances to all training windows.",
                   window_rows(settings_with(std::string(method.name), Score::raw)));
    }
  });
}

TEST_CASE("z-scores of its windows equal the golden file") {
  for_each_setting([] {
    check_golden("zscore", "Query window of 4 frames: z-scores, biased as matchers give them.",
                 window_rows(settings_with("fastable", Score::zscore)));
  });
}

TEST_CASE("FAB-MAP's words and posteriors equal the golden files") {
  for_each_setting([] {
    const Vocabulary vocabulary = make_words();
    const FabmapDatabase database = make_fabmap_database(vocabulary);
    std::vector<FrameChecksum> lines;
    for (const Walk& walk : {kPretrain, kTrain[0], kTrain[1], kQuery}) {
      const std::vector<WordSet> words = words_of(walk, vocabulary);
      for (size_t frame = 0; frame < walk.frames; ++frame)
        lines.push_back({frame_names(walk)[frame], short_checksum(words[frame])});
    }
    check_golden("words", "Frame: the ids of its words.", lines);
    const SequenceWords query{{"", kQuery.frames, frame_names(kQuery), {kUnreadable}},
                              words_of(kQuery, vocabulary)};
    for (const FabmapVariant& variant : fabmap_variants()) {
      INFO(variant.name);
      check_golden(fmt::format("posteriors-{}", variant.name),
                   "Frame: its posterior (new place, then views) in millionths.",
                   posteriors(database, query, std::string(variant.name)));
    }
  });
}

TEST_CASE("a mismatch names the first frame that changed and the number of changed frames") {
  const std::vector<FrameChecksum> expected = {{"a 0", "11"}, {"a 1", "22"}, {"a 2", "33"}};
  CHECK(first_change("x", expected, expected) == "");
  auto found = expected;
  found[1].text = "23";
  found[2].text = "34";
  CHECK(has(first_change("x", expected, found),
            "2 of 3 lines changed, the first from \"a 1: "
            "22\" to \"a 1: 23\""));
  found = expected;
  found.pop_back();
  CHECK(has(first_change("x", expected, found),
            "1 of 3 lines changed, the first from \"a 2: "
            "33\" to \"nothing\""));
}
