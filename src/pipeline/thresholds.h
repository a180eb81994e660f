// Automatic t_r of training sequences: from how close different places of them come.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "base/monitor.h"
#include "database/sequence_database.h"
#include "matching/rows.h"
#include "recognition/query_settings.h"

namespace vpr {

/// Closest windows of one length, and the t_r of each sequence; none for one that has no window.
struct AutomaticThresholds {
  ThresholdTable table;
  std::vector<std::optional<AutomaticThreshold>> sequences;
};

/// Whether comparing all sequences with each other takes longer than training should (2^32 frame
/// pairs and more): then thresholds are computed when a query asks for them.
bool is_left_to_queries(std::span<const DescriptorSpan> sequences);

/// Closest windows for one window length, by raw distances.
ThresholdTable compute_thresholds(std::span<const DescriptorSpan> sequences, size_t window_length,
                                  double safety_factor, const RowKernels& kernels,
                                  const Monitor& monitor);

/// How close training sequences come to each other, by the score that is set; settings give c_l.
ThresholdTable closest_windows(const SequenceDatabase& database,
                               const SequenceQuerySettings& settings, const MatchSettings& match,
                               const Monitor& monitor);

/// The automatic t_r of every sequence, by the score that is set and from the closest windows by
/// this score. Typical distances are those that the database holds, or else computed.
AutomaticThresholds automatic_thresholds(const SequenceDatabase& database, ThresholdTable table,
                                         const SequenceQuerySettings& settings,
                                         const Monitor& monitor);

/// The same from every table that the database holds.
std::vector<AutomaticThresholds> stored_thresholds(const SequenceDatabase& database,
                                                   const Monitor& monitor);

/// The scale of the automatic t_r of a database of so many sequences.
ThresholdScale automatic_scale(size_t sequences, const SequenceQuerySettings& settings);

/// Says which sequences seem to show the same place (overlap_warning).
void warn_of_overlaps(const SequenceDatabase& database, const ThresholdTable& table,
                      const Monitor& monitor);

/// Where automatic thresholds give no hits: the same, by the closest windows that the database
/// holds for this window length, or else computed, unless is_left_to_queries.
void explain_no_hits(const SequenceDatabase& database, size_t window_length,
                     const RowKernels& kernels, const Monitor& monitor);

}  // namespace vpr
