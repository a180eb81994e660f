// Automatic t_r of training sequences: from how close different places of them come.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "base/monitor.h"
#include "decide/automatic_threshold.h"
#include "decide/query_settings.h"
#include "match/rows.h"
#include "store/sequence_database.h"

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

/// The automatic t_r of every sequence, from the closest windows and the safety factor of the
/// table; none for a single sequence. Typical distances are those that the database holds, or else
/// computed.
AutomaticThresholds automatic_thresholds(const SequenceDatabase& database, ThresholdTable table,
                                         const Monitor& monitor);

/// Throws Error(usage) if the settings need an automatic t_r and the database has one sequence.
void check_automatic(const SequenceDatabase& database, const SequenceQuerySettings& settings);

/// The same from every table that the database holds.
std::vector<AutomaticThresholds> stored_thresholds(const SequenceDatabase& database,
                                                   const Monitor& monitor);

/// Says which sequences seem to show the same place (overlap_warning).
void warn_of_overlaps(const SequenceDatabase& database, const ThresholdTable& table,
                      const Monitor& monitor);
}  // namespace vpr
