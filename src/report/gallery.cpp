#include "report/gallery.h"

#include <algorithm>

namespace vpr {
namespace {

constexpr size_t kLeastApart = 5;

// The middle one of the references from frame `earliest` on that show the query's place.
std::optional<FrameMatch> middle_match(const GroundTruth& truth, const ScoreLayout& layout,
                                       size_t frame, size_t earliest) {
  struct Run {
    uint32_t sequence;
    size_t first;
    size_t count;
  };
  std::vector<Run> runs;
  size_t all = 0;
  for (const GroundTruth::Pair& pair : truth.pairs[frame]) {
    const size_t end =
        std::min<size_t>(size_t{pair.last()} + 1, layout.scope.sequences[pair.sequence].frames);
    const size_t first = std::max<size_t>(pair.first, earliest);
    if (pair.label != PlaceLabel::same || first >= end) continue;
    runs.push_back({pair.sequence, first, end - first});
    all += end - first;
  }
  size_t before = all / 2;
  for (const Run& run : runs) {
    if (before < run.count) return FrameMatch{run.sequence, run.first + before};
    before -= run.count;
  }
  return std::nullopt;
}

// With a whole window if there is one.
std::optional<FrameMatch> true_match(const GroundTruth& truth, const ScoreLayout& layout,
                                     size_t frame) {
  const auto whole = middle_match(truth, layout, frame, layout.window_length - 1);
  return whole ? whole : middle_match(truth, layout, frame, 0);
}

}  // namespace

std::vector<GalleryItem> choose_gallery(const Judgement& judgement, const GroundTruth& truth,
                                        size_t most) {
  const auto& queries = judgement.outcomes.queries;
  const size_t apart = std::max(kLeastApart, judgement.layout.window_length);
  std::vector<GalleryItem> items;
  const auto choose = [&](GalleryKind kind, Verdict verdict, bool is_best_first) {
    std::vector<size_t> order;
    for (size_t q = 0; q < queries.size(); ++q)
      if (queries[q].verdict == verdict && queries[q].best) order.push_back(q);
    std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) {
      const uint64_t first = confidence_key(queries[a], judgement.outcomes.confidence);
      const uint64_t second = confidence_key(queries[b], judgement.outcomes.confidence);
      return is_best_first ? first < second : first > second;
    });
    const size_t begin = items.size();
    for (const size_t q : order) {
      if (items.size() - begin == most) break;
      const bool is_near = std::any_of(items.begin(), items.end(), [&](const GalleryItem& item) {
        const bool same_query = item.query == q;
        const size_t away = item.query > q ? item.query - q : q - item.query;
        return same_query || (item.kind == kind && away < apart);
      });
      if (!is_near)
        items.push_back({kind, q, true_match(truth, judgement.layout, queries[q].frame)});
    }
  };
  const Verdict good = truth.is_known ? Verdict::correct : Verdict::ignored;
  choose(GalleryKind::mistake, Verdict::incorrect, true);
  choose(GalleryKind::hit, good, true);
  choose(GalleryKind::weak, good, false);
  return items;
}

std::vector<size_t> strip_frames(size_t anchor, size_t window_length, size_t most) {
  const size_t length = std::min(window_length, anchor + 1);
  const size_t count = std::min(length, most);
  std::vector<size_t> frames;
  for (size_t i = 0; i < count; ++i) {
    const size_t back = count == 1 ? 0 : (count - 1 - i) * (length - 1) / (count - 1);
    frames.push_back(anchor - back);
  }
  return frames;
}

}  // namespace vpr
