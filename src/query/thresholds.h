// Automatic t_r of training sequences, from the closest windows of different places.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/monitor.h"
#include "database/sequence_database.h"
#include "match/match.h"
#include "query/query_settings.h"

namespace vpr {

/// By training sequence; nullopt if there are no such windows.
using ClosestTable = std::vector<std::optional<ClosestWindows>>;

/// For each training sequence, the window of any other sequence that is closest to one of its own
/// windows (paper, section VII-D: training sequences show different places, so windows that are
/// equally close are not recognitions). Ties: smallest own window, then sequence, then window.
/// Nullopt for a single sequence.
ClosestTable find_closest_windows(std::span<const DescribedFrames> sequences,
                                  const MatchSettings& settings, const Monitor& monitor);

/// The closest windows of one length by raw distances.
ThresholdTable compute_thresholds(std::span<const DescribedFrames> sequences, size_t window_length,
                                  double safety_factor, const Monitor& monitor);

/// Whether a comparison of all sequences takes too long for training (more than 2^32 frame pairs).
/// Thresholds are then computed by the first query that needs them.
bool is_left_to_queries(std::span<const DescribedFrames> sequences);

/// The mean distance of frames of one sequence that are not neighbors, in units of frame_distances:
/// the stored one, or else by compute_statistics, with default neighbors and 1000 samples.
double typical_distance(const TrainSequence& stored, const DescribedFrames& sequence,
                        const Monitor& monitor);

/// The automatic t_r of a training sequence on the scale bits (paper, equation (5)): the distance
/// of its closest windows / window_length, times safety_factor. Nullopt without closest windows.
std::optional<double> automatic_threshold(const ThresholdTable& table, size_t sequence);

/// Throws Error(usage) if the settings need an automatic t_r and the database has one sequence.
void check_automatic(const SequenceDatabase& database, const SequenceQuerySettings& settings);

/// Whether two windows with this distance per frame are too close for different places: distance <
/// (1 - 1.2 / sqrt(c_l)) * mean, the mean distance of all frames. Never true for one frame.
bool is_same_place(double frame_distance, double mean_distance, size_t window_length);

/// The pairs of sequences whose closest windows probably show the same place (is_same_place), and
/// advice. The first three pairs are named, with the first and last frames of
/// their windows. Nullopt if there are no such pairs.
std::optional<std::string> overlap_warning(const ThresholdTable& table,
                                           std::span<const TrainSequence> sequences,
                                           std::span<const DescribedFrames> spans);

}  // namespace vpr
