// Training of the sequence methods: frames to a database with automatic thresholds.
#pragma once

#include <string>
#include <vector>

#include "base/monitor.h"
#include "database/sequence_database.h"
#include "descriptors/descriptor_rows.h"
#include "images/sequence_argument.h"
#include "matching/row_kernels.h"
#include "recognition/result.h"

namespace vpr {

struct SequenceTrainSettings {
  std::string descriptor_kind = "ldb";  ///< of descriptor_kinds()
  DescriptorSettings descriptor;
  uint64_t window_length = 40;  ///< c_l of the automatic thresholds
  double safety_factor = 1;     ///< multiplies them
  bool skip_unreadable = false;
  StatisticsSettings statistics;  ///< what standardized scores start from
};

template <class Visitor>
void visit_fields(SequenceTrainSettings& settings, Visitor&& visit) {
  visit("descriptor", settings.descriptor_kind);
  visit_fields(settings.descriptor, visit);
  visit("c_l", settings.window_length);
  visit("safety_factor", settings.safety_factor);
  visit("skip_unreadable", settings.skip_unreadable);
  visit("statistics", settings.statistics);
}

struct NamedArgument {
  std::string name;
  SequenceArgument sequence;
};

/// Describes each sequence and computes the thresholds for settings.window_length (unless
/// is_left_to_queries, which is said) and the training statistics. Names must differ. Throws
/// Error(usage) for settings out of range, and what DescriptorKind::describe throws. Warns of
/// overlapping sequences, and of those shorter than a window.
SequenceDatabase train_sequences(const std::vector<NamedArgument>& sequences,
                                 const SequenceTrainSettings& settings, const RowKernels& kernels,
                                 const Monitor& monitor);

/// The database with more sequences; what it has is not described again. Thresholds are computed
/// again for every window length that it has them for, and statistics with the settings that it
/// has. Descriptors are of the database's kind.
SequenceDatabase add_sequences(const SequenceDatabase& database,
                               const std::vector<NamedArgument>& sequences, bool skip_unreadable,
                               const RowKernels& kernels, const Monitor& monitor);

/// The frames of a sequence, described as the database's are. Throws what DescriptorKind::describe
/// throws.
DescriptorSet describe_frames(const Sequence& sequence, const SequenceDatabase& database,
                              bool skip_unreadable, const Monitor& monitor);

/// Whether comparing all sequences with each other takes longer than training should (2^32 frame
/// pairs and more): then thresholds are computed when a query asks for them.
bool is_left_to_queries(std::span<const DescriptorSpan> sequences);

/// The automatic t_r of one sequence, by the score that is set and from the closest windows by this
/// score; none if the sequence has no window. Its typical distance is the one that the database
/// holds, or else computed.
std::optional<AutomaticThreshold> sequence_threshold(const SequenceDatabase& database,
                                                     const ThresholdTable& table, size_t sequence,
                                                     SequenceQuerySettings settings,
                                                     const Monitor& monitor);

/// The scale of the automatic t_r of all its sequences.
ThresholdScale automatic_scale(const SequenceDatabase& database,
                               const SequenceQuerySettings& settings);

/// Says which sequences seem to show the same place (overlap_warning).
void warn_of_overlaps(const SequenceDatabase& database, const ThresholdTable& table,
                      const Monitor& monitor);

/// Where automatic thresholds give no hits: the same, by the closest windows that the database
/// holds for this window length, or else computed, unless is_left_to_queries.
void explain_no_hits(const SequenceDatabase& database, size_t window_length,
                     const RowKernels& kernels, const Monitor& monitor);

/// Closest windows for one window length.
ThresholdTable compute_thresholds(const SequenceDatabase& database, size_t window_length,
                                  double safety_factor, const RowKernels& kernels,
                                  const Monitor& monitor);

/// Descriptors and unreadable frames of every sequence, as the matchers take them. They point into
/// the database.
std::vector<DescriptorSpan> code_spans(const SequenceDatabase& database);

/// Throws Error(usage) unless 1 <= c_l <= kMaxWindowLength.
void check_window_length(uint64_t window_length);
/// Throws Error(usage) unless the factor is finite and above 0.
void check_safety_factor(double factor);

}  // namespace vpr
