// Repeated timing on the steady clock, and the results of a benchmark with their file
// (vpr.bench/2).
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/json.h"
#include "base/monitor.h"
#include "present/chart.h"
#include "present/run_info.h"

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
  size_t warm_ups = 1;     ///< untimed runs at the beginning
};

/// Throws Error(usage) unless the time of a measurement is above 0 and at most one hour.
void check_seconds(double seconds);

/// The time of each run of `work` in milliseconds. Stops between runs if the user wants to stop.
std::vector<double> time_repeatedly(const Effort& effort, const std::function<void()>& work,
                                    const Monitor& monitor);

/// Pins the process and its future threads to its first `cores` cores, so that the scheduler does
/// not move them. No effect if the process has fewer cores.
void pin_to_cores(size_t cores);

/// Resets the peak resident memory of the process, if the system supports this (Linux).
void reset_peak_memory();
/// Peak resident memory since the reset, in bytes; 0 if unknown.
size_t peak_memory();
/// Available memory of the system in bytes; 0 if unknown.
size_t available_memory();

/// Names with numbers, in the order of display.
using NamedNumbers = std::vector<std::pair<std::string, double>>;

/// One measurement.
struct BenchRow {
  std::string work;         ///< the timed work: "fastable-online", "surf", ...
  NamedNumbers parameters;  ///< together with `work`, they identify the row
  std::string per;          ///< the unit of work: "query frame", "frame", ...
  TimeSummary time;
  NamedNumbers values;  ///< other measured values: recall, memory, ...
  std::string note;     ///< a remark: sampled, omitted, ...

  double parameter(const std::string& name) const;  ///< 0 if missing
};

/// The first number with this name, or nullopt.
std::optional<double> find_number(const NamedNumbers& numbers, const std::string& name);

/// The results of one command of vpr-bench.
struct BenchResult {
  std::string bench;
  Json settings;
  std::vector<BenchRow> rows;
  std::vector<std::string> left_out;  ///< one sentence per omitted measurement, with the reason
  std::vector<Chart> charts;
};

/// Adds the value `name` to every row of `work`: the speed-up over the row of `slower` with the
/// same parameters.
void add_speed_up(BenchResult& result, const std::string& work, const std::string& slower,
                  const std::string& name);

const BenchRow* find_row(const BenchResult& result, const std::string& work,
                         const NamedNumbers& parameters);

/// Settings, rows, omitted measurements, provenance and machine.
Json bench_json(const BenchResult& result, const RunInfo& run);

/// Rows and name of a stored benchmark. Throws Error(input) if the file cannot be read, Error(data)
/// if it is not a benchmark or is damaged.
BenchResult read_bench(const std::filesystem::path& path);

}  // namespace vpr
