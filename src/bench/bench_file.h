// Benchmarks as files (vpr.bench/2).
#pragma once

#include <filesystem>

#include "base/json_fwd.h"
#include "bench/bench_result.h"
#include "report/run_info.h"

namespace vpr {

/// Settings, rows, omitted measurements, provenance and machine.
Json bench_json(const BenchResult& result, const RunInfo& run);

/// Rows and name of a stored benchmark. Throws Error(input) if the file cannot be read, Error(data)
/// if it is not a benchmark or is damaged.
BenchResult read_bench(const std::filesystem::path& path);

}  // namespace vpr
