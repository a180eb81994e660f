// Which training walks show the same place? They leave a diagonal of small distances.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "database/sequence_database.h"
#include "matching/frame_distances.h"

namespace vpr {

/// How far below the mean a diagonal must be: the closest of two sequences; and that of a window
/// and its best match in the same sequence (docs/methods.md).
inline constexpr double kPairDepth = 1.2;
inline constexpr double kOwnDepth = 1;

/// Whether a diagonal of window_length frames with this mean distance is too far below what frames
/// of the two walks differ by on average to be chance: distance < (1 - depth / sqrt(c_l)) * mean. A
/// window of one frame never is.
bool is_same_place(double distance_a_frame, double mean_distance, size_t window_length,
                   double depth);

/// One sentence: which pairs of sequences seem to show the same place at their closest windows,
/// with what to do; none if there are no such pairs. The first three pairs are named, with frames
/// by index and name: first and last of each window.
std::optional<std::string> overlap_warning(const ThresholdTable& table,
                                           std::span<const TrainSequence> sequences,
                                           std::span<const DescriptorSpan> spans);

}  // namespace vpr
