// The automatic margin, and whether windows or training sequences show the same place.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "decide/margin_scan.h"
#include "decide/score_kind.h"
#include "match/frame_distances.h"
#include "match/rows.h"
#include "match/zscore_model.h"
#include "store/sequence_database.h"

namespace vpr {

/// Margins of best matches that are wrong, as sums over a window, the largest first: of every
/// training sequence as a query against all that show other places than it, and against its own
/// windows that start half_width + c_l or more frames before or behind. Of the latter those are
/// left out that seem to show the same place after all: whose distance is that of one
/// (is_same_place, kOwnDepth). Nothing is elsewhere in one short walk: then there are none.
/// `basis`: of all sequences, of z-scores; null for distances. Long sequences are
/// compared in stretches, so that of each no more than most_pairs frame pairs are. Throws
/// Error(interrupted) on a stop.
std::vector<uint32_t> false_margins(std::span<const DescriptorSpan> sequences,
                                    const Elsewhere& elsewhere, const ScoreBasis* basis,
                                    const MatchSettings& settings, const Monitor& monitor,
                                    size_t most_pairs = size_t{1} << 31);

/// X in score a frame: just above the largest of the false margins, which are sorted, and a step,
/// their mean (rounded down to a whole sum); but at least what the score says for a training
/// sequence of this typical distance. The least value of a row and the next one of another place
/// are successive order statistics, whose distance is spread exponentially (Weissman 1978): the
/// mean is what the largest of e times as many false margins exceeds that of these by. Margins
/// above mean (ln n + 4) are none of n such ones, but of a place that is shown twice, and do not
/// decide.
double automatic_margin(std::span<const uint32_t> false_margins, const ScoreKind& score,
                        double typical_distance, size_t window_length);

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
