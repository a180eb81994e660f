// What several processes find together is what one finds: the slow twin is the run of one.
#include <atomic>
#include <functional>
#include <map>
#include <mutex>
#include <optional>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "examples.h"
#include "matching/train_part.h"
#include "pipeline/query.h"
#include "pipeline/score_basis.h"
#include "pipeline/thresholds.h"
#include "pipeline/train.h"
#include "support.h"
#include "together.h"

using namespace vpr;

namespace {

constexpr size_t kMostProcesses = 7;

struct Walks {
  SequenceDatabase database;
  DescriptorSet query;
};

// A long sequence with a frame that can't be read, one that is shorter than a window, and two of
// the same place; the query goes through two of them.
Walks make_walks() {
  std::vector<std::vector<LdbCode>> train = {test::walk_codes(90, 1), test::walk_codes(3, 2),
                                             test::walk_codes(41, 3)};
  train.push_back(train[2]);
  std::vector<LdbCode> query = test::walk_codes(40, 4);
  std::copy_n(train[0].begin() + 30, 18, query.begin());
  std::copy_n(train[2].begin() + 5, 15, query.begin() + 22);
  Walks walks{test::make_database(train), test::make_query(query)};
  walks.database.sequences[0].unreadable = {37};
  walks.query.frames.unreadable = {20};
  ensure_statistics(walks.database, {});
  return walks;
}

QueryRun run_of(const Walks& walks, const SequenceQuerySettings& settings, const Share& share,
                size_t memory_limit = kDefaultMemoryLimit) {
  const QueryResources resources{select_kernels(), memory_limit, 0, 1, share};
  return run_query(plan_query(walks.database, walks.query, "q", settings, resources, {}), resources,
                   {}, {});
}

void check_same(const Result& found, const Result& expected) {
  CHECK(found.hits == expected.hits);
  CHECK(found.best == expected.best);
  CHECK(found.margins == expected.margins);
  for (size_t s = 0; s < expected.targets.size(); ++s) {
    CHECK(found.targets[s].max_distance == expected.targets[s].max_distance);
    CHECK(found.targets[s].threshold == expected.targets[s].threshold);
  }
}

void check_all_counts(const Walks& walks, const SequenceQuerySettings& settings) {
  const QueryRun expected = run_of(walks, settings, {});
  CHECK_FALSE(expected.result.hits.empty());
  for (size_t count = 2; count <= kMostProcesses; ++count) {
    std::optional<QueryRun> found;
    test::run_together(count, [&](const Share& share) {
      QueryRun run = run_of(walks, settings, share);
      if (share.is_first()) found = std::move(run);
    });
    INFO(count << " processes, c_l " << settings.window_length);
    check_same(found->result, expected.result);
  }
}

}  // namespace

TEST_CASE("every window is of one process, which holds its frames") {
  const test::Example example = test::make_example({1, 50, 7, 0, 23}, 10, 1);
  const std::vector<DescriptorSpan> train = example.spans();
  for (const size_t length : {1, 5, 30}) {
    for (size_t count = 1; count <= 90; count += 8) {
      std::map<std::pair<size_t, size_t>, size_t> seen;
      for (size_t index = 0; index < count; ++index) {
        const TrainPart part = own_windows(train, length, Share{index, count});
        for (size_t s = 0; s < train.size(); ++s) {
          for (size_t i = part.own[s].first; i < part.own[s].last; ++i) {
            ++seen[{s, i}];
            const bool is_window = i + length <= train[s].rows.size();
            CHECK((!is_window || (part.held[s].first <= i && i + length <= part.held[s].last)));
          }
          CHECK(part.held[s].count() <= part.own[s].count() + length - 1);
        }
      }
      CHECK(seen.size() == 81);
      for (const auto& [frame, times] : seen) CHECK(times == 1);
    }
  }
}

TEST_CASE("several processes find what one finds by distances") {
  const Walks walks = make_walks();
  SequenceQuerySettings settings;
  for (const uint64_t length : {1, 4, 11}) {
    settings.window_length = length;
    settings.distance_threshold = 0.4;
    for (const char* method : {"fastable", "fastable-online", "openable"}) {
      settings.method = method;
      check_all_counts(walks, settings);
    }
    settings.distance_threshold = std::nullopt;
    if (length > 1) check_all_counts(walks, settings);
  }
}

TEST_CASE("several processes find what one finds by standardized scores and margins") {
  const Walks walks = make_walks();
  for (const Score score : {Score::raw, Score::standardized, Score::standardized_offline}) {
    SequenceQuerySettings settings;
    settings.score = score;
    settings.window_length = 4;
    settings.decision = Decision::margin;
    settings.margin_width = 6;
    settings.margin = 0.05;
    check_all_counts(walks, settings);
    settings.margin = std::nullopt;
    settings.only_sequences = {"a", "c"};
    check_all_counts(walks, settings);
  }
}

TEST_CASE("hits of several processes are too many together as they are of one") {
  const Walks walks = make_walks();
  SequenceQuerySettings settings;
  settings.window_length = 4;
  settings.distance_threshold = 0.9;
  constexpr size_t kBytesAHit = 64;
  const size_t hits = run_of(walks, settings, {}).result.hits.size();
  for (const bool is_enough : {true, false}) {
    const size_t memory = kBytesAHit * (is_enough ? hits : hits - 1);
    size_t refused = 0;
    std::mutex mutex;
    test::run_together(3, [&](const Share& share) {
      try {
        run_of(walks, settings, share, memory);
      } catch (const Error& error) {
        const std::lock_guard lock(mutex);
        refused += error.kind() == ErrorKind::usage ? 1 : 0;
      }
    });
    CHECK(refused == (is_enough ? 0 : 3));
  }
}

TEST_CASE("several processes refuse what they can't share, and inputs that differ") {
  const Walks walks = make_walks();
  const auto refused = [&](const std::function<void(const Share&)>& work) {
    std::atomic<size_t> errors = 0;
    test::run_together(2, [&](const Share& share) {
      try {
        work(share);
      } catch (const Error& error) {
        errors += error.kind() == ErrorKind::usage ? 1 : 0;
      }
    });
    return errors.load();
  };
  SequenceQuerySettings rated;
  rated.rates = {"1/2", "1"};
  rated.distance_threshold = 0.4;
  CHECK(refused([&](const Share& share) { run_of(walks, rated, share); }) == 2);
  CHECK(refused([](const Share& share) { check_same(share, "arguments", "--c-l 10"); }) == 0);
  CHECK(refused([](const Share& share) {
          check_same(share, "arguments", share.is_first() ? "--c-l 10" : "--c-l 1");
        }) == 1);  // the first process says so, and its next step ends the others
}
