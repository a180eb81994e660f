#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "base/error.h"
#include "base/named_table.h"
#include "base/random.h"
#include "base/stopwatch.h"
#include "bench/benches.h"
#include "bench/generated.h"
#include "match/components.h"
#include "match/distance_statistics.h"
#include "match/fastable.h"
#include "match/lsh.h"
#include "match/match.h"
#include "match/zscores.h"
#include "query/clustering.h"
#include "query/row_scan.h"
#include "reference/reference.h"
#include "reference/sampled_cells.h"

namespace vpr {
namespace {

constexpr size_t kCheckedCells = 300;

void ignore(const ScoreRow&) {}

// The distances of the first `rows` query windows, or of all.
FrameDistances first_rows(const MatchingCase& example, size_t rows) {
  const size_t frames = example.settings.window_length + std::min(rows, example.rows()) - 1;
  return example.distances.of_query({example.distances.query.rows.first(frames), {}});
}

// Passes query frames through the stage of settings.method repeatedly. The first windows are
// shorter and are not timed. Calls `after_frame` after each frame.
void time_stage(
    const FrameDistances& distances, const MatchSettings& settings, const Effort& effort,
    const Monitor& monitor, BenchRow& row, const std::function<void()>& after_frame = [] {}) {
  const WindowStage stage = window_stage(distances, {&settings.window_length, 1}, settings);
  QueryFrame next{0, 0, 1};
  const auto advance = [&] {
    stage(distances, next, [](size_t, std::span<const ScoreRow>) {});
    after_frame();
    next = {(next.row + 1) % distances.query_frames, next.number + 1,
            next.consecutive_readable + 1};
  };
  for (size_t f = 0; f <= settings.window_length; ++f) advance();
  row.time = time_repeatedly(effort, advance, monitor);
}

// Whether the ring of sums fits the memory; z-scores need all of it.
bool has_whole_ring(const MatchingCase& example) {
  return ring_fits(example.distances.train_frames, example.settings.window_length,
                   example.settings.memory_limit);
}

void time_online(const MatchingCase& example, const Effort& effort, const Monitor& monitor,
                 BenchRow& row) {
  time_stage(example.distances, example.settings, effort, monitor, row);
  row.values.emplace_back("ring", has_whole_ring(example));
}

ScoreBasis score_basis(const MatchingCase& example) {
  TrainStatistics statistics = compute_statistics(example.distances.train, {}, {});
  statistics.components =
      compute_components(example.distances.train, statistics.typical_distance, {});
  return make_score_basis(statistics);
}

void time_zscores(const MatchingCase& example, const Effort& effort, const Monitor& monitor,
                  BenchRow& row) {
  const Stopwatch watch;
  const ScoreBasis basis = score_basis(example);
  row.values.emplace_back("statistics_s", watch.elapsed_s());
  const auto learning = start_zscores(example.distances, basis);
  size_t frames = 0;
  size_t learned = 0;
  const auto count = [&] {
    learned += learning->update ? 1 : 0;
    ++frames;
  };
  time_stage(zscores(learning), example.settings, effort, monitor, row, count);
  row.values.emplace_back("learned_share",
                          static_cast<double>(learned) / static_cast<double>(frames));
}

void time_filtered(const MatchingCase& example, const Effort& effort, const Monitor& monitor,
                   BenchRow& row) {
  MatchSettings settings = example.settings;
  settings.method = &find_sequence_method("filter");
  settings.window_length = 1;
  time_stage(zscores(example.distances, score_basis(example)), settings, effort, monitor, row);
}

void time_batch(const MatchingCase& example, const Effort& effort, const Monitor& monitor,
                BenchRow& row) {
  const auto run = [&] { match(example.distances, example.settings, {{ignore}}, {}); };
  row.time =
      time_repeatedly(effort, run, monitor, static_cast<double>(example.distances.query_frames));
}

void time_openable(const MatchingCase& example, const Effort& effort, const Monitor& monitor,
                   BenchRow& row) {
  MatchSettings settings = example.settings;
  settings.method = &find_sequence_method("openable");
  const auto run = [&](size_t rows) { match(first_rows(example, rows), settings, {{ignore}}, {}); };
  // Use as many rows per run as fit in a tenth of the time, because the start of a run has a cost
  // as well.
  const Stopwatch watch;
  run(1);
  const double share = effort.seconds / 10 / watch.elapsed_s();
  const size_t rows = std::clamp<size_t>(static_cast<size_t>(share), 1, example.rows());
  row.time = time_repeatedly(
      effort, [&] { run(rows); }, monitor, static_cast<double>(rows));
  if (rows < example.rows()) row.note = fmt::format("{} rows sampled", rows);
}

void time_lsh(const MatchingCase& example, const Effort& effort, const Monitor& monitor,
              BenchRow& row) {
  const size_t length = example.settings.window_length;
  const DescriptorRows& queries = example.distances.query.rows;
  const Stopwatch watch;
  const LshSearch find = make_lsh_search(example.distances.train, length, example.settings.lsh,
                                         example.settings.seed, monitor);
  row.values.emplace_back("build_s", watch.elapsed_s());
  size_t window = 0;
  const auto find_next = [&] {
    find(queries[window].data());
    window = (window + 1) % example.rows();
  };
  row.time = time_repeatedly(effort, find_next, monitor);
  RecognitionScan scan({{0}, example.rows(), 1});
  match(example.distances, example.settings, {{std::ref(scan)}}, monitor);
  const auto exact = scan.result().best;
  size_t found = 0;
  for (size_t w = 0; w < example.rows(); ++w)
    found += std::ranges::any_of(find(queries[w].data()),
                                 [&](const Cell& cell) { return cell.score == exact[w]->score; });
  row.values.emplace_back("recall",
                          static_cast<double>(found) / static_cast<double>(example.rows()));
}

/// An entry of the table of timed methods.
struct MatchingTimer {
  std::string_view name;
  bool needs_codes = false;  ///< compares LDB codes only
  /// Milliseconds per query frame. Adds values and a note to the row.
  void (*measure)(const MatchingCase&, const Effort&, const Monitor&, BenchRow&);
};

constexpr std::array<MatchingTimer, 6> kTimers = {{
    {"fastable-online", false, time_online},
    {"fastable", false, time_batch},
    {"zscore", false, time_zscores},
    {"filter", false, time_filtered},
    {"openable", false, time_openable},
    {"lsh", true, time_lsh},
}};

void check_scores(const MatchingCase& example, const Monitor& monitor) {
  constexpr size_t kCheckedScores = 20;  // each needs as many reference distances as there are rows
  constexpr size_t kCheckedRows = 20;
  const size_t length = example.settings.window_length;
  const FrameDistances some = first_rows(example, kCheckedRows);
  CellScan scan(choose_cells(some, length, kCheckedScores, 1));
  const ScoreBasis basis = score_basis(example);
  match(zscores(some, basis), example.settings, {{std::ref(scan)}}, monitor);
  if (!wrong_scores(scan.result(), some.train, some.query, length, basis, monitor).empty())
    throw Error(ErrorKind::expectation,
                "zscore: a score differs from the reference implementation; nothing was timed");
}

constexpr size_t kMaxFrames = 50'000'000;

void check_settings(const MatchingBenchSettings& settings) {
  check_values("databases", settings.databases, 1, kMaxFrames);
  check_values("c_l", settings.window_lengths, 1, kMaxFrames);
  check_values("query_frames", settings.query_frames, 1, kMaxFrames);
  check_seconds(settings.seconds);
  if (settings.changed_bits > kLdbBits)
    throw Error(ErrorKind::usage, "changed_bits must be at most {}, found {}", kLdbBits,
                settings.changed_bits);
  for (const std::string& method : settings.methods) find_named(kTimers, "method", method);
  if (settings.descriptor_length > kMaxIntegers)
    throw Error(ErrorKind::usage, "descriptor_length must be at most {}, found {}", kMaxIntegers,
                settings.descriptor_length);
  if (settings.precision != 8 && settings.precision != 16)
    throw Error(ErrorKind::usage, "--value-bits must be 16 or 8, found {}", settings.precision);
}

// The methods that accept the descriptors.
std::vector<std::string> timed_methods(const MatchingBenchSettings& settings) {
  std::vector<std::string> methods;
  for (const std::string& method : settings.methods)
    if (settings.descriptor_length == 0 || !find_named(kTimers, "method", method).needs_codes)
      methods.push_back(method);
  return methods;
}

/// Training and query frames of one database size.
struct BenchFrames {
  GeneratedVectors train;
  GeneratedVectors query;
};

GeneratedVectors rows_of(std::span<const LdbCode> codes) {
  GeneratedVectors rows{kLdbShape, {}};
  for (const LdbCode& code : codes) rows.bytes.insert(rows.bytes.end(), code.begin(), code.end());
  return rows;
}

BenchFrames make_frames(const MatchingBenchSettings& settings,
                        const std::optional<RecordedCodes>& recorded, size_t frames, size_t query,
                        uint64_t seed) {
  const size_t length = settings.descriptor_length;
  if (length != 0)
    return {generate_vectors(frames, length, settings.precision, seed, seed + 1),
            generate_vectors(query, length, settings.precision, seed, seed + 2, frames / 3)};
  if (recorded)
    return {rows_of(std::span(recorded->train).first(frames)),
            rows_of(std::span(recorded->query).first(query))};
  const std::vector<LdbCode> train = generate_sequence(frames, seed);
  return {rows_of(train),
          rows_of(repeat_sequence(train, frames / 3, query, settings.changed_bits, seed + 1))};
}

// The reason why a case cannot be measured; empty if it can.
std::string obstacle(const MatchingBenchSettings& settings,
                     const std::optional<RecordedCodes>& recorded, uint64_t frames, uint64_t length,
                     uint64_t query) {
  if (length >= frames || length >= query)
    return fmt::format("c_l {} needs more than {} database frames and {} query frames", length,
                       frames, query);
  if (recorded && (recorded->train.size() < frames || recorded->query.size() < query))
    return fmt::format("{} database frames and {} query frames: the recordings have {} and {}",
                       frames, query, recorded->train.size(), recorded->query.size());
  // Codes twice (as generated and in blocks), sums twice, the ring, one row.
  const size_t bytes = settings.descriptor_length == 0
                           ? kLdbBytes
                           : settings.descriptor_length * settings.precision / 8;
  const size_t ring = std::min(settings.ring_bytes, 2 * frames * (length + 1));
  const size_t needed = frames * (2 * bytes + 16) + ring + (size_t{64} << 20);
  const size_t available = available_memory();
  if (available != 0 && needed > available)
    return fmt::format("{} frames need {} MiB of memory, and {} MiB are free", frames, needed >> 20,
                       available >> 20);
  return "";
}

NamedNumbers parameters_of(uint64_t frames, uint64_t length, uint64_t query) {
  return {{"frames", frames}, {"c_l", length}, {"query_frames", query}};
}

// Recognitions as dense as with a well-chosen threshold: a quarter of a band of 400 windows.
BenchRow time_clustering(uint64_t count, const Effort& effort, uint64_t seed,
                         const Monitor& monitor) {
  RandomEngine engine(seed);
  std::vector<Match> recognitions;
  for (uint32_t query = 0; recognitions.size() < count; ++query)
    for (uint32_t train = 0; train < 400 && recognitions.size() < count; ++train)
      if (uniform_below(engine, 4) == 0) recognitions.push_back({query, 0, train, 0, 1});
  size_t places = 0;
  const auto cluster = [&] { places = cluster_recognitions(recognitions, {}).all.size(); };
  const TimeSummary time = time_repeatedly(effort, cluster, monitor);
  return {"cluster", {{"recognitions", count}}, "set of recognitions", time, {{"places", places}}};
}

Chart time_chart(const BenchResult& result, const MatchingBenchSettings& settings,
                 const std::string& x, const std::string& label, const NamedNumbers& fixed) {
  Chart chart;
  chart.file = fmt::format("time-by-{}", x);
  chart.title = "Matching time per query frame";
  for (const auto& [name, value] : fixed) chart.title += fmt::format(", {} {:g}", name, value);
  chart.x.label = label;
  chart.y.label = "milliseconds";
  chart.x.is_log = x == "frames";
  chart.y.is_log = true;
  chart.series = time_series(result, settings.methods, x, fixed);
  return chart;
}

/// A chart of a value of one method by database size, with a series per window length.
struct ValueChart {
  const char* work;
  const char* value;
  const char* file;
  const char* title;
  const char* label;
  bool is_log;
};

constexpr std::array<ValueChart, 3> kValueCharts = {{
    {"fastable-online", "times_openable", "speed-up", "FastABLE over OpenABLE, same kernels",
     "times faster", false},
    {"openable", "fps", "openable-fps", "OpenABLE: most frames per second", "frames per second",
     true},
    {"fastable-online", "cpu_at_10_hz_percent", "fastable-cpu",
     "FastABLE: load of one core at 10 frames per second", "CPU %", true},
}};

// Without series if the method was not measured.
Chart value_chart(const BenchResult& result, const MatchingBenchSettings& settings,
                  const ValueChart& of) {
  Chart chart{of.file, of.title, {"database frames", true}, {of.label, of.is_log, true}};
  for (const uint64_t length : settings.window_lengths) {
    Series series{fmt::format("c_l {}", length), {}};
    for (const uint64_t frames : settings.databases) {
      const BenchRow* row =
          find_row(result, of.work, parameters_of(frames, length, settings.query_frames.front()));
      const auto value = row == nullptr ? std::nullopt : find_number(row->values, of.value);
      if (value) series.points.emplace_back(static_cast<double>(frames), *value);
    }
    if (!series.points.empty()) chart.series.push_back(std::move(series));
  }
  return chart;
}

// Adds the value `name` to every row of `work`: the speed-up over the row of `slower` with the same
// parameters.
void add_speed_up(BenchResult& result, const std::string& work, const std::string& slower,
                  const std::string& name) {
  for (BenchRow& row : result.rows)
    if (const BenchRow* other = find_row(result, slower, row.parameters);
        row.work == work && other != nullptr)
      row.values.emplace_back(name, other->time.median_ms / row.time.median_ms);
}

// The speed-ups of FastABLE over OpenABLE, and all charts.
void add_comparisons(BenchResult& result, const MatchingBenchSettings& settings) {
  for (const char* work : {"fastable-online", "fastable"})
    add_speed_up(result, work, "openable", "times_openable");
  add_speed_up(result, "zscore", "fastable-online", "share_of_fastable_speed");
  const uint64_t most_frames = settings.databases.back();
  const uint64_t longest = settings.window_lengths.back();
  const uint64_t query = settings.query_frames.front();
  for (const ValueChart& chart : kValueCharts)
    result.charts.push_back(value_chart(result, settings, chart));
  result.charts.push_back(time_chart(result, settings, "frames", "database frames",
                                     {{"c_l", longest}, {"query_frames", query}}));
  if (settings.window_lengths.size() > 1)
    result.charts.push_back(time_chart(result, settings, "c_l", "window length c_l (frames)",
                                       {{"frames", most_frames}, {"query_frames", query}}));
  if (settings.query_frames.size() > 1)
    result.charts.push_back(time_chart(result, settings, "query_frames", "query frames",
                                       {{"frames", most_frames}, {"c_l", longest}}));
}

}  // namespace

MatchingCase make_case(const DescriptorRows& train, const DescriptorRows& query,
                       const MatchSettings& settings) {
  const DescribedFrames span{train, {}};
  return {settings, frame_distances({&span, 1}, {query, {}})};
}

void check_methods(const MatchingCase& example, const std::vector<std::string>& methods,
                   const Monitor& monitor) {
  const size_t length = example.settings.window_length;
  const auto check = [&](std::string_view method, size_t rows) {
    if (std::ranges::count(methods, method) == 0) return;
    const FrameDistances some = first_rows(example, rows);
    CellScan scan(choose_cells(some, length, kCheckedCells, 1));
    MatchSettings settings = example.settings;
    settings.method = &find_sequence_method(method);
    match(some, settings, {{std::ref(scan)}}, monitor);
    if (!wrong_cells(scan.result(), some.train, some.query.rows, length, monitor).empty())
      throw Error(ErrorKind::expectation,
                  "{}: a distance differs from the reference implementation; nothing was timed",
                  method);
  };
  check("fastable-online", 200);
  check("fastable", 200);
  check("openable", 2);
  // The filter reads the same z-scores.
  const bool has_scores =
      std::ranges::count(methods, "zscore") + std::ranges::count(methods, "filter") > 0;
  if (has_scores && has_whole_ring(example)) check_scores(example, monitor);
}

BenchResult bench_matching(const MatchingBenchSettings& settings,
                           const std::optional<RecordedCodes>& recorded, uint64_t seed,
                           const Monitor& monitor) {
  check_settings(settings);
  BenchResult result{"matching", value_to_json(settings)};
  const Effort effort{settings.seconds};
  const std::vector<std::string> methods = timed_methods(settings);
  StepCounter counter(monitor, "measure",
                      settings.databases.size() * settings.window_lengths.size() *
                          settings.query_frames.size() * methods.size());
  for (const uint64_t frames : settings.databases)
    for (const uint64_t query : settings.query_frames) {
      std::optional<BenchFrames> data;
      for (const uint64_t length : settings.window_lengths) {
        if (const std::string reason = obstacle(settings, recorded, frames, length, query);
            !reason.empty()) {
          result.left_out.push_back(reason);
          continue;
        }
        if (!data) data = make_frames(settings, recorded, frames, query, seed);
        const MatchingCase example = make_case(data->train.rows(), data->query.rows(),
                                               {length, settings.ring_bytes, settings.lsh, seed});
        check_methods(example, methods, monitor);
        for (const std::string& method : methods) {
          counter.add();
          if (method == "zscore" && !has_whole_ring(example)) {
            result.left_out.push_back(
                fmt::format("zscore for {} frames, whose scores exceed ring_bytes {}", frames,
                            settings.ring_bytes));
            continue;
          }
          BenchRow row{method, parameters_of(frames, length, query), "query frame"};
          reset_peak_memory();
          find_named(kTimers, "method", method).measure(example, effort, monitor, row);
          row.values.emplace_back("fps", 1000 / row.time.median_ms);
          row.values.emplace_back("cpu_at_10_hz_percent", row.time.median_ms);
          row.values.emplace_back("peak_mib", peak_memory() >> 20);
          result.rows.push_back(std::move(row));
        }
      }
    }
  if (settings.clustered_recognitions > 0)
    result.rows.push_back(time_clustering(settings.clustered_recognitions, effort, seed, monitor));
  add_comparisons(result, settings);
  return result;
}

}  // namespace vpr
