// The result of every benchmark: rows of times.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/json.h"
#include "bench/measure.h"
#include "report/chart.h"

namespace vpr {

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

}  // namespace vpr
