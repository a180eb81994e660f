// Ground truth of VPR-Bench.
#pragma once

#include <filesystem>
#include <string>

#include "base/output_file.h"

namespace vpr {

struct FileStart;
struct InspectedGroundTruth;
struct Monitor;
class GroundTruthBuilder;

/// ground_truth_new.npy: an array of Python objects with a row (query, list of references) for
/// every query (Zaffar et al., VPR-Bench); or, as GSV-Cities stores it, one list or array of
/// references for every query. Parsed as pickle.h says, never executed. Exactly one searched
/// sequence. Throws Error(data), naming the row.
std::string read_vpr_bench(GroundTruthBuilder& builder);

bool is_vpr_bench(const FileStart& start);

/// What is ignored becomes different.
void write_vpr_bench(const InspectedGroundTruth& ground_truth, OutputFile& file,
                     const Monitor& monitor);

}  // namespace vpr
