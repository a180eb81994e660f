#include <map>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "examples.h"
#include "match/fastable.h"
#include "match/match.h"
#include "match/zscores.h"
#include "support.h"

using namespace vpr;

namespace {

/// Sum and rate of a cell.
using RatedCells = std::map<test::CellKey, std::pair<uint32_t, uint8_t>>;

const std::vector<Rate> kRates = {{1, 2}, {2, 3}, {1, 1}, {3, 2}, {2, 1}};

MatchSettings settings_of(size_t length, std::vector<Rate> rates) {
  MatchSettings settings;
  settings.window_length = length;
  settings.rates = std::move(rates);
  return settings;
}

// z or distance of every pair of frames, row by row.
std::vector<std::vector<uint16_t>> all_pairs(const FrameDistances& distances) {
  std::vector<std::vector<uint16_t>> pairs;
  for (uint32_t query = 0; query < distances.query_frames; ++query) {
    auto& row = pairs.emplace_back(distances.train_frames + kBlockFrames);
    if (distances.start_row) distances.start_row(query);
    distances.tile({&query, 1}, 0, distances.train_frames, row.data(), 0);
  }
  return pairs;
}

// Computes every sum directly.
RatedCells reference_rates(const std::vector<std::vector<uint16_t>>& pairs,
                           const FrameDistances& frames, size_t length,
                           const std::vector<Rate>& rates) {
  RatedCells cells;
  for (const FrameStretch& query : frames.query_runs)
    for (size_t j = query.first + length - 1; j < query.first + query.count; ++j)
      for (const FrameStretch& train : frames.train_runs)
        for (size_t i = train.first + length - 1; i < train.first + train.count; ++i)
          for (size_t r = 0; r < rates.size(); ++r) {
            uint32_t sum = 0;
            bool fits = true;
            for (size_t m = 0; m < length && fits; ++m) {
              // k p / q rounded to nearest, ties up.
              const size_t o = (2 * m * rates[r].train + rates[r].query) / (2 * rates[r].query);
              fits = i >= train.first + o;
              if (fits) sum += pairs[j - m][i - o];
            }
            if (!fits) continue;
            const test::CellKey key{j + 1 - length, train.sequence,
                                    train.first_in_sequence + (i - train.first) + 1 - length};
            const auto [cell, is_new] = cells.try_emplace(key, sum, static_cast<uint8_t>(r));
            if (!is_new && sum < cell->second.first) cell->second = {sum, static_cast<uint8_t>(r)};
          }
  return cells;
}

void add_row(RatedCells& cells, const ScoreRow& row) {
  REQUIRE(row.rates.size() == row.scores.size());
  for (size_t x = 0; x < row.scores.size(); ++x) {
    const test::CellKey key{row.query_window, row.sequence, row.train_window + x};
    REQUIRE(cells.emplace(key, std::pair(row.scores[x], row.rates[x])).second);
  }
}

RatedCells fast_rates(const FrameDistances& distances, const MatchSettings& settings) {
  RatedCells cells;
  match(distances, settings, {{[&](const ScoreRow& row) { add_row(cells, row); }}}, {});
  return cells;
}

test::Example gappy_example(uint64_t seed) {
  test::Example example = test::make_example({40, 3, 0, 27}, 33, seed);
  example.train_unreadable[0] = {17};
  example.query_unreadable = {11};
  return example;
}

}  // namespace

TEST_CASE("a rate of 1/2, computed by hand") {
  // Numbers of differing bits: training frames have 0, 1, 2 set bits, query frames none.
  std::vector<LdbCode> train(3);
  std::vector<LdbCode> query(4);
  DescriptorSet shown = test::make_query(train);
  for (size_t i = 0; i < 3; ++i)
    for (size_t bit = 0; bit < i; ++bit) shown.descriptors.owned[i * kLdbBytes] |= 1 << bit;
  const DescribedFrames spans[] = {shown.span()};
  const DescriptorSet asked = test::make_query(query);
  const FrameDistances distances = frame_distances(spans, asked.span());
  // Windows of three frames that end at training frame 2: offsets 0, 1 (0.5 up), 1.
  const RatedCells cells = fast_rates(distances, settings_of(3, {{1, 2}}));
  CHECK(cells == RatedCells{{{0, 0, 0}, {2 + 1 + 1, 0}}, {{1, 0, 0}, {2 + 1 + 1, 0}}});
  CHECK(rate_offset({1, 2}, 1) == 1);
  CHECK(rate_offset({1, 2}, 2) == 1);
  CHECK(rate_offset({1, 2}, 3) == 2);
  CHECK(rate_span({3, 2}, 3) == 4);
}

