#include "matching/second_look.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numeric>

#include "matching/score_kernels.h"

namespace vpr {
namespace {

constexpr uint16_t kWorstScore = std::numeric_limits<uint16_t>::max();

double deviations(uint16_t score) { return (static_cast<double>(score) - kScoreBias) / kScoreUnit; }

uint16_t score_of(double distance, const ScoreScale& scale) {
  const double z = (distance - scale.mean) / scale.deviation;
  return static_cast<uint16_t>(
      std::clamp(std::floor((z * kScoreUnit + kScoreBias) + 0.5), 0.0, 65535.0));
}

size_t end_of(const SeenView& view) { return view.first + view.distances.size(); }

/// Cells [first, end) of all, which are of one run.
struct Stretch {
  size_t first = 0;
  size_t end = 0;
};

Stretch around_path(const std::vector<const SeenView*>& views) {
  Stretch stretch{views.front()->first, 0};
  for (const SeenView* view : views) {
    stretch.first = std::min(stretch.first, view->first);
    stretch.end = std::max(stretch.end, end_of(*view));
  }
  return stretch;
}

// `places`: of the whole map, for who is nowhere comes back to any of them.
FilterCells cells_of(const Stretch& stretch, size_t places) {
  const size_t count = stretch.end - stretch.first;
  FilterCells cells;
  cells.frames.resize(kLongestStep + count, 0);
  std::iota(cells.frames.begin() + kLongestStep, cells.frames.end(), 0U);
  cells.runs.push_back({kLongestStep, count, 0, count});
  cells.places = places;
  return cells;
}

// Of the last view of the filter, whose cells are the stretch.
uint32_t margin_near(const FilterState& filter, const Stretch& stretch, size_t best) {
  const size_t near = filter.settings.near_views;
  const size_t first = std::max(stretch.first, best - std::min(best, near));
  const size_t end = std::min(stretch.end, best + near + 1);
  const auto value = [&](size_t cell) {
    return filter.values.begin() + static_cast<ptrdiff_t>(kLongestStep + cell - stretch.first);
  };
  const uint32_t least = *std::min_element(value(first), value(end));
  return filter.nowhere_value - std::min(filter.nowhere_value, least);
}

}  // namespace

SecondLook start_second_look(const FilterState& filter) {
  SecondLook look;
  look.filter.settings = filter.settings;
  look.filter.kernels = filter.kernels;
  look.filter.likelihood_of = filter.likelihood_of;
  look.filter.logarithms = filter.logarithms;
  look.filter.octave = filter.octave;
  return look;
}

void see_view(SecondLook& look, const FilterCells& cells, std::span<const uint16_t> scores,
              const std::function<ScoreScale(size_t)>& scale, size_t cell) {
  const size_t near = look.filter.settings.near_views;
  const CellRun& run = run_of(cells, cell);
  SeenView view{cell, std::max(run.first, cell - std::min(cell, near)), {}};
  const size_t end = std::min(run.first + run.count, cell + near + 1);
  for (size_t c = view.first; c < end; ++c) {
    const ScoreScale made = scale(cells.frames[c]);
    view.distances.push_back(made.mean + made.deviation * deviations(scores[cells.frames[c]]));
  }
  look.views.push_back(std::move(view));
  if (look.views.size() > kRereadViews) look.views.pop_front();
}

PathReading read_again(SecondLook& look, const FilterCells& cells,
                       const std::function<ScoreScale(size_t)>& scale) {
  assert(!look.views.empty());
  const SeenView& last = look.views.back();
  const CellRun& run = run_of(cells, last.best);
  std::vector<const SeenView*> of_run;
  for (const SeenView& view : look.views)
    if (view.first >= run.first && view.first < run.first + run.count) of_run.push_back(&view);
  const Stretch stretch = around_path(of_run);
  std::vector<ScoreScale> scales;
  for (size_t c = stretch.first; c < stretch.end; ++c) scales.push_back(scale(cells.frames[c]));

  PathReading reading;
  for (const SeenView& view : look.views) {
    const uint16_t score =
        score_of(view.distances[view.best - view.first], scale(cells.frames[view.best]));
    reading.supports.push_back(static_cast<int32_t>(kScoreBias) - score);
  }
  place_filter(look.filter, cells_of(stretch, cells.places));
  std::vector<uint16_t> scores(stretch.end - stretch.first);
  for (const SeenView* view : of_run) {
    std::fill(scores.begin(), scores.end(), kWorstScore);
    const size_t offset = view->first - stretch.first;
    for (size_t k = 0; k < view->distances.size(); ++k)
      scores[offset + k] = score_of(view->distances[k], scales[offset + k]);
    advance_filter(look.filter, scores);
  }
  reading.margin = margin_near(look.filter, stretch, last.best);
  return reading;
}

}  // namespace vpr
