// What a timeline shows: best matches and the ground truth along the query's path.
#pragma once

#include <vector>

#include "evaluation/judgement.h"
#include "report/frame_axis.h"
#include "report/palette.h"

namespace vpr {

/// The best match of a query frame, at a position on the axis of frame_bands.
struct TimelineMark {
  size_t frame = 0;
  size_t position = 0;
  Meaning meaning = Meaning::right;
};

/// One mark a query frame, by frame; queries without a best match have none.
std::vector<TimelineMark> timeline_marks(const Judgement& judgement,
                                         const std::vector<FrameBand>& bands);

/// Query frames begin .. end - 1 and the positions low .. high - 1 that show their place.
struct TruthBox {
  size_t begin = 0;
  size_t end = 0;
  size_t low = 0;
  size_t high = 0;
};

/// The ground truth of about `most` query frames, evenly spaced; each stands for those up to the
/// next.
std::vector<TruthBox> truth_boxes(const Judgement& judgement, const GroundTruth& truth,
                                  const std::vector<FrameBand>& bands, size_t most,
                                  const Monitor& monitor);

/// Whether a mark is of a best match that is not recognised.
bool is_weak(Meaning meaning);

/// What a mark of a query means. Recognised is what is_recognised says.
Meaning meaning_of(const Judgement& judgement, const QueryOutcome& query);

/// What a frame's fix means; it is not none.
Meaning meaning_of(Fix fix);

/// The kinds of marks, what covers others last.
inline constexpr std::array<Meaning, 6> kMarkOrder = {Meaning::weak_unjudged, Meaning::weak_wrong,
                                                      Meaning::weak_right,    Meaning::unjudged,
                                                      Meaning::wrong,         Meaning::right};

}  // namespace vpr
