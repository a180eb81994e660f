// The database of the sequence methods (OpenABLE, FastABLE, LSH): descriptors of training
// sequences.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/output.h"
#include "database/frame_descriptors.h"
#include "database/keyframe_features.h"
#include "database/train_statistics.h"
#include "recordings/sequence.h"

namespace vpr {

/// One training sequence of a database; the database's store holds its descriptors.
struct TrainSequence {
  Sequence sequence;
  /// Mean distance of its frames, except between neighbors; unset before training.
  std::optional<double> typical_distance = std::nullopt;
  /// Frames farther apart show different places; unset before training.
  std::optional<size_t> exclusion_radius = std::nullopt;
  std::string path = {};  ///< from which it was read, which is not content; empty: unknown
};

/// The window of another training sequence that is closest to any window of this one.
struct ClosestWindows {
  uint32_t score = 0;  ///< D, summed over the window, or the biased sum of scores
  size_t window = 0;   ///< of this sequence
  size_t other_sequence = 0;
  size_t other_window = 0;
};

template <class Visitor>
void visit_fields(ClosestWindows& closest, Visitor&& visit) {
  visit("distance", closest.score, "Sum over the window.");
  visit("window", closest.window, "First frame, from 0.");
  visit("other_sequence", closest.other_sequence, "Target, from 0.");
  visit("other_window", closest.other_window, "First frame, from 0.");
}

/// The basis of automatic thresholds for one window length. `closest` has one entry per training
/// sequence: nullopt if no other sequence has a window.
struct ThresholdTable {
  size_t window_length = 0;
  double safety_factor = 1;
  std::vector<std::optional<ClosestWindows>> closest;
};

template <class Visitor>
void visit_fields(ThresholdTable& table, Visitor&& visit) {
  visit("c_l", table.window_length, "Window length in frames.");
  visit("safety_factor", table.safety_factor, "Multiplies the automatic t_r.");
  visit("closest", table.closest,
        "For each training sequence, its window that comes closest to another sequence; null where "
        "there is no such pair.");
}

/// The content of a database folder: all training data of the sequence methods.
struct SequenceDatabase {
  DescriptorSettings descriptor;
  std::vector<TrainSequence> sequences;
  DescriptorStore descriptors;  ///< of all sequences, one after the other
  std::vector<ThresholdTable> thresholds;
  std::optional<TrainStatistics> statistics;  ///< unset before training
  /// Pairs of sequences that show the same place, a < b, increasing; unset before training.
  std::optional<std::vector<std::pair<size_t, size_t>>> overlapping_sequences;
  std::optional<std::vector<RepeatedPlace>> repeated_places;  ///< increasing; unset: unknown
  std::optional<KeyframeFeatures> features;  ///< of keyframes; unset: they were not computed
  std::string fingerprint;  ///< of a stored database; changes with every bit of content
};

/// Verifies every file. Throws Error(input) if a file is missing; Error(data) if it is damaged or
/// belongs to another method, unknown descriptors or another version.
SequenceDatabase read_sequence_database(const std::filesystem::path& path);

/// Writes a folder that is byte-identical for equal content, except paths.txt: it holds no time or
/// host. The caller commits.
void write_sequence_database(const std::filesystem::path& path, const SequenceDatabase& database,
                             Outputs& outputs);

/// The fingerprint that the database has once it is written.
std::string database_fingerprint(const SequenceDatabase& database);
Json sequence_manifest_schema();

/// The names of the training sequences.
std::vector<std::string> names_of(const SequenceDatabase& database);

/// The table for this window length, or null.
const ThresholdTable* find_thresholds(std::span<const ThresholdTable> tables, size_t window_length);

}  // namespace vpr
