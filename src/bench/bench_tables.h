// Benchmark results as tables, and the comparison of two runs on one machine.
#pragma once

#include <string>
#include <vector>

#include "base/json_fwd.h"
#include "bench/bench_result.h"
#include "present/table.h"

namespace vpr {

/// All rows as one table for programs, with a column for each parameter or value of any row.
Table rows_table(const BenchResult& result);

/// The rows as tables for people, at most 120 characters wide for all current names and values: one
/// table per unit and set of parameters. The title holds what all rows share; rare values become
/// text.
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
