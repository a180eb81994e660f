#include "bench/matching_bench.h"

#include <algorithm>
#include <memory>

#include <fmt/format.h>

#include "base/error.h"
#include "base/json.h"
#include "base/random.h"
#include "bench/generated.h"
#include "bench/matching_timers.h"
#include "bench/paper_times.h"
#include "recognition/clustering.h"

namespace vpr {
namespace {

constexpr size_t kMostFrames = 50'000'000;

void check_settings(const MatchingBenchSettings& settings) {
  const auto require = [](std::string_view name, const std::vector<uint64_t>& values) {
    if (values.empty()) throw Error(ErrorKind::usage, fmt::format("{} is empty", name));
    for (const uint64_t value : values)
      if (value < 1 || value > kMostFrames)
        throw Error(ErrorKind::usage,
                    fmt::format("{} must be from 1 to {}, found {}", name, kMostFrames, value));
  };
  require("databases", settings.databases);
  require("c_l", settings.window_lengths);
  require("query_frames", settings.query_frames);
  check_seconds(settings.seconds);
  if (settings.changed_bits > kLdbBits)
    throw Error(ErrorKind::usage, fmt::format("changed_bits must be at most {}, found {}", kLdbBits,
                                              settings.changed_bits));
  for (const std::string& method : settings.methods) find_matching_timer(method);
  if (settings.descriptor_length > kMostNumbers)
    throw Error(ErrorKind::usage, fmt::format("descriptor_length must be at most {}, found {}",
                                              kMostNumbers, settings.descriptor_length));
  if (settings.precision != 8 && settings.precision != 16)
    throw Error(ErrorKind::usage,
                fmt::format("precision must be 16 or 8 bits, found {}", settings.precision));
}

// Those that take the descriptors.
std::vector<std::string> timed_methods(const MatchingBenchSettings& settings) {
  std::vector<std::string> methods;
  for (const std::string& method : settings.methods)
    if (settings.descriptor_length == 0 || !find_matching_timer(method).needs_codes)
      methods.push_back(method);
  return methods;
}

/// A database and the query of a size, of the kind that is timed.
struct Generated {
  std::vector<LdbCode> train_codes;
  GeneratedVectors train_vectors;

