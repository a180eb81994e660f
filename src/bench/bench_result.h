// Repeated timing on the steady clock, and the results of a benchmark: files (vpr.bench/3), tables,
// and the comparison of two runs on one machine.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/json.h"
#include "base/monitor.h"
#include "present/chart.h"
#include "present/table.h"
#include "query/run_info.h"

namespace vpr {

/// Repeated measurements of one time, in milliseconds.
struct TimeSummary {
  double median_ms = 0;
  double lower_quartile_ms = 0;
  double upper_quartile_ms = 0;
  double least_ms = 0;
  double most_ms = 0;
  size_t repetitions = 0;
};

/// Order statistics (base/statistics.h) of times in milliseconds; `times_ms` must not be empty.
TimeSummary summarize(std::vector<double> times_ms);

/// The length of a measurement.
struct Effort {
  double seconds = 0.5;    ///< at least this time, ...
  size_t repetitions = 5;  ///< ... and at least this number of repetitions, ...
  size_t most = 10'000;    ///< ... but at most this number
};

/// Throws Error(usage) unless the time of a measurement is above 0 and at most one hour.
void check_seconds(double seconds);

/// Throws Error(usage) for no values, and for a value outside [low, high].
void check_values(std::string_view name, const std::vector<uint64_t>& values, uint64_t low,
                  uint64_t high);

/// The time of `work`, which processes `units` units, per unit. The first run is not timed. Stops
/// between runs if the user wants to stop.
TimeSummary time_repeatedly(const Effort& effort, const std::function<void()>& work,
                            const Monitor& monitor, double units = 1);

/// Pins the process and its future threads to its first `cores` cores, so that the scheduler does
/// not move them. No effect if the process has fewer cores.
void pin_to_cores(size_t cores);

/// Resets the peak resident memory of the process, if the system supports this (Linux).
void reset_peak_memory();
/// Peak resident memory since the reset, in bytes; 0 if unknown.
size_t peak_memory();
/// Available memory of the system in bytes; 0 if unknown.
size_t available_memory();

/// A parameter or value with its name.
struct NamedNumber {
  std::string name;
  double value = 0;

  template <class T>
  NamedNumber(std::string number_name, T number)
      : name(std::move(number_name)), value(static_cast<double>(number)) {}
  bool operator==(const NamedNumber&) const = default;
};
using NamedNumbers = std::vector<NamedNumber>;  ///< in the order of display

/// One measurement.
struct BenchRow {
  std::string work;         ///< the timed work: "fastable-online", "surf", ...
  NamedNumbers parameters;  ///< together with `work`, they identify the row
  std::string per;          ///< the unit of work: "query frame", "frame", ...
  TimeSummary time = {};
  NamedNumbers values = {};  ///< other measured values: recall, memory, ...
  std::string note = {};     ///< a remark: sampled, omitted, ...
};

/// The first number with this name, or nullopt.
std::optional<double> find_number(const NamedNumbers& numbers, const std::string& name);

/// The results of one command of vpr-bench.
struct BenchResult {
  std::string bench;
  Json settings = {};
  std::vector<BenchRow> rows = {};
  std::vector<std::string> left_out = {};  ///< one sentence per omitted measurement: the reason
  std::vector<Chart> charts = {};
};

/// The row, or null.
const BenchRow* find_row(const BenchResult& result, const std::string& work,
                         const NamedNumbers& parameters);

/// One series per work: the times of its rows by parameter `x`, for rows with the parameters
/// `fixed`. Omits empty series.
std::vector<Series> time_series(const BenchResult& result, const std::vector<std::string>& works,
                                const std::string& x, const NamedNumbers& fixed);

/// Numbers as an object with their names as keys.
inline auto numbers_field(NamedNumbers& numbers) {
  return CustomField{[&](Json& json, const std::string& key) {
                       json[key] = Json::object();
                       for (const auto& [name, value] : numbers) json[key][name] = value;
                     },
                     [&](const Fields& fields, const std::string& key) {
                       const Fields object = fields.object(key);
                       for (const auto& item : object.json().items()) {
                         double value = 0;
                         object.read(item.key(), value);
                         numbers.emplace_back(item.key(), value);
                       }
                     }};
}
/// As which the schema describes it.
using NumbersByName = std::map<std::string, double>;

/// Settings, rows, omitted measurements, provenance and machine. The schemas are for docs/schemas.
Json bench_json(const BenchResult& result, const RunInfo& run);
Json bench_schema();
Json bench_comparison_schema();

/// A stored benchmark, without its settings. Throws Error(input) if the file cannot be read,
/// Error(data) if it is not a benchmark or is damaged.
BenchResult read_bench(const std::filesystem::path& path);

/// All rows as one table for programs, with a column for each parameter or value of any row.
Table rows_table(const BenchResult& result);

/// The rows as tables for people, at most 120 characters wide for all current names and values: one
/// table per unit and set of parameters. Equal parameters are in the title, rare values in the last
/// column.
std::vector<Table> readable_tables(const BenchResult& result);

/// A row that both runs contain, by work and parameters.
struct BenchRatio {
  std::string work;
  NamedNumbers parameters;
  double old_ms = 0;
  double new_ms = 0;
  double ratio = 0;  ///< new median / old median: above 1 is slower
  double low = 0;    ///< new lower quartile / old upper quartile
  double high = 0;   ///< new upper quartile / old lower quartile
};

/// The common rows of two runs of one benchmark.
struct BenchComparison {
  std::vector<BenchRatio> ratios;        ///< in the order of the old run
  std::vector<std::string> only_in_one;  ///< descriptions of rows without a counterpart
};

/// Compares two runs row by row. Throws Error(data) if they are different benchmarks or have no
/// common row.
BenchComparison compare_benches(const BenchResult& older, const BenchResult& newer);

/// Marks slower rows, and rows with a ratio above the factor whose quartiles include the old time
/// ("unsure").
Table comparison_table(const BenchComparison& comparison, double factor);
/// The comparison as vpr.bench-comparison, with all rows in the order of the old run.
Json comparison_json(const BenchComparison& comparison, double factor);

size_t count_slower(const BenchComparison& comparison, double factor);

}  // namespace vpr
