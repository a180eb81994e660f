#include "report/live_line.h"

#include <algorithm>
#include <cmath>

namespace vpr {
namespace {

Json number_or_null(double value) { return std::isnan(value) ? Json() : Json(value); }

Json match_json(const Result& result, const Match& match) {
  const size_t length = result.window_length();
  return {{"sequence", result.targets[match.target].name},
          {"frame", anchor_of(match.train, length)},
          {"score", result.score().frame_value(match.score, length)},
          {"sum", static_cast<int64_t>(match.score)}};
}

size_t count_hits(const Result& result, size_t window) {
  return static_cast<size_t>(std::count_if(result.hits.begin(), result.hits.end(),
                                           [&](const Match& hit) { return hit.query == window; }));
}

}  // namespace

Json live_line(const LineFrame& frame, const Result* result, size_t window) {
  Json line = {{"schema", "vpr.live/1"},
               {"frame", frame.number},
               {"name", frame.name},
               {"readable", frame.is_readable},
               {"match", nullptr},
               {"margin", nullptr},
               {"nowhere", nullptr},
               {"rate", nullptr},
               {"hits", 0},
               {"recognised", false}};
  if (result == nullptr) return line;
  const size_t length = result->window_length();
  if (result->best[window]) line["match"] = match_json(*result, *result->best[window]);
  if (const auto margin = frame_margin(*result, window)) line["margin"] = *margin;
  if (result->path) {
    const double nowhere = result->path->nowhere[window];
    line["nowhere"] = number_or_null(
        std::isnan(nowhere) ? nowhere : result->score().frame_value(nowhere, length));
    line["rate"] = number_or_null(result->path->rates[window]);
  }
  const size_t hits = count_hits(*result, window);
  line["hits"] = hits;
  line["recognised"] = hits > 0;
  return line;
}

}  // namespace vpr
