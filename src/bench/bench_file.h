// Benchmarks as files (vpr.bench/2, and version 1).
#pragma once

#include <filesystem>

#include "base/json_fwd.h"
#include "bench/bench_result.h"
#include "report/run_info.h"

namespace vpr {

/// A benchmark as vpr.bench holds it: settings, rows, what was left out, the paper's numbers,
/// provenance and machine.
Json bench_json(const BenchResult& result, const RunInfo& run);

/// Rows and name of a stored benchmark, of this version or of version 1. Throws Error(input) if it
/// can't be read, Error(data) if it is none, or damaged.
BenchResult read_bench(const std::filesystem::path& path);

}  // namespace vpr
