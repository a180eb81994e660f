// The automatic margin and the detection of overlapping sequences: both compare training sequences
// with each other.
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "base/monitor.h"
#include "decide/exclusion_zones.h"
#include "decide/query_settings.h"
#include "match/frame_distances.h"
#include "match/match.h"
#include "match/zscores.h"
#include "store/sequence_database.h"

namespace vpr {

/// Pairs (a, b), a < b, increasing, of sequences that show the same place at least in part. One of
/// the two is a query with windows of 20 frames (or half of the shorter sequence), and at least a
/// tenth of them match the other sequence consistently: the window and the window 10 frames earlier
/// have best matches by z-scores of the whole query (Score::zscore_offline) with margins of at
/// least 3 / sqrt(20), and these matches are 5 to 15 frames apart. (For sequences of one place in
/// different light, seasons and speeds, the share was a third to nine tenths; for different places,
/// at most 1 in 25. Floors with the same rendering are not distinguished.) `radii`: the exclusion
/// radius of every sequence. Longer sequences are compared in evenly spread parts of 1000 frames,
/// at least two per sequence, with at most most_pairs frame pairs in total. Throws
/// Error(interrupted) on a stop.
std::vector<std::pair<size_t, size_t>> find_overlapping_sequences(
    std::span<const DescribedFrames> sequences, const std::vector<uint32_t>& radii,
    const RowKernels& kernels, const Monitor& monitor, size_t most_pairs = size_t{1} << 32);

/// Margins of incorrect best matches, as sums over a window, the largest first. Each training
/// sequence is a query against all sequences of other places, and against its own windows that
/// start at least exclusion_radius + c_l frames before or after the query window. A best
/// match among its own windows is skipped if it is as close as the same place (is_same_place,
/// kOwnDepth). Empty for one short sequence. `basis`: of the z-scores of all sequences; null for
/// distances. Long sequences are compared in parts, with at most most_pairs frame pairs per
/// sequence. Throws Error(interrupted) on a stop.
std::vector<uint32_t> false_margins(std::span<const DescribedFrames> sequences,
                                    const ExclusionZones& zones, const ScoreBasis* basis,
                                    const MatchSettings& settings, const Monitor& monitor,
                                    size_t most_pairs = size_t{1} << 31);

/// The automatic margin X, in score per frame: the largest false margin (they are sorted) plus
/// their mean (rounded down) plus 1, at least the score's least_margin for this typical distance.
/// The smallest value of a row and the smallest of another place are successive order statistics
/// with an exponentially distributed difference (Weissman 1978): the mean is the expected growth of
/// the largest for e times as many false margins. Margins above mean (ln n + 4) are too large for n
/// such values. They come from a place that is shown twice and are ignored.
double automatic_margin(std::span<const uint32_t> false_margins, const ScoreKind& score,
                        double typical_distance, size_t window_length);

/// `depth` of is_same_place: for the closest windows of two sequences, and for a window and its
/// best match in the same sequence (docs/methods.md).
inline constexpr double kPairDepth = 1.2;
inline constexpr double kOwnDepth = 1;

/// Whether two windows with this distance per frame are too close for different places: distance <
/// (1 - depth / sqrt(c_l)) * mean, the mean distance of all frames. Never true for one frame.
bool is_same_place(double frame_distance, double mean_distance, size_t window_length, double depth);

}  // namespace vpr
