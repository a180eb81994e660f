#include "bench/filter_timer.h"

#include "matching/match_filter.h"
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

}  // namespace vpr
