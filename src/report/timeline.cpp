#include "report/timeline.h"

#include <algorithm>

#include "ground_truth/ground_truth.h"

namespace vpr {

Meaning meaning_of(const Judgement& judgement, const QueryOutcome& query) {
  const bool is_strong = is_recognised(judgement, query);
  if (query.verdict == Verdict::correct) return is_strong ? Meaning::right : Meaning::weak_right;
  if (query.verdict == Verdict::incorrect) return is_strong ? Meaning::wrong : Meaning::weak_wrong;
  return is_strong ? Meaning::unjudged : Meaning::weak_unjudged;
}

bool is_weak(Meaning meaning) {
  return meaning == Meaning::weak_right || meaning == Meaning::weak_wrong ||
         meaning == Meaning::weak_unjudged;
}

Meaning meaning_of(Fix fix) {
  return fix == Fix::right   ? Meaning::right
         : fix == Fix::wrong ? Meaning::wrong
                             : Meaning::unjudged;
}

std::vector<TimelineMark> timeline_marks(const Judgement& judgement,
                                         const std::vector<FrameBand>& bands) {
  std::vector<TimelineMark> marks;
  for (const QueryOutcome& query : judgement.outcomes.queries)
    if (query.best)
      marks.push_back({query.frame, position_of(bands, *query.best), meaning_of(judgement, query)});
  return marks;
}

std::vector<TruthBox> truth_boxes(const Judgement& judgement, const GroundTruth& truth,
                                  const std::vector<FrameBand>& bands, size_t most,
                                  const Monitor& monitor) {
  const size_t frames = std::min(judgement.layout.scope.query_frames, truth.pairs.size());
  const size_t step = std::max<size_t>(1, (frames + most - 1) / most);
  std::vector<TruthBox> boxes;
  for (size_t frame = 0; frame < frames; frame += step) {
    const size_t frame_end = std::min(frames, frame + step);
    for (const FrameBand& band : bands) {
      check_stop(monitor);
      const size_t end = band.first_frame + band.count;
      for (const LabelRun& run : label_runs(truth, frame, band.sequence, end)) {
        if (run.label != PlaceLabel::same || run.last < band.first_frame) continue;
        const size_t first = std::max(run.first, band.first_frame);
        const size_t low = band.at + first - band.first_frame;
        boxes.push_back({frame, frame_end, low, low + run.last + 1 - first});
      }
    }
  }
  return boxes;
}

}  // namespace vpr
