#include "bench/nordland_bench.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/error.h"
#include "base/json.h"
#include "bench/generated.h"
#include "bench/matching_timers.h"
#include "bench/paper_times.h"

namespace vpr {
namespace {

// Codes twice (as given, and in blocks), sums twice, the ring, a row.
size_t needed_memory(const NordlandBenchSettings& settings, uint64_t frames) {
  const uint64_t ring = std::min(settings.ring_bytes, 2 * frames * (settings.window_length + 1));
  return frames * (2 * kLdbBytes + 16) + ring + (64U << 20);
}

void check_settings(const NordlandBenchSettings& settings) {
  for (const std::string& method : settings.methods) find_matching_timer(method);
  if (settings.window_length < 1 || settings.window_length > kMaxWindowLength)
    throw Error(ErrorKind::usage, fmt::format("c_l must be from 1 to {}, found {}",
                                              kMaxWindowLength, settings.window_length));
  if (settings.query_frames <= settings.window_length)
    throw Error(ErrorKind::usage, fmt::format("query_frames must be above c_l {}, found {}",
                                              settings.window_length, settings.query_frames));
  for (const uint64_t frames : settings.databases)
    if (frames <= settings.window_length || frames > 100'000'000)
      throw Error(ErrorKind::usage,
                  fmt::format("databases must be above c_l {} and at most 100000000, found {}",
                              settings.window_length, frames));
  check_seconds(settings.seconds);
  if (settings.changed_bits > kLdbBits)
    throw Error(ErrorKind::usage, fmt::format("changed_bits must be at most {}, found {}", kLdbBits,
                                              settings.changed_bits));
}

NamedNumbers parameters_of(const NordlandBenchSettings& settings, uint64_t frames) {
  return {{"frames", static_cast<double>(frames)},
          {"c_l", static_cast<double>(settings.window_length)}};
}

void add_case(BenchResult& result, const NordlandBenchSettings& settings, MatchingCase& example,
              const Monitor& monitor) {
  const uint64_t frames = example.train_codes.size();
  check_methods(example, settings.methods, monitor);
  for (const std::string& method : settings.methods) {
    if (method == "lsh" && frames > settings.lsh_most_frames) {
      result.left_out.push_back(fmt::format("lsh for {} frames, above lsh_most_frames {}", frames,
                                            settings.lsh_most_frames));
      continue;
    }
    if (method == "standardized" && !has_room_for_scores(example)) {
      result.left_out.push_back(
          fmt::format("standardized for {} frames, whose scores do not fit ring_bytes {}", frames,
                      settings.ring_bytes));
      continue;
    }
    const auto measure = [&](const std::string& work) {
      BenchRow row{work, parameters_of(settings, frames), "query frame", {}, {}, ""};
      reset_peak_memory();
      find_matching_timer(method).measure(example, {settings.seconds}, monitor, row);
      row.values.emplace_back("cpu_at_10_hz_percent", row.time.median_ms);
      row.values.emplace_back("peak_mib", static_cast<double>(peak_memory() >> 20));
      result.rows.push_back(std::move(row));
    };
    if (method == "lsh") {
      for (const uint64_t level : settings.lsh_probe_levels) {
        example.settings.lsh.probe_level = level;
        measure(fmt::format("lsh-level-{}", level));
      }
    } else {
      measure(method);
    }
  }
}

void add_paper_numbers(BenchResult& result, const NordlandBenchSettings& settings) {
  if (settings.window_length != 300) return;
  for (const PaperNordlandTime& paper : kPaperNordlandTimes) {
    for (size_t i = 0; i < kPaperNordlandFrames.size(); ++i) {
      const NamedNumbers parameters = parameters_of(settings, kPaperNordlandFrames[i]);
      if (const BenchRow* ours = find_row(result, paper.our_work, parameters))
        result.paper.push_back(paper_time(paper.table, paper.what, paper.ms[i], *ours));
    }
  }
  // What matters of approximate search: is it faster than exact search?
  for (size_t i = 0; i < kPaperNordlandFrames.size(); ++i) {
    const NamedNumbers parameters = parameters_of(settings, kPaperNordlandFrames[i]);
    if (const BenchRow* exact = find_row(result, "fastable-online", parameters))
      result.paper.push_back(paper_time("tab5",
                                        "multi-probe LSH of ABLE-M's authors; ours: exact FastABLE",
                                        kPaperNordlandTimes[4].ms[i], *exact));
  }
}

}  // namespace

BenchResult bench_nordland(const NordlandBenchSettings& settings,
                           const std::optional<RecordedCodes>& recorded, uint64_t seed,
                           const RowKernels& kernels, const Monitor& monitor) {
  check_settings(settings);
  BenchResult result;
  result.bench = "nordland";
  result.settings = value_to_json(settings);
  result.settings["codes"] = recorded ? "recorded" : "generated";
  StepCounter counter(monitor, "measure", settings.databases.size());
  for (const uint64_t frames : settings.databases) {
    const size_t available = available_memory();
    if (available != 0 && needed_memory(settings, frames) > available) {
      result.left_out.push_back(fmt::format("{} frames need {} MiB of memory, and {} are free",
                                            frames, needed_memory(settings, frames) >> 20,
                                            available >> 20));
    } else if (recorded && recorded->train.size() < frames) {
      result.left_out.push_back(
          fmt::format("{} frames: the recording has {}", frames, recorded->train.size()));
    } else {
      const std::vector<LdbCode> train =
          recorded ? std::vector<LdbCode>(recorded->train.begin(),
                                          recorded->train.begin() + static_cast<ptrdiff_t>(frames))
                   : generate_walk(frames, seed);
      const std::vector<LdbCode> query = recorded
                                             ? recorded->query
                                             : walk_again(train, frames / 3, settings.query_frames,
                                                          settings.changed_bits, seed + 1);
      if (query.size() <= settings.window_length)
        throw Error(ErrorKind::usage, fmt::format("the query has {} frames, and c_l is {}",
                                                  query.size(), settings.window_length));
      MatchSettings match{settings.window_length, settings.ring_bytes, kernels, settings.lsh, seed};
      MatchingCase example(train, query, match);
      add_case(result, settings, example, monitor);
    }
    counter.add();
  }
  add_method_speed_ups(result);
  add_paper_numbers(result, settings);
  Chart chart{"nordland",
              fmt::format("Matching time per query frame, c_l {}", settings.window_length),
              {"database frames", true},
              {"milliseconds", true}};
  for (const BenchRow& row : result.rows) {
    const auto same = [&](const Series& series) { return series.name == row.work; };
    auto series = std::find_if(chart.series.begin(), chart.series.end(), same);
    if (series == chart.series.end()) series = chart.series.insert(series, {row.work, {}});
    series->points.emplace_back(row.parameter("frames"), row.time.median_ms);
  }
  result.charts.push_back(chart);
  return result;
}

}  // namespace vpr
