// Labelled pairs of frames as CSV.
#pragma once

#include "ground_truth/formats.h"

namespace vpr {

/// Header query,reference[,label] or query,sequence,reference[,label]; label "same" (default) or
/// "ignore"; pairs that are not listed are different. A frame is its number, or, where the scope
/// knows names, the name of its file, with or without extension; digits alone are a number. Without
/// a sequence column, exactly one searched sequence. The path may end in a range
/// (pairs.csv@60:111), of which the query's frames count, in its steps; pairs of others are left
/// out. Throws Error(data), naming the line.
std::string read_pairs_csv(GroundTruthBuilder& builder);

bool is_pairs_csv(const FileStart& start);

/// One line a pair, tolerance applied; columns sequence and label only where they say something.
void write_pairs_csv(const InspectedGroundTruth& ground_truth, Output& file,
                     const Monitor& monitor);

}  // namespace vpr
