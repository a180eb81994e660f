// Databases of the sequence methods: training, extension with sequences, fusion with FAB-MAP's
// database, and the description of frames like the frames of a database.
#pragma once

#include <string>
#include <vector>

#include "base/monitor.h"
#include "describe/descriptor_rows.h"
#include "sequence/sequence_source.h"
#include "store/sequence_database.h"
#include "words/database.h"

namespace vpr {

/// The description of sequences, and the computations in advance.
struct SequenceTrainSettings {
  std::string descriptor_kind = "ldb+hog";  ///< of descriptor_kinds()
  DescriptorSettings descriptor;
  uint64_t window_length = 40;  ///< c_l of the automatic thresholds
  double safety_factor = 1;     ///< multiplies the automatic thresholds
  bool skip_unreadable = false;
  StatisticsSettings statistics;  ///< the initial statistics of z-scores
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

/// "NAME=FIRST:LAST", a range of the frames of `path`. Throws Error(usage), beginning with `flag`,
/// for other text.
NamedArgument parse_named_range(const std::string& text, const std::filesystem::path& path,
                                const std::string& flag);

/// Describes each sequence and computes the training statistics and, unless is_left_to_queries, the
/// thresholds for settings.window_length. Names must differ. Throws Error(usage) for settings out
/// of range, and what DescriptorKind::describe throws.
SequenceDatabase train_sequences(const std::vector<NamedArgument>& sequences,
                                 const SequenceTrainSettings& settings, const Monitor& monitor);

/// The database with more sequences. Existing frames are not described again. Thresholds are
/// recomputed for the database's window lengths, and statistics with its settings.
SequenceDatabase add_sequences(const SequenceDatabase& database,
                               const std::vector<NamedArgument>& sequences, bool skip_unreadable,
                               const Monitor& monitor);

/// Adds FAB-MAP's description of the training frames, for scores fused with FAB-MAP's
/// (match/fusion.h) and for queries with words. Each training sequence needs a group with the same
/// name, frame names and unreadable frames; its frames may be places or views of one place. Other
/// groups have no effect. The database has statistics (ensure_statistics). Throws Error(data) with
/// `name` for a missing sequence or different frames, and for imported descriptors.
void fuse_views(SequenceDatabase& database, FabmapDatabase fabmap, const std::string& name);

/// FAB-MAP's description of the training frames; null for a database that is not fused.
const FusedViews* fused_views(const SequenceDatabase& database);

/// The frames of a sequence, described like the frames of the database; with their words if the
/// database is fused. Throws what DescriptorKind::describe throws, and Error(data) for images if
/// the database has imported descriptors, or the reverse.
DescriptorSet describe_frames(const SequenceSource& source, const SequenceDatabase& database,
                              bool skip_unreadable, const Monitor& monitor);

/// Descriptors and unreadable frames of every sequence. They point into the database.
std::vector<DescribedFrames> descriptor_spans(const SequenceDatabase& database);

/// The same frames by their LDB codes alone (codes_of): for raw distances, and for properties of
/// training sequences apart from z-scores.
std::vector<DescribedFrames> code_spans(const SequenceDatabase& database);

}  // namespace vpr
