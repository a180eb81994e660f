#include "report/loops_charts.h"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "report/metrics_report.h"
#include "report/route_map.h"

namespace vpr {
namespace {

constexpr size_t kMostPoints = 1000;
constexpr size_t kMostLines = 2000;  // librsvg takes minutes for 100 000 that cross each other

/// The two coordinates with the largest extents, in their order: x and z of a camera that looks
/// ahead, x and y of a map.
std::array<size_t, 2> plan_axes(const Poses& poses) {
  const std::array<double, 3> extents = extents_of(poses);
  const auto flat = static_cast<size_t>(std::min_element(extents.rbegin(), extents.rend()).base() -
                                        extents.begin() - 1);
  return {flat == 0 ? size_t{1} : 0, flat == 2 ? size_t{1} : 2};
}

using Point = std::pair<double, double>;

Point point_of(const Pose& pose, const std::array<size_t, 2>& axes) {
  return {pose.position[axes[0]], pose.position[axes[1]]};
}

Series path_series(const Poses& poses, const std::array<size_t, 2>& axes) {
  Series path{"trajectory", {}, SeriesStyle::line, Meaning::train_path};
  for (const auto& pose : poses) path.points.push_back(pose ? point_of(*pose, axes) : kChartGap);
  return path;
}

// Of more than kMostLines loops, those at even distances in the list; the legend says so.
Series loop_series(const LoopsEvaluation& evaluation, const std::array<size_t, 2>& axes,
                   PlaceLabel label, const std::string& name) {
  std::vector<const ListedLoop*> loops;
  for (const JudgedLoop& judged : evaluation.judgement.loops)
    if (judged.label == label) loops.push_back(&judged.loop);
  Series lines{name, {}, SeriesStyle::line, meaning_of(label)};
  const size_t drawn = std::min(loops.size(), kMostLines);
  if (drawn < loops.size() && !name.empty())
    lines.name += fmt::format(" ({} of {})", drawn, loops.size());
  const Poses& poses = evaluation.trajectory.poses;
  for (size_t i = 0; i < drawn; ++i) {
    const ListedLoop& loop = *loops[i * loops.size() / drawn];
    lines.points.insert(lines.points.end(), {point_of(*poses[loop.query], axes),
                                             point_of(*poses[loop.match], axes), kChartGap});
  }
  return lines;
}

Series found_series(const LoopsEvaluation& evaluation, const std::array<size_t, 2>& axes) {
  Series found{
      "frame with a right loop", {}, SeriesStyle::points, Meaning::right, SeriesMark::disc};
  for (size_t frame = 0; frame < evaluation.judgement.is_found.size(); ++frame)
    if (evaluation.judgement.is_found[frame])
      found.points.push_back(point_of(*evaluation.trajectory.poses[frame], axes));
  return found;
}

Series missed_series(const LoopsEvaluation& evaluation, const std::array<size_t, 2>& axes) {
  Series missed{
      "frame with a loop, none listed", {}, SeriesStyle::points, Meaning::missed, SeriesMark::dot};
  const LoopJudgement& judgement = evaluation.judgement;
  for (size_t frame = 0; frame < judgement.has_loop.size(); ++frame)
    if (judgement.has_loop[frame] && !judgement.is_found[frame])
      missed.points.push_back(point_of(*evaluation.trajectory.poses[frame], axes));
  return missed;
}

}  // namespace

Chart loops_curve_chart(const LoopsEvaluation& evaluation) {
  Chart chart{"precision-recall", evaluation.name, {"recall"}};
  chart.y.label = "precision";
  chart.x.range = chart.y.range = {0, 1};
  if (!evaluation.judgement.curve || evaluation.judgement.curve->points.empty()) return chart;
  const Curve& curve = *evaluation.judgement.curve;
  Series series{"best loop of every frame", {}, SeriesStyle::line, Meaning::best_matches};
  for (const CurvePoint& point : thinned(curve, kMostPoints))
    series.points.emplace_back(curve.recall(point), Curve::precision(point));
  chart.series.push_back(series);
  return chart;
}

Chart loops_map_chart(const LoopsEvaluation& evaluation) {
  Chart chart{"loops", evaluation.name};
  chart.is_plan = true;
  chart.y.from_zero = false;
  chart.width = 675;
  const auto axes = plan_axes(evaluation.trajectory.poses);
  Series right_lines = loop_series(evaluation, axes, PlaceLabel::same, "");
  chart.series = {path_series(evaluation.trajectory.poses, axes), missed_series(evaluation, axes),
                  right_lines, found_series(evaluation, axes),
                  loop_series(evaluation, axes, PlaceLabel::different, "wrong loop")};
  chart.series.push_back(scale_bar(chart.series));
  std::erase_if(chart.series, [](const Series& drawn) { return drawn.points.empty(); });
  return chart;
}

void draw_loops(const LoopsEvaluation& evaluation, const std::filesystem::path& folder) {
  draw_chart(loops_map_chart(evaluation), folder);
  const Chart curve = loops_curve_chart(evaluation);
  if (!curve.series.empty()) draw_chart(curve, folder);
}

}  // namespace vpr
