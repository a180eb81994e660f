// Benchmarks as tables.
#pragma once

#include <vector>

#include "bench/bench_result.h"
#include "report/table.h"

namespace vpr {

/// Rows as one table for programs: a column for each parameter or value that any row has.
Table rows_table(const BenchResult& result);

/// Rows as tables for people, at most 120 characters wide with the names and numbers that occur:
/// one for each set of parameters and unit. What all rows share stands in the title, values that
/// most rows lack stand in words.
std::vector<Table> readable_tables(const BenchResult& result);

}  // namespace vpr
