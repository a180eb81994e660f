// Ground truth of the OpenSeqSLAM 2.0 toolbox as CSV.
#pragma once

#include "ground_truth/formats.h"

namespace vpr {

/// No header; query, reference and, if it is there, tolerance, counted from 1: references within
/// the tolerance of the pair show the same place, cut off at either end of the sequence.
/// Source: how the toolbox's ground truth window fills its matrix from a CSV file. Exactly one
/// searched sequence. Throws Error(data), naming the line.
std::string read_openseqslam_csv(GroundTruthBuilder& builder);

/// Whether the first line holds two or three whole numbers with commas between them.
bool is_openseqslam_csv(const FileStart& start);

/// One line for every run of references with a common tolerance; runs of even length take two.
void write_openseqslam_csv(const InspectedGroundTruth& ground_truth, OutputFile& file,
                           const Monitor& monitor);

}  // namespace vpr
