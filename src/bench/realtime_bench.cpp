#include "bench/realtime_bench.h"

#include <algorithm>
#include <chrono>
#include <ctime>
#include <memory>
#include <thread>

#include <fmt/format.h>

#include "base/error.h"
#include "base/json.h"
#include "base/statistics.h"
#include "bench/generated.h"
#include "bench/matching_timers.h"
#include "descriptors/array_rows.h"

namespace vpr {
namespace {

using Clock = std::chrono::steady_clock;

constexpr size_t kSmallestTried = 1000;
constexpr size_t kRingBytes = size_t{512} << 20;

double process_cpu_s() {
  timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_nsec) * 1e-9;
}

void check_settings(const RealtimeBenchSettings& settings) {
  if (!(settings.rate_hz > 0 && settings.rate_hz <= 10'000))
    throw Error(ErrorKind::usage,
                fmt::format("rate must be above 0 and at most 10000, found {}", settings.rate_hz));
  if (settings.frames < 1) throw Error(ErrorKind::usage, "frames must be 1 or more, found 0");
  if (!(settings.share_percent > 0 && settings.share_percent <= 100))
    throw Error(ErrorKind::usage, fmt::format("share must be above 0 and at most 100, found {}",
                                              settings.share_percent));
  if (settings.window_length < 1 || settings.window_length > kMaxWindowLength)
    throw Error(ErrorKind::usage, fmt::format("c_l must be from 1 to {}, found {}",
                                              kMaxWindowLength, settings.window_length));
}

// So many descriptors, from the first again where they end; none of none.
std::vector<uint8_t> repeated(const DescriptorRows& rows, size_t count) {
  const size_t period = rows.size();
  if (period == 0) return {};
  std::vector<uint8_t> bytes;
  bytes.reserve(count * rows.shape.row_bytes());
  for (size_t i = 0; i < count; ++i) {
    const DescriptorRow row = rows[i % period];
    bytes.insert(bytes.end(), row.begin(), row.end());
  }
  return bytes;
}

/// Milliseconds of one online step against a database of so many frames.
BenchRow time_database(uint64_t frames, const RealtimeBenchSettings& settings,
                       const RowKernels& kernels, uint64_t seed, const DescriptorRows& like,
                       const Monitor& monitor) {
  const size_t asked = settings.window_length + 50;
  const MatchSettings match{settings.window_length, kRingBytes, kernels, {}, seed};
  std::vector<LdbCode> codes;
  std::vector<uint8_t> train_bytes;
  std::vector<uint8_t> query_bytes;
  std::unique_ptr<MatchingCase> example;
  if (like.empty()) {
    codes = generate_walk(frames, seed);
    example =
        std::make_unique<MatchingCase>(codes, walk_again(codes, 0, asked, 100, seed + 1), match);
  } else {
    train_bytes = repeated(like, frames);
    query_bytes = repeated(like, asked);
    example = std::make_unique<MatchingCase>(DescriptorRows(like.shape, train_bytes),
                                             DescriptorRows(like.shape, query_bytes), match);
  }
  check_methods(*example, {"fastable-online"}, monitor);
  BenchRow row{"fastable-online",
               {{"frames", static_cast<double>(frames)},
                {"c_l", static_cast<double>(settings.window_length)}},
               "query frame",
               {},
               {},
               ""};
  find_matching_timer("fastable-online").measure(*example, {0.3}, monitor, row);
  row.values.emplace_back("cpu_percent", row.time.median_ms * settings.rate_hz / 10);
  return row;
}

// Frames of a replay, each a sequence of its own; of one array, rows.
std::vector<Sequence> single_frames(const Sequence& query, size_t most) {
  if (query.kind == SequenceKind::video)
    throw Error(ErrorKind::usage, fmt::format("{}: give a folder or list of images, not a video",
                                              query.argument.path.string()));
  const size_t count = query.is_one_array() ? ArrayRows(query).count() : query.files.size();
  std::vector<Sequence> frames;
  for (size_t f = 0; f < std::min(count, most); ++f) {
    if (query.is_one_array()) {
      frames.push_back(query);
      const FrameRange& range = query.argument.range;
      const uint64_t row = range.first + f * range.step;
      frames.back().argument.range = {row, row + 1};
    } else {
      frames.push_back({{query.files[f], {}}, query.kind, {query.files[f]}});
    }
  }
  return frames;
}

}  // namespace

BenchResult bench_realtime(const Sequence& query, const FrameWork& work,
                           const RealtimeBenchSettings& settings, const Monitor& monitor) {
  check_settings(settings);
  const std::vector<Sequence> all = single_frames(query, settings.frames);
  BenchResult result;
  result.bench = "realtime";
  result.settings = value_to_json(settings);
  const double period_ms = 1000 / settings.rate_hz;
  std::vector<double> latencies_ms;
  StepCounter counter(monitor, "replay", all.size());
  const double cpu_before = process_cpu_s();
  const auto start = Clock::now();
  for (size_t f = 0; f < all.size(); ++f) {
    check_stop(monitor);
    const auto due =
        start + std::chrono::duration_cast<Clock::duration>(
                    std::chrono::duration<double, std::milli>(static_cast<double>(f) * period_ms));
    std::this_thread::sleep_until(due);
    work(all[f]);
    latencies_ms.push_back(std::chrono::duration<double, std::milli>(Clock::now() - due).count());
    counter.add();
  }
  const double wall_s = std::max(std::chrono::duration<double>(Clock::now() - start).count(),
                                 static_cast<double>(all.size()) * period_ms / 1000);
  const double cpu_s = process_cpu_s() - cpu_before;
  BenchRow row{"replay", {{"rate_hz", settings.rate_hz}}, "frame", summarise(latencies_ms), {}, ""};
  for (const int percent : {50, 95, 99, 100})
    row.values.emplace_back(
        percent == 100 ? "latency_max_ms" : fmt::format("latency_{}_ms", percent),
        quantile(latencies_ms, percent / 100.0));
  row.values.emplace_back(
      "missed", static_cast<double>(std::count_if(latencies_ms.begin(), latencies_ms.end(),
                                                  [&](double ms) { return ms > period_ms; })));
  row.values.emplace_back("cpu_percent", 100 * cpu_s / wall_s);
  result.rows.push_back(std::move(row));
  return result;
}

void find_largest_database(BenchResult& result, const RealtimeBenchSettings& settings,
                           const RowKernels& kernels, uint64_t seed, const DescriptorRows& like,
                           const Monitor& monitor) {
  check_settings(settings);
  const double budget_ms = settings.share_percent / 100 * 1000 / settings.rate_hz;
  uint64_t fits = 0;
  uint64_t too_large = 0;
  const auto fits_budget = [&](uint64_t frames) {
    const BenchRow row = time_database(frames, settings, kernels, seed, like, monitor);
    result.rows.push_back(row);
    return row.time.median_ms <= budget_ms;
  };
  uint64_t frames = std::max<uint64_t>(kSmallestTried, settings.window_length + 1);
  if (settings.most_frames < frames)
    throw Error(ErrorKind::usage, fmt::format("most_frames must be at least {}, found {}", frames,
                                              settings.most_frames));
  while (too_large == 0 && frames <= settings.most_frames) {
    if (fits_budget(frames)) {
      fits = frames;
      frames *= 4;
    } else {
      too_large = frames;
    }
  }
  for (int step = 0; step < 3 && too_large != 0 && fits != 0; ++step) {
    const uint64_t middle = fits + (too_large - fits) / 2;
    (fits_budget(middle) ? fits : too_large) = middle;
  }
  BenchRow& last = result.rows.back();
  BenchRow summary{"largest database",
                   {{"rate_hz", settings.rate_hz}, {"share_percent", settings.share_percent}},
                   "query frame",
                   last.time,
                   {{"largest_frames", static_cast<double>(fits)}},
                   too_large == 0 ? "the largest that was tried fits" : ""};
  for (const BenchRow& row : result.rows)
    if (row.work == "fastable-online" && row.parameter("frames") == static_cast<double>(fits))
      summary.time = row.time;
  result.rows.push_back(std::move(summary));
}

}  // namespace vpr
