// What writers of ground truth share.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace vpr {

class Output;
struct InspectedGroundTruth;
struct Monitor;

/// The index of the one sequence that was searched. Throws Error(usage) if there are more, or none.
size_t only_written_sequence(const InspectedGroundTruth& ground_truth, std::string_view format);

/// Checks a size before anything is written. Throws Error(data) if there are more than `most` of
/// `what`, such as "pairs".
void require_writable(uint64_t count, uint64_t most, std::string_view what);

/// Writes `text` and empties it once it is long: a query may have a line for every reference.
/// Throws Error(interrupted) on a stop.
void write_piece(Output& file, std::string& text, const Monitor& monitor);

}  // namespace vpr