  Generated(const MatchingBenchSettings& settings, uint64_t frames, uint64_t seed) {
    if (settings.descriptor_length == 0)
      train_codes = generate_walk(frames, seed);
    else
      train_vectors =
          generate_vectors(frames, settings.descriptor_length, settings.precision, seed, seed + 1);
  }
};

std::unique_ptr<MatchingCase> make_case(const Generated& train, const GeneratedVectors& asked,
                                        const std::vector<LdbCode>& again,
                                        const MatchSettings& match) {
  if (train.train_codes.empty())
    return std::make_unique<MatchingCase>(train.train_vectors.rows(), asked.rows(), match);
  return std::make_unique<MatchingCase>(train.train_codes, again, match);
}

NamedNumbers parameters_of(uint64_t frames, uint64_t length, uint64_t query) {
  return {{"frames", static_cast<double>(frames)},
          {"c_l", static_cast<double>(length)},
          {"query_frames", static_cast<double>(query)}};
}

// What the paper says of a time per frame: frames a second, and the share of one core at 10 Hz.
void add_rates(BenchRow& row) {
  row.values.emplace_back("fps", 1000 / row.time.median_ms);
  row.values.emplace_back("cpu_at_10_hz_percent", row.time.median_ms);
}

// Hits as dense as a fine threshold leaves them: a quarter of a band of 400 windows.
BenchRow time_clustering(uint64_t count, const Effort& effort, uint64_t seed,
                         const Monitor& monitor) {
  RandomEngine engine(seed);
  std::vector<Match> hits;
  for (uint32_t query = 0; hits.size() < count; ++query)
    for (uint32_t train = 0; train < 400 && hits.size() < count; ++train)
      if (uniform_below(engine, 4) == 0) hits.push_back({query, 0, train, 0, 1});
  BenchRow row{"cluster", {{"hits", static_cast<double>(count)}}, "set of hits", {}, {}, ""};
  size_t places = 0;
  row.time = summarise(time_repeatedly(
      effort, [&] { places = cluster_hits(hits, {}).all.size(); }, monitor));
  row.values.emplace_back("places", static_cast<double>(places));
  return row;
}

Chart time_chart(const BenchResult& result, const MatchingBenchSettings& settings,
                 const std::string& x, const NamedNumbers& fixed) {
  Chart chart;
  chart.file = fmt::format("time-by-{}", x);
  chart.title = "Matching time per query frame";
  for (const auto& [name, value] : fixed) chart.title += fmt::format(", {} {:g}", name, value);
  chart.x.label = x == "frames" ? "database frames"
                  : x == "c_l"  ? "window length c_l (frames)"
                                : "query frames";
  chart.y.label = "milliseconds";
  chart.x.is_log = x == "frames";
  chart.y.is_log = true;
  for (const std::string& method : settings.methods) {
    Series series{method, {}};
    for (const BenchRow& row : result.rows)
      if (row.work == method && std::all_of(fixed.begin(), fixed.end(), [&](const auto& parameter) {
            return row.parameter(parameter.first) == parameter.second;
          }))
        series.points.emplace_back(row.parameter(x), row.time.median_ms);
    if (!series.points.empty()) chart.series.push_back(series);
  }
  return chart;
}

}  // namespace

BenchResult bench_matching(const MatchingBenchSettings& settings, uint64_t seed,
                           const RowKernels& kernels, const Monitor& monitor) {
  check_settings(settings);
  BenchResult result;
  result.bench = "matching";
  result.settings = value_to_json(settings);
  const Effort effort{settings.seconds};
  StepCounter counter(monitor, "measure",
                      settings.databases.size() * settings.window_lengths.size() *
                          settings.query_frames.size() * settings.methods.size());
  const std::vector<std::string> methods = timed_methods(settings);
  for (const uint64_t frames : settings.databases) {
    const Generated train(settings, frames, seed);
    for (const uint64_t query : settings.query_frames) {
      std::vector<LdbCode> again;
      GeneratedVectors asked;
      if (settings.descriptor_length == 0)
        again = walk_again(train.train_codes, frames / 3, query, settings.changed_bits, seed + 1);
      else
        asked = generate_vectors(query, settings.descriptor_length, settings.precision, seed,
                                 seed + 2, frames / 3);
      for (const uint64_t length : settings.window_lengths) {
        if (length >= frames || length >= query) {
          result.left_out.push_back(
              fmt::format("c_l {} needs more than {} database frames and {} query frames", length,
                          frames, query));
          continue;
        }
        MatchSettings match{length, kDefaultMemoryLimit, kernels, settings.lsh, seed};
        const auto example_case = make_case(train, asked, again, match);
        const MatchingCase& example = *example_case;
        check_methods(example, methods, monitor);
        for (const std::string& method : methods) {
          BenchRow row{method, parameters_of(frames, length, query), "query frame", {}, {}, ""};
          find_matching_timer(method).measure(example, effort, monitor, row);
          add_rates(row);
          result.rows.push_back(std::move(row));
          counter.add();
        }
      }
    }
  }
  if (settings.clustered_hits > 0)
    result.rows.push_back(time_clustering(settings.clustered_hits, effort, seed, monitor));
  return result;
}

void add_matching_comparisons(BenchResult& result, const MatchingBenchSettings& settings) {
  add_method_speed_ups(result);
  std::vector<Series> speed_ups;
  for (const uint64_t length : settings.window_lengths) {
    Series series{fmt::format("c_l {}", length), {}};
    for (const uint64_t frames : settings.databases) {
      const NamedNumbers parameters = parameters_of(frames, length, settings.query_frames.front());
      const BenchRow* fast = find_row(result, "fastable-online", parameters);
      const BenchRow* slow = find_row(result, "openable", parameters);
      if (fast == nullptr || slow == nullptr) continue;
      series.points.emplace_back(static_cast<double>(frames),
                                 slow->time.median_ms / fast->time.median_ms);
      for (const PaperSpeedUp& paper : kPaperSpeedUps)
        if (paper.frames == frames && paper.window_length == length)
          result.paper.push_back(
              paper_ratio("tab6", fmt::format("FastABLE over OpenABLE, {}", paper.device),
                          paper.ratio, *fast, *slow));
    }
    if (!series.points.empty()) speed_ups.push_back(series);
  }
  if (!speed_ups.empty())
    result.charts.push_back({"speed-up",
                             "FastABLE over OpenABLE, same kernels",
                             {"database frames", true},
                             {"times faster", false, true},
                             speed_ups});
  const NamedNumbers longest = {{"c_l", static_cast<double>(settings.window_lengths.back())}};
  const NamedNumbers largest = {{"frames", static_cast<double>(settings.databases.back())}};
  const NamedNumbers query = {{"query_frames", static_cast<double>(settings.query_frames.front())}};
  result.charts.push_back(time_chart(result, settings, "frames", {longest[0], query[0]}));
  if (settings.window_lengths.size() > 1)
    result.charts.push_back(time_chart(result, settings, "c_l", {largest[0], query[0]}));
  if (settings.query_frames.size() > 1)
    result.charts.push_back(time_chart(result, settings, "query_frames", {largest[0], longest[0]}));
}

}  // namespace vpr
