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

#include "base/monitor.h"
#include "base/npy.h"
#include "base/output.h"
#include "describe/frame_descriptors.h"
#include "sequence/selection.h"
#include "store/train_statistics.h"

namespace vpr {

/// One training sequence of a database; its descriptors are in the database's store.
struct TrainSequence {
  std::string name;
  std::vector<std::string> frame_names;
  std::vector<size_t> unreadable;  ///< rising
  /// Mean frame distance of its frames that are not neighbors; none before training sets it.
  std::optional<double> typical_distance = std::nullopt;
  /// After how many frames it shows another place; none before training sets it.
  std::optional<size_t> half_width = std::nullopt;
  std::optional<double> fps = std::nullopt;   ///< frames a second, where known
  std::optional<Replay> kept = std::nullopt;  ///< where they are kept ones of a recording
  size_t frame_count() const { return frame_names.size(); }
};

/// The window of another training sequence that is closest to any window of this one. Of a
/// database's only sequence: two windows of its own that show different places, and
/// `other_sequence` is itself.
struct ClosestWindows {
  uint32_t score = 0;  ///< D, summed over the window, or the biased sum of scores
  size_t window = 0;   ///< of this sequence
  size_t other_sequence = 0;
  size_t other_window = 0;
};

/// What automatic thresholds come from, for one window length. `closest` has one entry a training
/// sequence; none where there are no such windows.
struct ThresholdTable {
  size_t window_length = 0;
  double safety_factor = 1;
  std::vector<std::optional<ClosestWindows>> closest;
};

/// All that sequence methods need of training: the content of their database folder.
struct SequenceDatabase {
  DescriptorSettings descriptor;
  std::vector<TrainSequence> sequences;
  DescriptorStore descriptors;  ///< of all sequences, one after the other
  std::vector<ThresholdTable> thresholds;
  std::optional<TrainStatistics> statistics;  ///< none before training sets them
  /// Pairs of sequences that show the same place, a < b, rising; none before training finds them.
  std::optional<std::vector<std::pair<size_t, size_t>>> shared_places;
  std::string fingerprint;  ///< of a stored database; changes with every bit of content
};

/// Every file is verified. Throws Error(input) if it is missing, Error(data) if it is damaged, of
/// another method, of unknown descriptors or of another version.
SequenceDatabase read_sequence_database(const std::filesystem::path& path);

/// Writes a folder that is byte-identical for the same content: no time, host or path in it. The
/// caller commits.
void write_sequence_database(const std::filesystem::path& path, const SequenceDatabase& database,
                             Outputs& outputs);

/// The table for a window length, or null.
const ThresholdTable* find_thresholds(std::span<const ThresholdTable> tables, size_t window_length);

}  // namespace vpr
