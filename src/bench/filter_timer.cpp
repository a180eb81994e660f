#include "bench/filter_timer.h"

#include <cmath>

#include "base/error.h"
#include "matching/match_filter.h"
#include "matching/plain_filter.h"
#include "matching/score_kernels.h"
#include "matching/standardized_frames.h"

namespace vpr {

void time_filter(const MatchingCase& example, const ScoreBasis& basis, const Effort& effort,
                 const Monitor& monitor, BenchRow& row) {
  const FrameDistances scores = standardized(example.distances, basis, monitor);
  FilteredQuery query = start_filtered(scores, example.settings);
  size_t next = 0;
  size_t seen = 0;
  size_t views = 0;
  row.time = summarise(time_repeatedly(
      effort,
      [&] {
        take_frame(query, scores, next);
        views += query.view == next ? 1 : 0;
        ++seen;
        next = (next + 1) % scores.query_frames;
      },
      monitor));
  row.values.emplace_back("places", static_cast<double>(query.filter.cells.places));
  row.values.emplace_back("view_share", static_cast<double>(views) / static_cast<double>(seen));
}

void check_filter_values(const MatchingCase& example, const ScoreBasis& basis,
                         const Monitor& monitor) {
  constexpr size_t kCheckedViews = 5;
  const FrameDistances scores = standardized(example.distances, basis, monitor);
  FilteredQuery query = start_filtered(scores, example.settings);
  PlainFilter plain = start_plain_filter(query.filter.cells, example.settings.filter);
  const FilterState& filter = query.filter;
  for (size_t frame = 0; frame < kCheckedViews; ++frame) {
    query.view.reset();  // every frame counts
    take_frame(query, scores, frame);
    advance_plain_filter(plain, query.scores);
    for (const CellRun& run : filter.cells.runs)
      for (size_t cell = run.first; cell < run.first + run.count; ++cell) {
        const double value = (static_cast<double>(filter.values[cell]) - kScoreBias) / kScoreUnit;
        if (std::abs(value - plain_value(plain, cell)) > filter_tolerance(frame + 1))
          throw Error(ErrorKind::expectation,
                      "filter: a value differs from its definition; nothing was timed");
      }
  }
}

}  // namespace vpr
