// The paper's counts: correct, incorrect and distinct recognitions, and the best match.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "ground_truth/ground_truth.h"
#include "recognition/fabmap_result.h"
#include "recognition/sequence_result.h"

namespace vpr {

struct LabelCounts {
  uint64_t correct = 0;
  uint64_t incorrect = 0;
  uint64_t ignored = 0;  ///< pairs labelled ignore: neither
};

struct BestMatchCounts {
  uint64_t queries = 0;  ///< windows (frames) with a match in the ground truth, ignored ones too
  uint64_t correct = 0;
  uint64_t ignored = 0;        ///< of `queries`: the best match is an ignored pair
  uint64_t without_match = 0;  ///< windows whose anchor has no match; not in `queries`
  uint64_t unreachable = 0;    ///< whose anchor has matches only where no training window ends, in
                               ///< the first c_l - 1 frames; not in `queries`
  uint64_t unreadable = 0;     ///< windows with an unreadable frame; not in `queries`

  /// correct / (queries - ignored); none where there are none.
  std::optional<double> rate() const;
};

struct SequenceCounts {
  LabelCounts hits;           ///< window pairs below the threshold, judged at both anchors
  LabelCounts places;         ///< clusters, judged at their representative's anchors
  uint64_t mixed_places = 0;  ///< correct places of whose hits some are incorrect
  uint64_t distinct = 0;      ///< correct places
  BestMatchCounts best_match;
};

struct FabmapCounts {
  LabelCounts hits;       ///< (frame, place) pairs recognised
  uint64_t distinct = 0;  ///< places recognised correctly at least once
  BestMatchCounts best_match;
};

/// A cluster as the ground truth sees it: its representative may lie at a correct pair although
/// many, or most, of its hits do not.
struct JudgedPlace {
  PlaceLabel label = PlaceLabel::different;  ///< at its representative's anchors
  LabelCounts hits;

  bool is_mixed() const { return label == PlaceLabel::same && hits.incorrect > 0; }
};

/// One for each of the result's places, in its order.
std::vector<JudgedPlace> judge_places(const SequenceResult& result, const GroundTruth& truth,
                                      const Monitor& monitor = {});

/// Whether a query window has an unreadable frame.
bool shows_unreadable(const SequenceResult& result, size_t window);

/// The scope in which a result's indices are to be read.
GroundTruthScope scope_of(const SequenceResult& result);

/// For FAB-MAP a ground truth's references are indices of places: the scope has one "sequence".
GroundTruthScope scope_of(const FabmapResult& result);

/// A frame without words is a query that is wrong.
FabmapCounts count_recognitions(const FabmapResult& result, const GroundTruth& truth);

/// Windows are judged at their anchor, their last frame.
SequenceCounts count_recognitions(const SequenceResult& result, const GroundTruth& truth,
                                  const Monitor& monitor = {});

}  // namespace vpr
