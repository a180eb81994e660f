#include "evaluation/view_counts.h"

#include <algorithm>
#include <map>
#include <utility>

#include "evaluation/outcomes.h"

namespace vpr {
namespace {

/// What the frames of one view, or one pair of views, are.
struct Tally {
  uint64_t correct = 0;
  uint64_t incorrect = 0;
};

void add(Tally& tally, PlaceLabel label) {
  if (label == PlaceLabel::same) ++tally.correct;
  if (label == PlaceLabel::different) ++tally.incorrect;
}

void count(ViewCounts& counts, const Tally& tally) {
  if (tally.correct + tally.incorrect == 0)
    ++counts.ignored;
  else if (tally.incorrect == 0)
    ++counts.correct;
  else if (tally.correct == 0)
    ++counts.incorrect;
  else
    ++counts.mixed;
}

// The view that a frame belongs to. The first view starts at the first frame.
size_t view_of(const std::vector<uint32_t>& starts, size_t frame) {
  return static_cast<size_t>(std::upper_bound(starts.begin(), starts.end(), frame) -
                             starts.begin()) -
         1;
}

void count_hits(CountsByView& counts, const Result& result, const GroundTruth& truth,
                const Monitor& monitor) {
  std::map<std::pair<uint32_t, size_t>, Tally> pairs;  // of one query view
  const auto finish_view = [&] {
    for (const auto& [pair, tally] : pairs) count(counts.hits, tally);
    pairs.clear();
  };
  const size_t length = result.window_length();
  size_t present = 0;
  for (const Match& hit : result.hits) {  // in the order of query windows
    check_stop(monitor);
    const size_t anchor = anchor_of(hit.query, length);
    const size_t view = view_of(result.views->query, anchor);
    if (view != present) finish_view();
    present = view;
    const size_t reference = anchor_of(hit.train, length);
    add(pairs[{hit.target, view_of(result.views->train[hit.target], reference)}],
        truth.label(anchor, hit.target, reference));
  }
  finish_view();
}

void count_best_matches(CountsByView& counts, const Result& result, const GroundTruth& truth) {
  Tally tally;
  bool any = false;  // window of the present view that has a match
  const auto finish_view = [&] {
    if (any) count(counts.best_match, tally);
    if (tally.correct > 0)
      counts.correct_share +=
          static_cast<double>(tally.correct) / static_cast<double>(tally.correct + tally.incorrect);
    tally = {};
    any = false;
  };
  size_t present = 0;
  for (const QueryOutcome& query : outcomes_of(result, truth).queries) {
    const size_t view = view_of(result.views->query, query.frame);
    if (view != present) finish_view();
    present = view;
    if (!query.has_match || query.verdict == Verdict::unreadable) continue;
    any = true;
    if (query.verdict == Verdict::correct) ++tally.correct;
    if (query.verdict == Verdict::incorrect) ++tally.incorrect;
  }
  finish_view();
}

}  // namespace

std::optional<double> CountsByView::best_match_rate() const {
  const uint64_t views = best_match.correct + best_match.incorrect + best_match.mixed;
  if (views == 0) return std::nullopt;
  return correct_share / static_cast<double>(views);
}

std::optional<CountsByView> count_by_view(const Result& result, const GroundTruth& truth,
                                          const Monitor& monitor) {
  if (!result.views) return std::nullopt;
  CountsByView counts;
  counts.query_views = result.views->query.size();
  for (size_t s = 0; s < result.targets.size(); ++s)
    if (result.targets[s].searched) counts.train_views += result.views->train[s].size();
  count_hits(counts, result, truth, monitor);
  count_best_matches(counts, result, truth);
  return counts;
}

}  // namespace vpr
