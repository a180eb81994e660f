// Benchmarks as tables, and two runs on one machine compared: what became slower?
#pragma once

#include <string>
#include <vector>

#include "base/json_fwd.h"
#include "bench/bench_result.h"
#include "present/table.h"

namespace vpr {

/// Rows as one table for programs: a column for each parameter or value that any row has.
Table rows_table(const BenchResult& result);

/// Rows as tables for people, at most 120 characters wide with the names and numbers that occur:
/// one for each set of parameters and unit. What all rows share stands in the title, values that
/// most rows lack stand in words.
std::vector<Table> readable_tables(const BenchResult& result);

/// A row that both runs have, by work and parameters.
struct BenchRatio {
  std::string work;
  NamedNumbers parameters;
  double old_ms = 0;
  double new_ms = 0;
  double ratio = 0;  ///< new median / old median: above 1 is slower
  double low = 0;    ///< new lower quartile / old upper quartile
  double high = 0;   ///< new upper quartile / old lower quartile
};

/// What two runs of one benchmark have in common.
struct BenchComparison {
  std::vector<BenchRatio> ratios;        ///< in the order of the old run
  std::vector<std::string> only_in_one;  ///< rows without a partner, in words
};

/// Compares two runs row by row. Throws Error(data) if the two are different benchmarks, or have no
/// row in common.
BenchComparison compare_benches(const BenchResult& older, const BenchResult& newer);

/// Rows that are slower are marked, and those whose ratio is above the factor although their spread
/// reaches down to the old time ("unsure").
Table comparison_table(const BenchComparison& comparison, double factor);
/// The same as vpr.bench-comparison holds it, with all rows in the order of the old run.
Json comparison_json(const BenchComparison& comparison, double factor);

/// Rows that are slower.
size_t count_slower(const BenchComparison& comparison, double factor);

}  // namespace vpr
