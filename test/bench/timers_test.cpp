#include <catch2/catch.hpp>

#include "bench/benches.h"
#include "bench/generated.h"
#include "support.h"

using namespace vpr;
using namespace vpr::test;

namespace {

MatchingBenchSettings small_settings() {
  MatchingBenchSettings settings;
  settings.methods = {"fastable-online", "fastable", "zscore", "filter", "openable", "lsh"};
  settings.databases = {30, 500};
  settings.window_lengths = {1, 20};
  settings.query_frames = {25};
  settings.clustered_recognitions = 1000;
  settings.seconds = 1e-3;
  return settings;
}

}  // namespace

TEST_CASE("every method has a row for every case") {
  const MatchingBenchSettings settings = small_settings();
  const BenchResult result = bench_matching(settings, {}, 1, {});
  CHECK(result.left_out.empty());
  REQUIRE(result.rows.size() == 4 * settings.methods.size() + 1);
  for (const BenchRow& row : result.rows) {
    CHECK(row.time.median_ms > 0);
    CHECK(row.time.repetitions >= 5);
  }
  const BenchRow* fast =
      find_row(result, "fastable", {{"frames", 500}, {"c_l", 20}, {"query_frames", 25}});
  const BenchRow* slow =
      find_row(result, "openable", {{"frames", 500}, {"c_l", 20}, {"query_frames", 25}});
  REQUIRE((fast != nullptr && slow != nullptr));
  CHECK(find_number(fast->values, "times_openable") == slow->time.median_ms / fast->time.median_ms);
  CHECK(find_row(result, "fastable-online", result.rows.front().parameters) ==
        &result.rows.front());
  CHECK(find_row(result, "fastable", {{"frames", 3}}) == nullptr);
}

TEST_CASE("a window that exceeds the frames is omitted and reported") {
  MatchingBenchSettings settings = small_settings();
  settings.window_lengths = {25, 5};
  const BenchResult result = bench_matching(settings, {}, 1, {});
  CHECK(result.left_out.size() == 2);
  settings.databases = {};
  CHECK(error_kind([&] { bench_matching(settings, {}, 1, {}); }) == ErrorKind::usage);
}

TEST_CASE("nothing is timed if a distance is wrong") {
  const auto train = generate_sequence(100, 1);
  const auto query = repeat_sequence(train, 0, 50, 30, 2);
  MatchingCase example = make_case(train, query, {5, size_t{1} << 30});
  CHECK(!error_kind([&] { check_methods(example, {"fastable-online"}, {}); }));
  example.distances.of_query = [right = example.distances.of_query](const DescribedFrames& frames) {
    FrameDistances wrong = right(frames);
    wrong.tile = [tile = wrong.tile](auto queries, size_t first, size_t last, uint16_t* out,
                                     size_t stride) {
      tile(queries, first, last, out, stride);
      for (size_t i = 0; i < last - first; ++i) ++out[i];
    };
    return wrong;
  };
  CHECK(error_kind([&] { check_methods(example, {"fastable-online"}, {}); }) ==
        ErrorKind::expectation);
}

TEST_CASE("recorded codes are timed up to the length of the recording") {
  MatchingBenchSettings settings = small_settings();
  settings.methods = {"fastable-online", "lsh"};
  settings.databases = {40, 100};
  settings.window_lengths = {5};
  settings.clustered_recognitions = 0;
  const auto walk = generate_sequence(60, 1);
  const RecordedCodes recorded{walk, repeat_sequence(walk, 10, 25, 5, 2)};
  const BenchResult result = bench_matching(settings, recorded, 1, {});
  CHECK(result.left_out.size() == 1);
  REQUIRE(result.rows.size() == 2);
  CHECK(result.rows[1].work == "lsh");
  CHECK(find_number(result.rows[1].values, "recall") == 1);  // 5 bits differ
}

