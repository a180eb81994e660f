// Training of the sequence methods: frames to a database with automatic thresholds.
#pragma once

#include <string>
#include <vector>

#include "base/monitor.h"
#include "describe/descriptor_rows.h"
#include "match/row_kernels.h"
#include "sequence/sequence_source.h"
#include "store/sequence_database.h"

namespace vpr {

/// How sequences are described, and what is computed for them in advance.
struct SequenceTrainSettings {
  std::string descriptor_kind = "ldb";  ///< of descriptor_kinds()
  DescriptorSettings descriptor;
  uint64_t window_length = 40;  ///< c_l of the automatic thresholds
  double safety_factor = 1;     ///< multiplies them
  bool skip_unreadable = false;
  StatisticsSettings statistics;  ///< what z-scores start from
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

/// A sequence to open, and what results call it.
struct NamedArgument {
  std::string name;
  SequenceArgument sequence;
};

/// Describes each sequence and computes the thresholds for settings.window_length (unless
/// is_left_to_queries, which is said) and the training statistics. Names must differ. Throws
/// Error(usage) for settings out of range, and what DescriptorKind::describe throws. Warns of
/// sequences shorter than a window.
SequenceDatabase train_sequences(const std::vector<NamedArgument>& sequences,
                                 const SequenceTrainSettings& settings, const RowKernels& kernels,
                                 const Monitor& monitor);

/// The database with more sequences; what it has is not described again. Thresholds are computed
/// again for every window length that it has them for, and statistics with the settings that it
/// has. Descriptors are of the database's kind.
SequenceDatabase add_sequences(const SequenceDatabase& database,
                               const std::vector<NamedArgument>& sequences, bool skip_unreadable,
                               const RowKernels& kernels, const Monitor& monitor);

/// The frames of a sequence, described as the database's are; with the words that they show, where
/// it is fused with FAB-MAP's (run/fuse.h). Throws what DescriptorKind::describe throws, and
/// Error(data) for images where descriptors are imported, or the other way round.
DescriptorSet describe_frames(const SequenceSource& source, const SequenceDatabase& database,
                              bool skip_unreadable, const Monitor& monitor);

/// Descriptors and unreadable frames of every sequence, as the matchers take them. They point into
/// the database.
std::vector<DescriptorSpan> descriptor_spans(const SequenceDatabase& database);

}  // namespace vpr
