// Databases of the sequence methods: training, extension with sequences, and the description of
// frames like the frames of a database.
#pragma once

#include <string>
#include <vector>

#include "base/monitor.h"
#include "database/descriptor_rows.h"
#include "database/sequence_database.h"
#include "recordings/sequence_source.h"

namespace vpr {

/// The description of sequences, and the computations in advance.
struct SequenceTrainSettings {
  std::string descriptor_kind = "ldb+hog";  ///< of descriptor_kinds()
  DescriptorSettings descriptor;
  uint64_t window_length = 40;  ///< c_l of the automatic thresholds
  double safety_factor = 1;     ///< multiplies the automatic thresholds
  bool skip_unreadable = false;
  Witness features = Witness::orb;  ///< of keyframes, for queries with a witness
  StatisticsSettings statistics;    ///< the initial statistics of z-scores
};

template <class Visitor>
void visit_fields(SequenceTrainSettings& settings, Visitor&& visit) {
  visit("descriptor", settings.descriptor_kind, "Descriptor of the frames.");
  visit_fields(settings.descriptor, visit);
  visit("c_l", settings.window_length, "Window of the automatic t_r.", at_least(1));
  visit("safety_factor", settings.safety_factor, "Multiplies the automatic t_r.");
  visit("skip_unreadable", settings.skip_unreadable);
  visit("features", settings.features, "Local features of keyframes, for the filter.");
  visit("statistics", settings.statistics, "Training statistics.");
}

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

enum class FeatureTime { now, later };

/// The frames of a sequence, described like the frames of the database. Throws what
/// DescriptorKind::describe throws, and Error(data) for images if the database has imported
/// descriptors, or the reverse. `choose`: the frames that get features; null: none. Later, only
/// features_of is set: images are decoded again, and features of a video are those of the last
/// chosen frame.
DescriptorSet describe_frames(const SequenceSource& source, const SequenceDatabase& database,
                              bool skip_unreadable, const Monitor& monitor,
                              const FeatureChoice& choose = {},
                              FeatureTime time = FeatureTime::now);

/// Descriptors and unreadable frames of every sequence. They point into the database.
std::vector<DescribedFrames> descriptor_spans(const SequenceDatabase& database);

/// The same frames by their LDB codes alone (codes_of): for raw distances, and for properties of
/// training sequences apart from z-scores.
std::vector<DescribedFrames> code_spans(const SequenceDatabase& database);

}  // namespace vpr