TEST_CASE("windows of several rates equal direct sums, and rate 1 is FastABLE") {
  for (const uint64_t seed : {1, 2, 3}) {
    const test::Example example = gappy_example(seed);
    const std::vector<DescribedFrames> spans = example.spans();
    const DescribedFrames query{example.query, example.query_unreadable};
    const FrameDistances distances = frame_distances(spans, query);
    const auto pairs = all_pairs(distances);
    for (const size_t length : {1, 2, 3, 5, 8, 11}) {
      INFO("seed " << seed << ", c_l " << length);
      const RatedCells fast = fast_rates(distances, settings_of(length, kRates));
      CHECK(fast == reference_rates(pairs, distances, length, kRates));
      CHECK(fast_rates(distances, settings_of(length, {{5, 16}, {16, 5}})) ==
            reference_rates(pairs, distances, length, {{5, 16}, {16, 5}}));
      RatedCells one;
      MatchSettings online = settings_of(length, {});
      online.method = &find_sequence_method("fastable-online");
      const auto collect = [&](const ScoreRow& row) {
        for (size_t x = 0; x < row.scores.size(); ++x)
          one[{row.query_window, row.sequence, row.train_window + x}] = {row.scores[x], 0};
      };
      match(distances, online, {{collect}}, {});
      CHECK(fast_rates(distances, settings_of(length, {{1, 1}})) == one);
    }
  }
}

TEST_CASE("z-scores support rates, and several lengths share a pass") {
  const test::Example example = gappy_example(4);
  const std::vector<DescribedFrames> spans = example.spans();
  const DescribedFrames query{example.query, example.query_unreadable};
  size_t frames = 0;
  for (const DescribedFrames& span : spans) frames += span.rows.size();
  ScoreBasis basis;
  basis.typical_distance = 60;
  basis.mean.assign(frames, 1);
  basis.variance = 900;
  const auto scores = [&] { return zscores(frame_distances(spans, query), basis, {}); };
  const auto pairs = all_pairs(scores());
  const std::vector<size_t> lengths = {2, 5, 9};
  std::vector<RatedCells> fast(lengths.size());
  std::vector<Pass> passes;
  for (size_t l = 0; l < lengths.size(); ++l)
    passes.push_back({lengths[l], {{[&, l](const ScoreRow& row) { add_row(fast[l], row); }}}});
  match(scores(), settings_of(1, kRates), passes, {});
  for (size_t l = 0; l < lengths.size(); ++l)
    CHECK(fast[l] == reference_rates(pairs, scores(), lengths[l], kRates));
}

TEST_CASE("only the window with its rate follows a sequence at another speed") {
  const std::vector<LdbCode> train = test::walk_codes(120, 9, 90);
  std::vector<LdbCode> query;
  for (size_t k = 0; k < 40; ++k) query.push_back(train[20 + (3 * k + 1) / 2]);
  const DescriptorSet trained = test::make_query(train);
  const DescriptorSet asked = test::make_query(query);
  const DescribedFrames spans[] = {trained.span()};
  const RatedCells cells =
      fast_rates(frame_distances(spans, asked.span()), settings_of(20, kRates));
  std::pair<uint32_t, test::CellKey> best{UINT32_MAX, {}};
  for (const auto& [key, cell] : cells)
    if (std::get<0>(key) == 20) best = std::min(best, {cell.first, key});
  // The last frame of query window 20 is frame 39, which shows training frame 20 + 59.
  CHECK(best.first == 0);
  CHECK(std::get<2>(best.second) + 19 == 79);
  CHECK(cells.at(best.second).second == 3);  // 3/2
}

TEST_CASE("invalid rates, and rates that exceed the memory, are refused") {
  CHECK(parse_rate("2/4") == Rate{1, 2});
  CHECK(parse_rate("16") == Rate{16, 1});
  for (const char* text : {"", "0", "1/0", "17", "1/17", "-1", "1.5", "1/2/3", "a", "1/", "/2"}) {
    INFO(text);
    CHECK(test::error_kind([&] { parse_rate(text); }) == ErrorKind::usage);
  }
  CHECK(test::error_kind([] {
          parse_rates(std::vector<std::string>{"1", "2/2"});
        }) == ErrorKind::usage);
  const test::Example example = gappy_example(1);
  const std::vector<DescribedFrames> spans = example.spans();
  const FrameDistances distances = frame_distances(spans, {example.query, {}});
  MatchSettings settings = settings_of(5, kRates);
  settings.memory_limit = 100;
  CHECK(test::has(test::error_text([&] { fast_rates(distances, settings); }), "--max-memory"));
}
