// Repeated timing on the steady clock; what a benchmark measured, and its file (vpr.bench/2).
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

/// Order statistics (base/statistics.h) of times in milliseconds, of which there is at least one.
TimeSummary summarise(std::vector<double> times_ms);

/// How long to measure.
struct Effort {
  double seconds = 0.5;    ///< goes on at least so long, ...
  size_t repetitions = 5;  ///< ... and at least so often, ...
  size_t most = 10'000;    ///< ... but not more often
  size_t warm_ups = 1;     ///< runs before, which do not count
};

/// Throws Error(usage) unless a measurement may take so long: above 0, at most an hour.
void check_seconds(double seconds);

/// Milliseconds of each run of `work`. Stops between runs when asked to.
std::vector<double> time_repeatedly(const Effort& effort, const std::function<void()>& work,
                                    const Monitor& monitor);

/// Keeps the process, and threads that it starts from now on, on the first `cores` of its cores, so
/// that the scheduler moves nothing; without effect where it has fewer.
void pin_to_cores(size_t cores);

/// Resets the process's highest resident memory, where the system can (Linux).
void reset_peak_memory();
/// Bytes at most in memory since; 0 where it is not known.
size_t peak_memory();
/// Bytes that the system could still give; 0 where it is not known.
size_t available_memory();

/// Names and numbers, in the order in which they are shown.
using NamedNumbers = std::vector<std::pair<std::string, double>>;

/// One measurement.
struct BenchRow {
  std::string work;         ///< what was timed: "fastable-online", "surf", ...
  NamedNumbers parameters;  ///< with `work`, they name the row
  std::string per;          ///< a time is per "query frame", "frame", ...
  TimeSummary time;
  NamedNumbers values;  ///< what else was found out: recall, memory, ...
  std::string note;     ///< in words: sampled, left out, ...

  double parameter(const std::string& name) const;  ///< 0 if there is none
};

/// The first number of a name; nothing where no number has it.
std::optional<double> find_number(const NamedNumbers& numbers, const std::string& name);

/// What one command of vpr-bench measured.
struct BenchResult {
  std::string bench;
  Json settings;
  std::vector<BenchRow> rows;
  std::vector<std::string> left_out;  ///< sentences: what was not measured, and why
  std::vector<Chart> charts;
};

/// Adds `name`, how many times faster a row is than the one of `slower` with its parameters, to the
/// values of every row of `work`.
void add_speed_up(BenchResult& result, const std::string& work, const std::string& slower,
                  const std::string& name);

/// The row with this work and these parameters, or null.
const BenchRow* find_row(const BenchResult& result, const std::string& work,
                         const NamedNumbers& parameters);

/// Settings, rows, omitted measurements, provenance and machine.
Json bench_json(const BenchResult& result, const RunInfo& run);

/// Rows and name of a stored benchmark. Throws Error(input) if the file cannot be read, Error(data)
/// if it is not a benchmark or is damaged.
BenchResult read_bench(const std::filesystem::path& path);

}  // namespace vpr
