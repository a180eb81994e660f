// What every benchmark gives: rows of times, and the paper's numbers beside ours.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "base/json.h"
#include "bench/measure.h"
#include "report/plot.h"
#include "report/table.h"

namespace vpr {

/// Names and numbers, in the order in which they are shown.
using NamedNumbers = std::vector<std::pair<std::string, double>>;

struct BenchRow {
  std::string work;         ///< what was timed: "fastable", "surf", ...
  NamedNumbers parameters;  ///< with `work`, they name the row
  std::string per;          ///< a time is per "query frame", "frame", ...
  TimeSummary time;
  NamedNumbers values;  ///< what else was found out: recall, memory, ...
  std::string note;     ///< in words: sampled, left out, ...

  double parameter(const std::string& name) const;  ///< 0 if there is none
};

/// A number of the paper, and ours in its place.
struct PaperNumber {
  std::string table;  ///< "tab6", ...
  std::string what;
  NamedNumbers parameters;
  std::string unit;
  double paper = 0;
  double ours = 0;
};

struct BenchResult {
  std::string bench;
  Json settings;
  std::vector<BenchRow> rows;
  std::vector<std::string> left_out;  ///< sentences: what was not measured, and why
  std::vector<PaperNumber> paper;
  std::vector<Plot> plots;
};

/// Adds `name`, how many times faster a row is than the one of `slower` with its parameters, to the
/// values of every row of `work`.
void add_speed_up(BenchResult& result, const std::string& work, const std::string& slower,
                  const std::string& name);

/// Rows as a table: one column a parameter or value that any row has.
Table rows_table(const BenchResult& result);

/// The paper's numbers beside ours; nothing if there are none.
Table paper_table(const BenchResult& result);

/// The median of the row with this work and these parameters, or nothing.
std::optional<double> find_median(const BenchResult& result, const std::string& work,
                                  const NamedNumbers& parameters);

}  // namespace vpr
