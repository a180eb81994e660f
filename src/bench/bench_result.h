// What every benchmark gives: rows of times, and the paper's numbers beside ours.
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

/// A number of the paper, and ours in its place.
struct PaperNumber {
  std::string table;  ///< "tab6", ...
  std::string what;
  NamedNumbers parameters;
  std::string unit;
  double paper = 0;
  double ours = 0;
  double low = 0;   ///< ours by quartiles: of a time the lower one, of a ratio the least of both
  double high = 0;  ///< the upper one
  std::string our_work;  ///< the row that stands in its place
};

/// What one command of vpr-bench measured.
struct BenchResult {
  std::string bench;
  Json settings;
  std::vector<BenchRow> rows;
  std::vector<std::string> left_out;  ///< sentences: what was not measured, and why
  std::vector<PaperNumber> paper;
  std::vector<Chart> charts;
};

/// Adds `name`, how many times faster a row is than the one of `slower` with its parameters, to the
/// values of every row of `work`.
void add_speed_up(BenchResult& result, const std::string& work, const std::string& slower,
                  const std::string& name);

/// The row with this work and these parameters, or null.
const BenchRow* find_row(const BenchResult& result, const std::string& work,
                         const NamedNumbers& parameters);

/// A time of the paper, and that of one of our rows.
PaperNumber paper_time(const std::string& table, const std::string& what, double paper_ms,
                       const BenchRow& row);
/// A ratio of the paper, and how many times `row` is as fast as `slower`.
PaperNumber paper_ratio(const std::string& table, const std::string& what, double paper,
                        const BenchRow& row, const BenchRow& slower);

}  // namespace vpr
