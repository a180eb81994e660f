#include "report/comparison_charts.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "report/metrics_report.h"

namespace vpr {
namespace {

constexpr size_t kMostPoints = 1000;
constexpr double kLaneGap = 0.15;  // on both sides of a lane that is 1 high
constexpr double kLaneHeight = 34;

/// A meaning, or none, for each frame from the first on.
struct Lane {
  size_t first = 0;
  std::vector<std::optional<Meaning>> frames;
};

Lane lane_of_fixes(const std::string& fixes) {
  Lane lane;
  for (const char letter : fixes)
    lane.frames.push_back(letter == 'r'   ? std::optional(Meaning::right)
                          : letter == 'w' ? std::optional(Meaning::wrong)
                          : letter == 'i' ? std::optional(Meaning::unjudged)
                                          : std::nullopt);
  return lane;
}

Lane lane_of_best_matches(const Outcomes& outcomes) {
  Lane lane;
  if (!outcomes.queries.empty()) lane.first = outcomes.queries.front().frame;
  for (const QueryOutcome& query : outcomes.queries) {
    auto& meaning = lane.frames.emplace_back();
    if (query.key == kNoScore) continue;
    if (query.verdict == Verdict::correct) meaning = Meaning::weak_right;
    if (query.verdict == Verdict::incorrect) meaning = Meaning::weak_wrong;
    if (query.verdict == Verdict::ignored) meaning = Meaning::weak_unjudged;
  }
  return lane;
}

// A box for each run of frames that mean the same, in the lane that is `row` lanes from the top.
void add_lane(std::vector<Series>& series, const Lane& lane, size_t row) {
  const auto& frames = lane.frames;
  for (size_t begin = 0; begin < frames.size();) {
    size_t end = begin;
    while (end < frames.size() && frames[end] == frames[begin]) ++end;
    if (frames[begin]) {
      Series& boxes = *std::ranges::find(series, frames[begin], &Series::meaning);
      boxes.points.emplace_back(lane.first + begin, static_cast<double>(row + 1) - kLaneGap);
      boxes.points.emplace_back(lane.first + end, static_cast<double>(row) + kLaneGap);
    }
    begin = end;
  }
}

}  // namespace

Chart curves_overlay(const std::string& title, std::span<const StoredReport> reports,
                     const std::vector<std::string>& names) {
  Chart chart{"precision-recall", title, {"recall"}};
  chart.y.label = "precision";
  chart.x.range = chart.y.range = {0, 1};
  for (size_t r = 0; r < reports.size(); ++r) {
    const Curve curve = single_best_curve(reports[r].outcomes);
    Series series{names[r], {}, SeriesStyle::line};
    if (curve.to_find > 0)
      for (const CurvePoint& point : thinned(curve, kMostPoints))
        series.points.emplace_back(curve.recall(point), Curve::precision(point));
    chart.series.push_back(series);
  }
  return chart;
}

Chart lanes_chart(const std::string& title, std::span<const StoredReport> reports,
                  const std::vector<std::string>& names) {
  Chart chart{"lanes", title, {"query frame"}};
  for (const Meaning meaning : {Meaning::weak_unjudged, Meaning::weak_wrong, Meaning::weak_right,
                                Meaning::unjudged, Meaning::wrong, Meaning::right})
    chart.series.push_back(series_of(meaning, SeriesStyle::boxes));
  size_t frames = 1;
  for (size_t r = 0; r < reports.size(); ++r) {
    const Lane lane = reports[r].fixes.empty() ? lane_of_best_matches(reports[r].outcomes)
                                               : lane_of_fixes(reports[r].fixes);
    add_lane(chart.series, lane, r);
    frames = std::max(frames, lane.first + lane.frames.size());
    chart.y.ticks.push_back({static_cast<double>(r) + 0.5, names[r]});
  }
  std::erase_if(chart.series, [](const Series& series) { return series.points.empty(); });
  chart.x.range = {0, static_cast<double>(frames)};
  chart.y.range = {static_cast<double>(reports.size()), 0};
  chart.width = 1000;
  chart.height = 130 + kLaneHeight * static_cast<double>(reports.size());
  return chart;
}

}  // namespace vpr
