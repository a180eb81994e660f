// Which query frame shows the same place as which training frame: same, different, or ignore.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "images/dataset.h"

namespace vpr {

enum class PlaceLabel { different, same, ignore };

/// What indices mean: the training sequences of a result, in its order, and its query.
struct GroundTruthScope {
  struct TrainSequence {
    std::string name;
    size_t frames = 0;
    bool searched = true;  ///< pairs of a sequence that was not searched are left out
  };
  size_t query_frames = 0;
  std::vector<TrainSequence> sequences;
};

/// Three-valued, by frames (not windows).
struct GroundTruth {
  struct Pair {
    uint32_t sequence = 0;
    uint32_t reference = 0;
    PlaceLabel label = PlaceLabel::same;

    auto operator<=>(const Pair&) const = default;
  };
  /// Per query frame, sorted.
  std::vector<std::vector<Pair>> pairs;
  int64_t tolerance_frames = 0;
  std::string protocol;  ///< in words, for reports

  /// Same, if a `same` pair is at most tolerance_frames away from `reference`; otherwise the label
  /// of an `ignore` pair that is exactly this one; otherwise different.
  PlaceLabel label(size_t query, size_t sequence, size_t reference) const;
  /// Whether any frame of the searched sequences shows the query frame's place.
  bool has_match(size_t query) const;
};

/// Reads what `argument` names:
/// - "aligned": frame i is frame i, within the tolerance; exactly one searched sequence.
/// - "pairs": CSV with header query,reference[,label] or query,sequence,reference[,label], label
///   "same" (default) or "ignore". Without a sequence column, exactly one searched sequence.
/// Throws Error(usage) where there are several sequences or the format is unknown, Error(input) if
/// the file can't be read, Error(data), naming the line, if it is damaged, an index is out of range
/// or a pair has both labels.
GroundTruth read_ground_truth(const GroundTruthArgument& argument, const GroundTruthScope& scope);

/// `text` as --ground-truth takes it: the word aligned, or a pairs file.
GroundTruthArgument parse_ground_truth_argument(const std::string& text, int tolerance_frames);

}  // namespace vpr