TEST_CASE("a database that exceeds the memory is omitted") {
  MatchingBenchSettings settings = small_settings();
  settings.methods = {"fastable-online"};
  settings.databases = {50'000'000};
  settings.descriptor_length = 4096;  // 800 GB
  settings.window_lengths = {5};
  settings.clustered_recognitions = 0;
  const BenchResult result = bench_matching(settings, {}, 1, {});
  CHECK(result.rows.empty());
  REQUIRE(result.left_out.size() == 1);
  CHECK(has(result.left_out[0], "MiB"));
}

TEST_CASE("FAB-MAP's variants are timed for every number of places") {
  FabmapBenchSettings settings;
  settings.place_counts = {1, 50};
  settings.words = {300};
  settings.words_per_frame = {20};
  settings.pretrain_frames = 40;
  settings.descriptors = 500;
  settings.seconds = 1e-3;
  const BenchResult result = bench_fabmap(settings, 1, {});
  CHECK(result.rows.size() == 2 + 2 * (settings.variants.size() + 3));
  for (const uint64_t places : settings.place_counts)
    for (const char* work : {"posterior", "new place", "query"}) {
      const BenchRow* row =
          find_row(result, work, {{"places", places}, {"words", 300}, {"words_per_frame", 20}});
      REQUIRE(row != nullptr);
      CHECK(row->time.repetitions >= 5);
    }
  settings.slow_limit = 0;
  CHECK(bench_fabmap(settings, 1, {}).left_out.size() == 2 * 3);
}

TEST_CASE("FAB-MAP's frames per second include the time of a frame's features") {
  FabmapBenchSettings settings;
  settings.variants = {"fabmap1"};
  settings.place_counts = {1};
  settings.words = {300};
  settings.words_per_frame = {20};
  settings.pretrain_frames = 40;
  settings.descriptors = 0;
  settings.seconds = 1e-3;
  settings.frame_ms = 100;
  const BenchResult result = bench_fabmap(settings, 1, {});
  const BenchRow* row =
      find_row(result, "fabmap1", {{"places", 1}, {"words", 300}, {"words_per_frame", 20}});
  REQUIRE(row != nullptr);
  const double fps = 1000 / (100 + row->time.median_ms);
  CHECK(find_number(row->values, "fps") == fps);
  REQUIRE(result.charts.size() == 2);
  CHECK(result.charts[1].file == "fabmap-fps");
  CHECK(result.charts[1].series[0].points[0].second == Approx(fps));
  settings.frame_ms = -1;
  CHECK_THROWS_AS(bench_fabmap(settings, 1, {}), Error);
}

TEST_CASE("vectors are timed by the methods that accept any distances, after a check of cells") {
  for (const uint64_t precision : {8, 16}) {
    MatchingBenchSettings settings = small_settings();
    settings.methods = {"fastable-online", "fastable", "zscore", "openable", "lsh"};
    settings.descriptor_length = 40;
    settings.precision = precision;
    const BenchResult result = bench_matching(settings, {}, 1, {});
    const auto has = [&](const char* work) {
      return std::any_of(result.rows.begin(), result.rows.end(),
                         [&](const BenchRow& row) { return row.work == work; });
    };
    for (const char* work : {"fastable-online", "fastable", "zscore", "openable"}) CHECK(has(work));
    CHECK_FALSE(has("lsh"));
  }
  MatchingBenchSettings settings = small_settings();
  settings.precision = 12;
  CHECK(error_kind([&] { bench_matching(settings, {}, 1, {}); }) == ErrorKind::usage);
}

TEST_CASE("generated vectors form a sequence, and the same sequence with other noise") {
  const GeneratedVectors walk = generate_vectors(60, 64, 16, 1, 2);
  const GeneratedVectors again = generate_vectors(20, 64, 16, 1, 3, 15);
  REQUIRE(walk.rows().size() == 60);
  for (size_t q = 0; q < 20; ++q) {
    size_t best = 0;
    for (size_t i = 1; i < 60; ++i)
      if (distance_of(ElementType::int16).pair(again.rows()[q], walk.rows()[i]) <
          distance_of(ElementType::int16).pair(again.rows()[q], walk.rows()[best]))
        best = i;
    CHECK(best == q + 15);
  }
}
