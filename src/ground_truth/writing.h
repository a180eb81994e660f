// What writers of ground truth share.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace vpr {

class OutputFile;
struct InspectedGroundTruth;
struct Monitor;

/// The index of the one sequence that was searched. Throws Error(usage) if there are more, or none.
size_t only_written_sequence(const InspectedGroundTruth& ground_truth, std::string_view format);

/// Writes `text` and empties it once it is long: a query may have a line for every reference.
/// Throws Error(interrupted) on a stop.
void write_piece(OutputFile& file, std::string& text, const Monitor& monitor);

}  // namespace vpr
