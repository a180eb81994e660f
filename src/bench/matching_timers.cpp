#include "bench/matching_timers.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "base/stopwatch.h"
#include "matching/distance_statistics.h"
#include "matching/fastable_batch.h"
#include "matching/fastable_online.h"
#include "matching/fastable_standardized.h"
#include "matching/lsh.h"
#include "matching/methods.h"
#include "matching/openable.h"
#include "matching/plain.h"
#include "pipeline/verify.h"
#include "recognition/row_scan.h"

namespace vpr {
namespace {

constexpr size_t kCheckedCells = 300;
constexpr size_t kSampledCells = 20'000;  // of a row of the plain methods

void ignore(const DistanceRow&) {}

std::vector<double> divided(std::vector<double> times_ms, double by) {
  for (double& ms : times_ms) ms /= by;
  return times_ms;
}

void time_online(const MatchingCase& example, const Effort& effort, const Monitor& monitor,
                 BenchRow& row) {
  const auto& frames = example.query.words;
  FastableState state = start_fastable(example.train, example.settings);
  size_t next = 0;
  const auto advance = [&] {
    advance_fastable(state, example.train, example.settings.kernels, frames[next]);
    next = (next + 1) % frames.size();
  };
  // The first windows are shorter, and the ring is not filled yet.
  for (size_t f = 0; f <= example.settings.window_length; ++f) advance();
  row.time = summarise(time_repeatedly(effort, advance, monitor));
  row.values.emplace_back("ring", state.has_ring ? 1 : 0);
}

ScoreBasis score_basis(const MatchingCase& example) {
  TrainStatistics statistics = compute_statistics(example.train, {}, example.settings.kernels, {});
  return {{},
          false,
          statistics.typical_distance,
          std::move(statistics.bias),
          std::move(statistics.variance),
          count_bits(example.train.sequences)};
}

void time_standardized(const MatchingCase& example, const Effort& effort, const Monitor& monitor,
                       BenchRow& row) {
  const auto& frames = example.query.words;
  const HammingKernels& kernels = example.settings.kernels;
  const Stopwatch watch;
  const ScoreBasis basis = score_basis(example);
  row.values.emplace_back("statistics_s", watch.elapsed_s());
  ScoredFastable state{start_standardized(example.train, example.query, basis, kernels, monitor),
                       start_scored_sums(example.train, example.settings)};
  size_t next = 0;
  size_t seen = 0;
  size_t learned = 0;
  const auto advance = [&] {
    begin_frame(state.frames, basis, frames[next], true);
    learned += state.frames.lesson ? 1 : 0;
    ++seen;
    advance_scored(state, example.train, kernels);
    next = (next + 1) % frames.size();
  };
  for (size_t f = 0; f <= example.settings.window_length; ++f) advance();
  row.time = summarise(time_repeatedly(effort, advance, monitor));
  row.values.emplace_back("learned_share",
                          static_cast<double>(learned) / static_cast<double>(seen));
}

void time_batch(const MatchingCase& example, const Effort& effort, const Monitor& monitor,
                BenchRow& row) {
  const auto frames = static_cast<double>(example.query.words.size());
  row.time = summarise(divided(
      time_repeatedly(
          effort,
          [&] { match_fastable(example.train, example.query, example.settings, {}, ignore); },
          monitor),
      frames));
}

void time_openable(const MatchingCase& example, const Effort& effort, const Monitor& monitor,
                   BenchRow& row) {
  const auto run = [&](size_t rows) {
    const QueryCodes some = make_query_codes(
        {std::span(example.query_codes).first(example.settings.window_length + rows - 1), {}});
    match_openable(example.train, some, example.settings, {}, ignore);
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
  const LshIndex index(example.train, length, example.settings.lsh, example.settings.seed, monitor);
  row.values.emplace_back("build_s", watch.elapsed_s());
  size_t window = 0;
  row.time = summarise(time_repeatedly(
      effort,
      [&] {
        index.find(example.query_codes.data() + window);
        window = (window + 1) % example.rows();
      },
      monitor));
  HitScan scan({{0}, example.rows(), 1, example.settings.kernels});
  match_fastable(example.train, example.query, example.settings, monitor, std::ref(scan));
  const auto exact = scan.result().best;
  size_t found = 0;
  for (size_t w = 0; w < example.rows(); ++w) {
    const auto candidates = index.find(example.query_codes.data() + w);
    found += std::any_of(candidates.begin(), candidates.end(), [&](const LshCandidate& candidate) {
      return candidate.distance == exact[w]->distance;
    });
  }
  row.values.emplace_back("recall",
                          static_cast<double>(found) / static_cast<double>(example.rows()));
}

// The recurrence, cell by cell: two distances each, byte by byte. Part of a long row stands for it.
void time_plain_fastable(const MatchingCase& example, const Effort& effort, const Monitor& monitor,
                         BenchRow& row) {
  const auto& train = example.train_codes;
  const size_t length = example.settings.window_length;
  const size_t cells = std::min(kSampledCells, train.size() - length);
  std::vector<uint32_t> sums(cells + 1, 0);
  const LdbCode& leaving = example.query_codes[0];
  const LdbCode& entering = example.query_codes[length];
  const auto step = [&] {
    for (size_t i = cells; i > 0; --i)
      sums[i] = sums[i - 1] + plain_hamming(train[i - 1 + length], entering) -
                plain_hamming(train[i - 1], leaving);
  };
  row.time =
      summarise(divided(time_repeatedly(effort, step, monitor),
                        static_cast<double>(cells) / static_cast<double>(train.size() - length)));
  if (cells < train.size() - length) row.note = fmt::format("{} cells of a row sampled", cells);
}

void time_plain_openable(const MatchingCase& example, const Effort& effort, const Monitor& monitor,
                         BenchRow& row) {
  const auto& train = example.train_codes;
  const size_t length = example.settings.window_length;
  const size_t windows = train.size() - length + 1;
  const size_t cells = std::min(std::max<size_t>(kSampledCells / length, 1), windows);
  size_t first = 0;
  uint64_t sum = 0;  // read below, so that nothing is left out
  const auto some = [&] {
    for (size_t i = 0; i < cells; ++i)
      sum += plain_window_distance(train, (first + i) % windows, example.query_codes, 0, length);
    first += cells;
  };
  row.time = summarise(divided(time_repeatedly(effort, some, monitor),
                               static_cast<double>(cells) / static_cast<double>(windows)));
  if (cells < windows) row.note = fmt::format("{} cells of a row sampled", cells);
  if (sum == 1) row.note += ".";
}

constexpr std::array<MatchingTimer, 7> kTimers = {{
    {"fastable", "online, one query frame after the other", time_online},
    {"fastable-batch", "the whole query at once", time_batch},
    {"standardized", "online, standardized scores", time_standardized},
    {"openable", "no re-use, same kernels", time_openable},
    {"lsh", "multi-probe hashing, approximate", time_lsh},
    {"plain-fastable", "as in the paper's time: scalar, two distances a cell", time_plain_fastable},
    {"plain-openable", "the same without re-use", time_plain_openable},
}};

}  // namespace

MatchingCase::MatchingCase(const std::vector<LdbCode>& train_frames,
                           std::vector<LdbCode> query_frames, const MatchSettings& match)
    : train_codes(train_frames), query_codes(std::move(query_frames)), settings(match) {
  const CodeSpan span{train_codes, {}};
  train = make_train_codes(std::span(&span, 1));
  query = make_query_codes({query_codes, {}});
}

std::span<const MatchingTimer> matching_timers() { return kTimers; }

bool has_room_for_scores(const MatchingCase& example) {
  return ring_fits(example.train.frame_count, example.settings.window_length,
                   example.settings.memory_limit);
}

const MatchingTimer& find_matching_timer(std::string_view name) {
  std::vector<std::string_view> names;
  for (const MatchingTimer& timer : kTimers) {
    if (timer.name == name) return timer;
    names.push_back(timer.name);
  }
  throw Error(ErrorKind::usage,
              fmt::format("unknown method \"{}\"; choose from {}", name, fmt::join(names, ", ")));
}

void add_method_speed_ups(BenchResult& result) {
  for (const char* work : {"fastable", "fastable-batch"}) {
    add_speed_up(result, work, "openable", "times_openable");
    add_speed_up(result, work, "plain-fastable", "times_plain_fastable");
  }
  add_speed_up(result, "standardized", "fastable", "share_of_fastable_speed");
}

namespace {

void check_scores(const MatchingCase& example, const Monitor& monitor) {
  constexpr size_t kCheckedScores = 20;  // each costs the oracle as many distances as rows
  constexpr size_t kCheckedRows = 20;
  const size_t length = example.settings.window_length;
  const CodeSpan some{
      std::span(example.query_codes).first(length + std::min(kCheckedRows, example.rows()) - 1),
      {}};
  const QueryCodes query = make_query_codes(some);
  CellScan scan(choose_cells(example.train.runs, query.runs, length, kCheckedScores, 1));
  const ScoreBasis basis = score_basis(example);
  match_standardized(example.train, query, {&length, 1}, basis, example.settings, monitor,
                     [&](size_t, const DistanceRow& row) { scan(row); });
  const CodeSpan train{example.train_codes, {}};
  if (!wrong_scores(scan.result(), std::span(&train, 1), some, length, basis, monitor).empty())
    throw Error(ErrorKind::expectation,
                "standardized: a score differs from its definition; nothing was timed");
}

}  // namespace

void check_methods(const MatchingCase& example, const std::vector<std::string>& methods,
                   const Monitor& monitor) {
  const size_t length = example.settings.window_length;
  const auto check = [&](std::string_view timer, std::string_view method, size_t rows) {
    if (std::find(methods.begin(), methods.end(), timer) == methods.end()) return;
    const QueryCodes some = make_query_codes(
        {std::span(example.query_codes).first(length + std::min(rows, example.rows()) - 1), {}});
    CellScan scan(choose_cells(example.train.runs, some.runs, length, kCheckedCells, 1));
    find_sequence_method(method).match(example.train, some, example.settings, monitor,
                                       std::ref(scan));
    const CodeSpan span{example.train_codes, {}};
    if (!wrong_cells(scan.result(), std::span(&span, 1), example.query_codes, length, monitor)
             .empty())
      throw Error(
          ErrorKind::expectation,
          fmt::format("{}: a distance differs from its definition; nothing was timed", timer));
  };
  check("fastable", "fastable-online", 200);
  check("fastable-batch", "fastable", 200);
  check("openable", "openable", 2);
  if (std::find(methods.begin(), methods.end(), "standardized") != methods.end() &&
      has_room_for_scores(example))
    check_scores(example, monitor);
}

}  // namespace vpr
