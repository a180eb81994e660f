// A query frame by frame has the results of the whole query for every window.
#include "query/live_query.h"

#include <algorithm>

#include <catch2/catch.hpp>

#include "examples.h"
#include "queries.h"
#include "query/prepare.h"
#include "query/thresholds.h"
#include "query/train_sequences.h"
#include "support.h"

using namespace vpr;

namespace {

/// Two sequences, and a query through part of the first one with a stop, then through the second
/// one; some frames are unreadable.
struct Walks {
  SequenceDatabase database;
  DescriptorSet query;

  explicit Walks(size_t sequences = 2, int changed_bits = 60) {
    std::vector<std::vector<LdbCode>> train = {test::walk_codes(60, 1, changed_bits),
                                               test::walk_codes(70, 2, changed_bits)};
    train.resize(sequences);
    std::vector<LdbCode> codes = test::walk_codes(8, 3, changed_bits);
    const auto append = [&](const std::vector<LdbCode>& from, size_t first, size_t count) {
      codes.insert(codes.end(), from.begin() + first, from.begin() + first + count);
    };
    append(train[0], 10, 40);
    codes.insert(codes.end(), 30, codes.back());  // a stop
    append(train.back(), 5, 50);
    database = test::make_database(train);
    ensure_statistics(database, {});
    for (size_t length : {1, 6})
      database.thresholds.push_back(compute_thresholds(descriptor_spans(database), length, 1, {}));
    for (const size_t frame : {20, 21, 90}) {
      codes[frame] = {};
      gaps.push_back(frame);
    }
    query = test::make_query(codes);
    query.sequence.unreadable = gaps;
  }

  std::vector<size_t> gaps;
};

std::vector<Match> recognitions_of(const Result& whole, size_t window) {
  std::vector<Match> recognitions;
  for (const Match& recognition : whole.recognitions)
    if (recognition.query == window) recognitions.push_back(recognition);
  return recognitions;
}

void check_window(const LiveAnswer& live, const Result& whole, size_t window) {
  INFO("window " << window);
  CHECK(live.best == whole.best[window]);
  CHECK(live.margin == frame_margin(whole, window));
  CHECK(live.recognized == recognitions_of(whole, window));
}

// The part of the result that is known when the frame arrives.
void check_path(const LiveAnswer& live, const Result& whole, size_t frame) {
  CHECK(live.rate == whole.path->rates[frame]);
  REQUIRE(live.best);
  CHECK(live.best->query == frame);
}

// Returns the number of recognized windows.
size_t check_live_query(const Walks& walks, const SequenceQuerySettings& settings) {
  const Result whole = test::query_result(walks.database, walks.query, settings);
  LiveQuery query(walks.database, "q", settings, {}, {});
  const DescriptorRows rows = walks.query.rows();
  const size_t length = whole.window_length();
  std::vector<Match> decided;
  const auto decide = [&](const LiveAnswer& live, size_t frame) {
    for (const Match& match : live.recognized) {
      CHECK(whole.path->decided[match.query] == frame);
      decided.push_back(match);
    }
  };
  for (size_t frame = 0; frame < rows.size(); ++frame) {
    INFO("frame " << frame);
    const bool is_gap = std::find(walks.gaps.begin(), walks.gaps.end(), frame) != walks.gaps.end();
    const std::optional<LiveAnswer> live = query.take({rows[frame], !is_gap});
    if (live && whole.path) {
      check_path(*live, whole, frame);
      decide(*live, frame);
    } else if (live) {
      check_window(*live, whole, frame + 1 - length);
    } else if (frame + 1 >= length) {
      CHECK_FALSE(whole.best[frame + 1 - length]);
    }
  }
  if (const std::optional<LiveAnswer> end = query.finish()) decide(*end, rows.size() - 1);
  if (whole.path) CHECK(decided == whole.recognitions);
  return recognized_windows(whole);
}

}  // namespace

TEST_CASE("live frames have the results of the whole query: thresholds of distances") {
  const Walks two;
  CHECK(check_live_query(two, test::by_threshold(6)) > 40);  // automatic threshold in bits
  SequenceQuerySettings settings{Threshold{{"fastable-online", 6}}};
  settings.only_sequences = {"b"};
  CHECK(check_live_query(two, settings) > 30);
  settings.rule = Threshold{{"fastable-online", 1}, 300, ThresholdScale::bits};
  CHECK(check_live_query(two, settings) > 30);
}

TEST_CASE("live frames have the results of the whole query: margins, scores and the filter") {
  const Walks walks;
  CHECK(check_live_query(walks, test::by_margin(6)) > 40);
  SequenceQuerySettings settings{Margin{{.window_length = 6, .score = Score::zscore}}};
  CHECK(check_live_query(walks, settings) > 40);
  settings.only_sequences = {"a"};
  CHECK(check_live_query(walks, settings) > 1);
  SequenceQuerySettings filter{Filter{}};
  const Walks sparse(2, 100);
  CHECK(check_live_query(sparse, filter) > 30);
  filter.only_sequences = {"b"};  // the first sequence is not searched
  CHECK(check_live_query(sparse, filter) > 10);
}

TEST_CASE("a stop of any length keeps at most as many frames as pending keyframes") {
  const Walks walks;
  const FrameDistances raw =
      frame_distances(descriptor_spans(walks.database), {walks.query.rows().first(0), {}});
  LiveScores live = start_live(raw, stages_of({Filter{}}, &*walks.database.statistics));
  const DescriptorRows rows = walks.query.rows();
  size_t most = 0;
  for (size_t frame = 0; frame < rows.size(); ++frame) {
    add_frame(live, {rows[frame]});
    live.scores.start_row(live.last_row());
    most = std::max(most, live.scores.query_frames);
  }
  CHECK(live.frames == rows.size());
  CHECK(most == kKeyframeLag + 1);
}
