// Ground truth: whether a query frame and a training frame show the same place: same, different, or
// ignore.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/monitor.h"
#include "recordings/sequence.h"
#include "truth/dataset.h"

namespace vpr {

/// The label of a pair of frames. Ignored pairs are neither correct nor incorrect.
enum class PlaceLabel { different, same, ignore };
template <>
inline constexpr std::array<std::string_view, 3> kEnumNames<PlaceLabel> = {"different", "same",
                                                                           "ignore"};

/// The column "asked" of a file of labels: why a person was asked about the frame.
inline constexpr std::string_view kAskedSpread = "spread";  ///< it is in the sample
inline constexpr std::string_view kAskedNear = "decision";  ///< its match is near the decision

/// An unknown number of frames, which the ground truth itself determines.
inline constexpr size_t kUnknownFrames = std::numeric_limits<size_t>::max();
/// Upper bound of a number of frames that only a file states: a damaged file may have a large
/// index.
inline constexpr size_t kMaxGrownFrames = size_t{1} << 22;
/// The same for a file of poses with this number of lines.
constexpr size_t most_frames_of(size_t lines) {
  return lines < kMaxGrownFrames / 1000 ? 1000 * (lines + 1) : kMaxGrownFrames;
}

/// The name of the only training sequence of scores: their columns.
inline constexpr std::string_view kScoreColumns = "references";

/// The meaning of indices: the training sequences of a result, in its order, and its query. Files
/// refer to frames of recordings, labels to selected frames.
struct GroundTruthScope {
  struct TrainSequence {
    Sequence sequence;
    bool searched = true;  ///< false: no match is in it, but its pairs count
    NameReader names = {};
  };
  Sequence query;
  std::vector<TrainSequence> sequences;
  NameReader query_names = {};
  bool has_places = false;               ///< of FAB-MAP, without order, instead of training frames
  std::vector<std::string> places = {};  ///< names of FAB-MAP's places
};

/// A pair that a person labeled. Frames are those of the recordings, counted in the file's range.
struct PersonLabel {
  size_t query = 0;
  uint32_t sequence = 0;
  std::optional<size_t> reference =
      {};  ///< unset: the result that was labeled had no best match here
  bool is_same = false;
  size_t tolerance = 0;    ///< frames around the reference that are also the same place
  bool is_spread = false;  ///< of a frame of the sample; otherwise of one near the decision
};

/// Labels by frame (not by window).
struct GroundTruth {
  /// The frames first .. first + further of a training sequence, with one label: a matrix of 10^8
  /// pairs has a few runs per row.
  struct Pair {
    uint32_t sequence = 0;
    uint32_t first = 0;
    PlaceLabel label = PlaceLabel::same;
    uint32_t further = 0;

    uint32_t last() const { return first + further; }
    // NOLINTNEXTLINE(modernize-use-nullptr): its literal 0 is the comparison's own
    auto operator<=>(const Pair&) const = default;
  };
  /// Per query frame: sorted, each reference at most once.
  std::vector<std::vector<Pair>> pairs;
  int64_t tolerance_frames = 0;
  std::string protocol;  ///< a description for reports
  bool is_known = true;  ///< false: no match is evaluated
  /// Per query frame, the pairs that a person labeled; other pairs are unknown: labeled ignore.
  /// Empty: all pairs are known. If a sample was asked, it has the labels of its frames only; one
  /// without a best match has the first pair, labeled ignore.
  std::vector<std::vector<Pair>> asked = {};
  std::vector<PersonLabel> person_labels = {};  ///< all rows of the file of labels
  bool is_sample = false;  ///< labeled frames are spread evenly along the query
  /// After select_train_frames: the tolerance in recorded training frames, which pairs include.
  std::optional<int64_t> applied_tolerance_frames = {};

