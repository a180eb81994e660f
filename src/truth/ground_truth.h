// Which query frame shows the same place as which training frame: same, different, or ignore.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/monitor.h"
#include "sequence/selection.h"
#include "truth/dataset.h"

namespace vpr {

/// What a pair of frames shows: another place, the same one, or what is not to be judged.
enum class PlaceLabel { different, same, ignore };
template <>
inline constexpr std::array<std::string_view, 3> kEnumNames<PlaceLabel> = {"different", "same",
                                                                           "ignore"};

/// A number of frames that only the ground truth itself can tell.
inline constexpr size_t kUnknownFrames = std::numeric_limits<size_t>::max();
/// Upper bound on a number of frames that only a file states, against one large index in a broken
/// file.
inline constexpr size_t kMostGrownFrames = size_t{1} << 22;

/// Reads the names of the frames of a sequence; null: they are not known.
using NameReader = std::function<std::vector<std::string>()>;

/// What indices mean: the training sequences of a result, in its order, and its query.
struct GroundTruthScope {
  struct TrainSequence {
    std::string name;
    size_t frames = 0;
    bool searched = true;  ///< pairs of a sequence that was not searched are left out
    /// Where its frames are kept ones of a recording: the files know the recording's frames.
    std::optional<Replay> kept = {};
    NameReader names = {};
  };
  size_t query_frames = 0;
  std::vector<TrainSequence> sequences;
  /// Where the query is a recording that is replayed: the files know the recording's frames, labels
  /// are of the replay's.
  std::optional<Replay> replay = {};
  NameReader query_names = {};
};

/// Three-valued, by frames (not windows).
struct GroundTruth {
  /// The frames first .. first + further of a training sequence, labelled alike: a matrix of 10^8
  /// pairs is a few runs a row.
  struct Pair {
    uint32_t sequence = 0;
    uint32_t first = 0;
    PlaceLabel label = PlaceLabel::same;
    uint32_t further = 0;

    uint32_t last() const { return first + further; }
    // NOLINTNEXTLINE(modernize-use-nullptr): its literal 0 is the comparison's own
    auto operator<=>(const Pair&) const = default;
  };
  /// Per query frame: sorted, no reference twice.
  std::vector<std::vector<Pair>> pairs;
  int64_t tolerance_frames = 0;
  std::string protocol;  ///< in words, for reports
  bool is_known = true;  ///< false: nothing is judged

  /// The pairs of a query frame with the frames of one training sequence.
  std::span<const Pair> pairs_of(size_t query, size_t sequence) const;
  /// Same, if a `same` pair is at most tolerance_frames away from `reference`; otherwise the label
  /// of an `ignore` pair that is exactly this one; otherwise different.
  PlaceLabel label(size_t query, size_t sequence, size_t reference) const;
  /// The same for all references 0 .. labels.size() - 1 at once.
  void label_row(size_t query, size_t sequence, std::span<PlaceLabel> labels) const;
  /// Whether any frame of the searched sequences shows the query frame's place.
  bool has_match(size_t query) const;
};

/// A run of references with one label, tolerance applied.
struct LabelRun {
  size_t first = 0;
  size_t last = 0;
  PlaceLabel label = PlaceLabel::same;
};

/// The runs of one query that are not `different`, in order, among the first `frames` references of
/// a sequence. Time linear in the query's pairs of that sequence.
std::vector<LabelRun> label_runs(const GroundTruth& truth, size_t query, size_t sequence,
                                 size_t frames);

/// Labels of the recordings' frames become those of the frames that `scope` keeps of them; of
/// sequences that keep all, they stay. The tolerance is applied, and 0 afterwards. A stretch of
/// frames at the query's place of which none is kept is that of the kept frame nearest to it, the
/// earlier of two, so that a query frame does not lose its place; of frames to ignore, those that
/// are kept are ignored.
void keep_frames(GroundTruth& truth, const GroundTruthScope& scope);

/// The ground truth where nothing is known: every pair is labelled ignore.
GroundTruth unknown_ground_truth(const GroundTruthScope& scope);

/// What is odd about a ground truth.
enum class FindingKind { out_of_range, contradiction, duplicate };
template <>
inline constexpr std::array<std::string_view, 3> kEnumNames<FindingKind> = {
    "out_of_range", "contradiction", "duplicate"};

/// How often something odd was found.
struct GroundTruthFinding {
  uint64_t count = 0;                 ///< pairs
  std::vector<std::string> examples;  ///< the first of them, in words
};

/// A ground truth together with what is odd about its file.
struct InspectedGroundTruth {
  GroundTruth truth;       ///< without what is out of range; of two labels, the first stays
  GroundTruthScope scope;  ///< with the numbers of frames that were unknown
  std::string format;
  std::array<GroundTruthFinding, 3> findings;  ///< by FindingKind
};

/// Reads what `argument` names; the formats are the rows of truth/formats.h.
/// Throws Error(usage) where several sequences were searched and the format can't tell them apart,
/// or where the format is unknown or lacks an option; Error(input) if a file can't be read;
/// Error(data), naming file and line, if it is damaged, an index is out of range or a pair has both
/// labels. A pair that is listed twice counts once.
/// Warns of what is odd but no damage: a radius that calls nearly everything the same.
GroundTruth read_ground_truth(const GroundTruthArgument& argument, const GroundTruthScope& scope,
                              const Monitor& monitor = {});

/// The same, but indices that are out of range and pairs with both labels are counted, not thrown;
/// and numbers of frames may be kUnknownFrames: they become those of the file, or one more than its
/// largest index.
InspectedGroundTruth inspect_ground_truth(const GroundTruthArgument& argument,
                                          const GroundTruthScope& scope,
                                          const Monitor& monitor = {});

/// `text` as --ground-truth takes it: a word (aligned, or the name of a preset), or a path.
GroundTruthArgument parse_ground_truth_argument(const std::string& text, int tolerance_frames);

}  // namespace vpr
