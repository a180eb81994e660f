// What the scripts of an evaluation's page look up.
#pragma once

#include "base/json_fwd.h"
#include "evaluation/judgement.h"
#include "report/chart.h"

namespace vpr {

/// The charts of the page, as it draws them.
struct PageCharts {
  Chart curve;
  Chart risk;
  Chart thresholds;
  Chart timeline;
  Chart matrix;
};

/// A line of data for each query, the scales of all charts (from, to, begin and end of both axes in
/// units of the SVG), frames of the axes by bands, points of the curve, and counts by threshold.
Json page_data(const Json& report, const Judgement& judgement, bool is_judged,
               const PageCharts& charts);

}  // namespace vpr
