#include "bench/matching_timers.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "base/named_table.h"
#include "base/stopwatch.h"
#include "bench/filter_timer.h"
#include "matching/components.h"
#include "matching/distance_statistics.h"
#include "matching/fastable_batch.h"
#include "matching/fastable_online.h"
#include "matching/lsh.h"
#include "matching/methods.h"
#include "matching/plain.h"
#include "matching/standardized_frames.h"
#include "pipeline/verify.h"
#include "recognition/row_scan.h"

namespace vpr {
namespace {

constexpr size_t kCheckedCells = 300;

void ignore(const ScoreRow&) {}

// The distances of so many query windows, or all.
FrameDistances first_rows(const MatchingCase& example, size_t rows) {
  const size_t frames = example.settings.window_length + std::min(rows, example.rows()) - 1;
  return example.distances.of_query({example.distances.query.rows.first(frames), {}});
}

std::vector<double> divided(std::vector<double> times_ms, double by) {
  for (double& ms : times_ms) ms /= by;
  return times_ms;
}

void time_online(const MatchingCase& example, const Effort& effort, const Monitor& monitor,
                 BenchRow& row) {
  FastableState state = start_fastable(example.distances, example.settings);
  size_t next = 0;
  const auto advance = [&] {
    advance_fastable(state, example.distances, example.settings.kernels, next);
    next = (next + 1) % example.distances.query_frames;
  };
  // The first windows are shorter, and the ring is not filled yet.
  for (size_t f = 0; f <= example.settings.window_length; ++f) advance();
  row.time = summarise(time_repeatedly(effort, advance, monitor));
  row.values.emplace_back("ring", state.has_ring ? 1 : 0);
}

ScoreBasis score_basis(const MatchingCase& example) {
  TrainStatistics statistics = compute_statistics(example.distances.train, {}, {});
  statistics.components =
      compute_components(example.distances.train, statistics.typical_distance, {});
  return make_score_basis({}, false, statistics);
}

void time_standardized(const MatchingCase& example, const Effort& effort, const Monitor& monitor,
                       BenchRow& row) {
  const Stopwatch watch;
  const ScoreBasis basis = score_basis(example);
  row.values.emplace_back("statistics_s", watch.elapsed_s());
  const auto learning = start_standardized(example.distances, basis, monitor);
  const FrameDistances scores = standardized(learning);
  FastableState state = start_fastable(scores, example.settings);
  size_t next = 0;
  size_t seen = 0;
  size_t learned = 0;
  const auto advance = [&] {
    advance_fastable(state, scores, example.settings.kernels, next);
    learned += learning->update ? 1 : 0;
    ++seen;
    next = (next + 1) % scores.query_frames;
  };
  for (size_t f = 0; f <= example.settings.window_length; ++f) advance();
  row.time = summarise(time_repeatedly(effort, advance, monitor));
  row.values.emplace_back("learned_share",
                          static_cast<double>(learned) / static_cast<double>(seen));
}

void time_filtered(const MatchingCase& example, const Effort& effort, const Monitor& monitor,
                   BenchRow& row) {
  time_filter(example, score_basis(example), effort, monitor, row);
}

void time_batch(const MatchingCase& example, const Effort& effort, const Monitor& monitor,
                BenchRow& row) {
  const auto frames = static_cast<double>(example.distances.query_frames);
  row.time = summarise(
      divided(time_repeatedly(
                  effort, [&] { match_fastable(example.distances, example.settings, {}, ignore); },
                  monitor),
              frames));
}

void time_openable(const MatchingCase& example, const Effort& effort, const Monitor& monitor,
                   BenchRow& row) {
  const auto run = [&](size_t rows) {
    match_openable(first_rows(example, rows), example.settings, {}, ignore);
  };
  // As many rows at once as fit a tenth of the time, for the start of a run costs something too.
  const Stopwatch watch;
  run(1);
  const double share = effort.seconds / 10 / watch.elapsed_s();
  const size_t rows = std::clamp<size_t>(static_cast<size_t>(share), 1, example.rows());
  row.time = summarise(divided(time_repeatedly(
                                   effort, [&] { run(rows); }, monitor),
                               static_cast<double>(rows)));
  if (rows < example.rows()) row.note = fmt::format("{} rows sampled", rows);
}

void time_lsh(const MatchingCase& example, const Effort& effort, const Monitor& monitor,
              BenchRow& row) {
  const size_t length = example.settings.window_length;
  const Stopwatch watch;
  const LshIndex index(example.distances.train, length, example.settings.lsh, example.settings.seed,
                       monitor);
  row.values.emplace_back("build_s", watch.elapsed_s());
  size_t window = 0;
  row.time = summarise(time_repeatedly(
      effort,
      [&] {
        index.find(example.query_codes[window].data());
        window = (window + 1) % example.rows();
      },
      monitor));
  HitScan scan({{0}, example.rows(), 1, example.settings.kernels});
  match_fastable(example.distances, example.settings, monitor, std::ref(scan));
  const auto exact = scan.result().best;
  size_t found = 0;
  for (size_t w = 0; w < example.rows(); ++w) {
    const auto candidates = index.find(example.query_codes[w].data());
    found += std::any_of(candidates.begin(), candidates.end(), [&](const LshCandidate& candidate) {
      return candidate.distance == exact[w]->score;
    });
  }
  row.values.emplace_back("recall",
                          static_cast<double>(found) / static_cast<double>(example.rows()));
}

constexpr std::array<MatchingTimer, 6> kTimers = {{
    {"fastable-online", "one query frame after the other", false, time_online},
    {"fastable", "the whole query at once", false, time_batch},
    {"standardized", "online, standardized scores", false, time_standardized},
    {"filter", "online, over places and rates, of standardized scores", false, time_filtered},
    {"openable", "no re-use, same kernels", false, time_openable},
    {"lsh", "multi-probe hashing, approximate", true, time_lsh},
}};

}  // namespace

MatchingCase::MatchingCase(const std::vector<LdbCode>& train_frames,
                           std::vector<LdbCode> query_frames, const MatchSettings& match)
    : train_codes(train_frames), query_codes(std::move(query_frames)), settings(match) {
  const DescriptorSpan train{train_codes, {}};
  distances = frame_distances({&train, 1}, {query_codes, {}});
}

MatchingCase::MatchingCase(const DescriptorRows& train, const DescriptorRows& query,
                           const MatchSettings& match)
    : settings(match) {
  const DescriptorSpan span{train, {}};
  distances = frame_distances({&span, 1}, {query, {}});
}

std::span<const MatchingTimer> matching_timers() { return kTimers; }

bool has_room_for_scores(const MatchingCase& example) {
  return ring_fits(example.distances.train_frames, example.settings.window_length,
                   example.settings.memory_limit);
}

const MatchingTimer& find_matching_timer(std::string_view name) {
  return find_named(kTimers, "method", name);
}

void add_method_speed_ups(BenchResult& result) {
  for (const char* work : {"fastable-online", "fastable"})
    add_speed_up(result, work, "openable", "times_openable");
  add_speed_up(result, "standardized", "fastable-online", "share_of_fastable_speed");
}

namespace {

void check_scores(const MatchingCase& example, const Monitor& monitor) {
  constexpr size_t kCheckedScores = 20;  // each costs the oracle as many distances as rows
  constexpr size_t kCheckedRows = 20;
  const size_t length = example.settings.window_length;
  const FrameDistances some = first_rows(example, kCheckedRows);
  CellScan scan(choose_cells({some.train_runs, some.query_runs}, length, kCheckedScores, 1));
  const ScoreBasis basis = score_basis(example);
  match_fastable_online(standardized(some, basis, monitor), example.settings, monitor,
                        std::ref(scan));
  if (!wrong_scores(scan.result(), some.train, some.query, length, basis, monitor).empty())
    throw Error(ErrorKind::expectation,
                "standardized: a score differs from its definition; nothing was timed");
}

}  // namespace

void check_methods(const MatchingCase& example, const std::vector<std::string>& methods,
                   const Monitor& monitor) {
  const size_t length = example.settings.window_length;
  const auto check = [&](std::string_view method, size_t rows) {
    if (std::find(methods.begin(), methods.end(), method) == methods.end()) return;
    const FrameDistances some = first_rows(example, rows);
    CellScan scan(choose_cells({some.train_runs, some.query_runs}, length, kCheckedCells, 1));
    find_sequence_method(method).match(some, example.settings, monitor, std::ref(scan));
    if (!wrong_cells(scan.result(), some.train, some.query.rows, length, monitor).empty())
      throw Error(
          ErrorKind::expectation,
          fmt::format("{}: a distance differs from its definition; nothing was timed", method));
  };
  check("fastable-online", 200);
  check("fastable", 200);
  check("openable", 2);
  if (std::find(methods.begin(), methods.end(), "standardized") != methods.end() &&
      has_room_for_scores(example))
    check_scores(example, monitor);
}

}  // namespace vpr