  std::span<const Pair> pairs_of(size_t query, size_t sequence) const;
  /// `same` if a `same` pair is at most tolerance_frames away from `reference`; otherwise the label
  /// of an `ignore` pair with exactly this reference; otherwise `different`.
  PlaceLabel label(size_t query, size_t sequence, size_t reference) const;
  /// The labels of all references 0 .. labels.size() - 1.
  void label_row(size_t query, size_t sequence, std::span<PlaceLabel> labels) const;
  /// Whether the frame counts: some frame of the training sequences, searched or not, shows its
  /// place or, if not all pairs are known, a person labeled one of its pairs.
  bool has_match(size_t query) const;
};

/// A stretch of references with one label, with the tolerance applied.
struct LabelStretch {
  size_t first = 0;
  size_t last = 0;
  PlaceLabel label = PlaceLabel::same;
};

/// The runs of one query that are not `different`, in order, among the first `frames` references of
/// a sequence. Time linear in the query's pairs with that sequence.
std::vector<LabelStretch> label_runs(const GroundTruth& truth, size_t query, size_t sequence,
                                     size_t frames);

/// Converts labels of the recordings' frames to the training frames that `scope` selects; sequences
/// without a selection do not change. Applies the tolerance, so that tolerance_frames is 0. If no
/// frame of a run of the same place is selected, the label moves to the selected frame nearest to
/// the run, the earlier one on a tie, so that a query frame keeps its place. Among frames to
/// ignore, the selected ones are ignored.
void select_train_frames(GroundTruth& truth, const GroundTruthScope& scope);

/// The scope of the recordings, without selections, whose frames files of ground truth count.
GroundTruthScope recorded(GroundTruthScope scope);

/// The ground truth if nothing is known: every pair of the searched sequences is labeled ignore.
GroundTruth unknown_ground_truth(const GroundTruthScope& scope);

/// The kinds of inconsistencies in a ground truth.
enum class FindingKind { out_of_range, contradiction, duplicate };
template <>
inline constexpr std::array<std::string_view, 3> kEnumNames<FindingKind> = {
    "out_of_range", "contradiction", "duplicate"};

/// The number of inconsistencies of one kind.
struct GroundTruthFinding {
  uint64_t count = 0;                 ///< pairs
  std::vector<std::string> examples;  ///< descriptions of the first of them
};

/// A ground truth with the inconsistencies of its file.
struct InspectedGroundTruth {
  GroundTruth truth;  ///< without pairs out of range; the first of two contradicting labels is kept
  GroundTruthScope scope;  ///< with the numbers of frames that were unknown
  std::string format;
  std::array<GroundTruthFinding, 3> findings;  ///< by FindingKind
};

/// Reads the ground truth of `argument`; truth/formats.h has the table of formats. Throws
/// Error(usage) if several sequences were searched and the format cannot distinguish them, or if
/// the format is unknown or lacks an option, or for a tolerance of places; Error(input) if a file
/// cannot be read; Error(data), with file and line, if it is damaged, an index is out of range or a
/// pair has both labels. Duplicate pairs count once. Warns of suspicious but valid input, such as a
/// radius that makes nearly all pairs the same place.
GroundTruth read_ground_truth(const GroundTruthArgument& argument, const GroundTruthScope& scope,
                              const Monitor& monitor = {});

/// As read_ground_truth, but counts indices out of range and pairs with both labels instead of
/// throwing. Numbers of frames may be kUnknownFrames: they become those of the file, or its largest
/// index plus one.
InspectedGroundTruth inspect_ground_truth(const GroundTruthArgument& argument,
                                          const GroundTruthScope& scope,
                                          const Monitor& monitor = {});

/// Parses an argument of --ground-truth: a word (aligned, or the name of a preset) or a path.
GroundTruthArgument parse_ground_truth_argument(const std::string& text, int tolerance_frames);

/// Counts over all sequences, with the tolerance applied.
struct GroundTruthSummary {
  uint64_t query_frames = 0;
  uint64_t train_frames = 0;
  uint64_t same = 0;                        ///< pairs of the same place
  uint64_t ignored = 0;                     ///< pairs to ignore
  uint64_t queries_without_match = 0;       ///< query frames without a pair of the same place
  uint64_t train_frames_without_match = 0;  ///< training frames without a pair of the same place
  uint64_t most_matches = 0;                ///< maximum over all query frames
  /// Pairs (i, j) of the same place for which (j, i) is not: an error in a ground truth of a
  /// sequence with itself, normal for two sequences. Set only for one training sequence with as
  /// many frames as the query, and at most 2^26 pairs.
  std::optional<uint64_t> one_sided;
  std::vector<std::string> one_sided_examples;
};

/// Counts the pairs of a ground truth, in time linear in the runs of frames, not in pairs.
GroundTruthSummary summarize(const InspectedGroundTruth& ground_truth, const Monitor& monitor = {});

/// Throws Error(data), with the first such pair, if a pair is out of range or contradicts another.
void require_undamaged(const InspectedGroundTruth& ground_truth, const std::string& name);

/// The checksum of the labels of all pairs, with the tolerance applied, and of the number of query
/// frames. It does not depend on the file's name, its format or the origin of the pairs: ground
/// truths with equal labels have equal fingerprints. Training sequences that are searched or have
/// pairs count in their order, without their names; those at the end without any pair do not count.
/// Time linear in the runs of labels.
std::string ground_truth_fingerprint(const GroundTruth& truth, const GroundTruthScope& scope,
                                     const Monitor& monitor = {});

}  // namespace vpr
