#include <algorithm>
#include <chrono>
#include <ctime>
#include <thread>

#include <fmt/format.h>

#include "base/error.h"
#include "base/statistics.h"
#include "bench/benches.h"
#include "query/choices.h"
#include "query/live_lines.h"
#include "query/open.h"

namespace vpr {
namespace {

using Clock = std::chrono::steady_clock;
using Milliseconds = std::chrono::duration<double, std::milli>;

double process_cpu_s() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

SequenceQuerySettings live_settings(const RealtimeBenchSettings& settings) {
  SequenceKeys keys;
  keys.windows.windows = {settings.method, settings.window_length, settings.score};
  keys.decision = Decision::margin;
  return choose_query(keys, std::vector<std::string>{"method"}, QueryCommand::live);
}

}  // namespace

BenchResult bench_realtime(const std::string& database_path, const SequenceSource& query,
                           const RealtimeBenchSettings& settings, const QueryResources& resources,
                           const Monitor& monitor) {
  if (!(settings.rate_hz > 0 && settings.rate_hz <= 10'000))
    throw Error(ErrorKind::usage, "rate must be above 0 and at most 10000, found {}",
                settings.rate_hz);
  if (settings.frames < 1) throw Error(ErrorKind::usage, "query_frames must be 1 or more, found 0");
  if (query.kind != SequenceKind::images)
    throw Error(ErrorKind::usage, "{}: is not a folder or list of images",
                query.argument.path.string());
  const SequenceQuerySettings chosen = live_settings(settings);
  const SequenceDatabase database = open_live_database(database_path, chosen, monitor);
  LiveLines live(database, "query", chosen, resources, monitor);
  const size_t frames = std::min<size_t>(query.files.size(), settings.frames);
  const double period_ms = 1000 / settings.rate_hz;
  std::vector<double> latencies_ms;
  StepCounter counter(monitor, "replay", frames);
  const double cpu_before = process_cpu_s();
  const auto start = Clock::now();
  for (size_t f = 0; f < frames; ++f) {
    check_stop(monitor);
    const auto due = start + std::chrono::duration_cast<Clock::duration>(
                                 Milliseconds(static_cast<double>(f) * period_ms));
    std::this_thread::sleep_until(due);
    live.take({query.files[f].filename().string(), query.files[f], nullptr}, {});
    latencies_ms.push_back(Milliseconds(Clock::now() - due).count());
    counter.add();
  }
  const double wall_s = std::max(Milliseconds(Clock::now() - start).count(),
                                 static_cast<double>(frames) * period_ms) /
                        1000;
  BenchRow row{"replay", {{"rate_hz", settings.rate_hz}}, "frame", summarize(latencies_ms)};
  for (const int percent : {50, 95, 99})
    row.values.emplace_back(fmt::format("latency_{}_ms", percent),
                            quantile(latencies_ms, percent / 100.0));
  row.values.emplace_back("latency_max_ms", row.time.most_ms);
  const auto missed = std::count_if(latencies_ms.begin(), latencies_ms.end(),
                                    [&](double ms) { return ms > period_ms; });
  row.values.emplace_back("missed", missed);
  row.values.emplace_back("cpu_percent", 100 * (process_cpu_s() - cpu_before) / wall_s);
  return {"realtime", value_to_json(settings), {row}};
}

}  // namespace vpr
