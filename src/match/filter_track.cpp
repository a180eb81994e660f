#include "match/filter_track.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "match/score_kernels.h"

namespace vpr {
namespace {

constexpr size_t kRecentViews = 16;
constexpr size_t kFewViews = 6;  // fewer keyframes do not determine the rate
constexpr size_t kSupportViews = 24;
constexpr size_t kMarginViews = 16;

struct BestPlace {
  size_t cell = 0;
  uint32_t value = kNoValue;
};

uint32_t least_of(const PathTrack& track, const FilterState& state, size_t first, size_t last) {
  return first < last ? track.kernels.minimum(state.values.data() + first, last - first) : kNoValue;
}

BestPlace find_best(const PathTrack& track, const FilterState& state) {
  const std::vector<uint32_t>& values = state.values;
  BestPlace best;
  best.value = track.kernels.minimum(values.data(), values.size());
  best.cell = track.kernels.find_below(values.data(), 0, values.size(), best.value + 1);
  return best;
}

uint32_t runner_up_value(const PathTrack& track, const FilterState& state, size_t cell) {
  const size_t sequence = run_of(state.cells, cell).sequence;
  const size_t near = state.settings.near_keyframes;
  const size_t before = cell - std::min(cell, near);  // the first near cell
  uint32_t least = kNoValue;
  for (const CellRun& run : state.cells.runs) {
    const size_t end = run.first + run.count;
    if (run.sequence == sequence) {
      least = std::min({least, least_of(track, state, run.first, std::min(end, before)),
                        least_of(track, state, std::max(run.first, cell + near + 1), end)});
    } else if (track.shared.empty() || track.shared[sequence][run.sequence] == 0) {
      least = std::min(least, least_of(track, state, run.first, end));
    }
  }
  return least;
}

bool continues_path(const PathTrack& track, const FilterState& state, size_t cell) {
  if (track.views == 0) return false;
  const size_t last = track.last.cell;
  const size_t gap = std::max(cell, last) - std::min(cell, last);
  return gap <= state.settings.near_keyframes &&
         run_of(state.cells, cell).sequence == run_of(state.cells, last).sequence;
}

int64_t in_scores(double deviations) { return std::llround(deviations * kScoreUnit); }

// The mean of the last 24 keyframes.
double usual_support(const PathTrack& track) {
  const auto views = static_cast<ptrdiff_t>(std::min(track.supports.size(), kSupportViews));
  const auto sum = std::accumulate(track.supports.end() - views, track.supports.end(), int64_t{0});
  return static_cast<double>(sum) / static_cast<double>(views);
}

// The mean of the earlier keyframes.
double usual_margin(const PathTrack& track, uint32_t margin) {
  if (track.margins.empty()) return margin;
  const auto sum = std::accumulate(track.margins.begin(), track.margins.end(), uint64_t{0});
  return static_cast<double>(sum) / static_cast<double>(track.margins.size());
}

// A kidnapped camera loses the support and margin of the path, and its images change more than the
// training sequence. `excess`: this difference, in typical distances.
bool is_present(const PathTrack& track, uint32_t margin, double excess, double least) {
  const double usual = usual_support(track);
  if (usual <= 0 || margin == 0) return false;
  const double margins = margin / usual_margin(track, margin);
  return track.support / usual + std::min(margins, kMostMarginShare) -
             kChangeWeight * std::max(excess, 0.0) >=
         least;
}

bool is_as_long(const PathTrack& track, size_t views) {
  const size_t cell = track.last.cell;
  return track.views + cell - std::min(cell, track.start) >= 2 * views;  // twice the length
}

// Similar places support a path as well, but less; a longer path needs less.
bool is_confirmable(const PathTrack& track, const FilterSettings& settings, uint32_t margin) {
  const auto has = [&](double share) {
    return margin >= in_scores(share * settings.confirm_margin) &&
           usual_support(track) >= share * settings.support * kScoreUnit;
  };
  const bool has_evidence = track.evidence >= in_scores(settings.confirm_evidence) &&
                            margin >= in_scores(settings.confirm_margin);
  return has_evidence || (is_as_long(track, settings.confirm_keyframes) && has(1)) ||
         (is_as_long(track, 2 * settings.confirm_keyframes) && has(kLongShare));
}

// `margin` is the margin of the place, confirmed or not.
void update_confirmation(PathTrack& track, const FilterSettings& settings, uint32_t margin,
                         double excess) {
  if (track.views == 1 || margin == 0 || track.support < 0) track.is_confirmed = false;
  const bool is_now = is_present(track, margin, excess, settings.present_support);
  if (is_now && !track.is_confirmed && is_confirmable(track, settings, margin)) {
    track.is_confirmed = true;
    ++track.number;
  }
  track.last.track = track.is_confirmed ? track.number : 0;
  const bool is_enough = is_as_long(track, 2 * settings.confirm_keyframes) ||
                         margin >= in_scores(settings.confirm_margin);
  track.last.margin = track.is_confirmed && is_now && is_enough ? margin : 0;
  track.margins.push_back(margin);
  if (track.margins.size() > kMarginViews) track.margins.pop_front();
}

void begin_path(PathTrack& track, size_t cell) {
  track.views = 0;
  track.start = cell;
  track.margins.clear();
  track.recent.clear();
}

void update_support(PathTrack& track, std::vector<int32_t> supports) {
  const int64_t most = in_scores(kMostEvidence);
  track.supports = std::move(supports);
  track.support = 0;
  track.evidence = 0;
  for (const int32_t support : track.supports) {
    track.support = (track.support + support) >> 1;  // rounded down, also below 0
    const int64_t added = support - in_scores(kUnrelatedSupport);
    track.evidence = std::max<int64_t>(0, track.evidence + std::clamp(added, -most, most));
  }
}

}  // namespace

void follow_keyframe(PathTrack& track, const FilterState& state, const QueryKeyframe& view) {
  const BestPlace best = find_best(track, state);
  double excess = 0;
  const bool begins = !continues_path(track, state, best.cell);
  if (begins) {
    begin_path(track, best.cell);
  } else if (view.train_change) {
    excess = view.change - view.train_change(track.last.cell, best.cell);
  }
  const size_t frame = state.cells.frames[best.cell];
  ++track.views;
  RescoredPath reading = view.rescore_path(best.cell, begins);
  update_support(track, std::move(reading.supports));
  track.recent.push_back({view.frame, frame});
  if (track.recent.size() > kRecentViews) track.recent.pop_front();
  track.last = {best.cell, frame, 0, state.nowhere_value, std::nullopt, 0};
  if (track.recent.size() >= kFewViews) {
    const PathTrack::Point& from = track.recent.front();
    const size_t passed = frame - std::min(frame, from.train_frame);
    track.last.rate =
        static_cast<double>(passed) / static_cast<double>(view.frame - from.query_frame);
  }
  const uint32_t elsewhere = runner_up_value(track, state, best.cell);
  const uint32_t ahead = elsewhere - std::min(elsewhere, best.value);
  update_confirmation(track, state.settings, std::min(ahead, reading.margin), excess);
}

PathFrame path_at(const PathTrack& track, const FilterCells& cells, size_t query_frame) {
  PathFrame now = track.last;
  const size_t elapsed = query_frame - track.recent.back().query_frame;
  const double passed = std::floor(static_cast<double>(elapsed) * now.rate.value_or(1) + 0.5);
  const size_t end = view_end(cells, run_of(cells, now.cell), now.cell);
  const size_t rest = end - 1 - now.frame;
  now.frame += static_cast<size_t>(std::min(passed, static_cast<double>(rest)));
  return now;
}

}  // namespace vpr
