#include "report/timeline.h"

#include <algorithm>

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
                                  const std::vector<FrameBand>& bands, size_t most) {
  const size_t frames = std::min(judgement.layout.scope.query_frames, truth.pairs.size());
  const size_t step = std::max<size_t>(1, (frames + most - 1) / most);
  std::vector<TruthBox> boxes;
  std::vector<PlaceLabel> labels;
  for (size_t frame = 0; frame < frames; frame += step) {
    const size_t frame_end = std::min(frames, frame + step);
    for (const FrameBand& band : bands) {
      labels.resize(band.first_frame + band.count);
      truth.label_row(frame, band.sequence, labels);
      for (size_t begin = band.first_frame; begin < labels.size();) {
        size_t end = begin;
        while (end < labels.size() && labels[end] == labels[begin]) ++end;
        const size_t low = band.at + begin - band.first_frame;
        if (labels[begin] == PlaceLabel::same)
          boxes.push_back({frame, frame_end, low, low + end - begin});
        begin = end;
      }
    }
  }
  return boxes;
}

}  // namespace vpr
