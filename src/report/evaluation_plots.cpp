#include "report/evaluation_plots.h"

#include <fmt/format.h>

#include "base/json.h"
#include "evaluation/metrics.h"
#include "evaluation/recall_at.h"
#include "report/evaluation_report.h"
#include "report/metrics_report.h"
#include "report/plot.h"
#include "report/png_file.h"
#include "report/score_picture.h"

namespace vpr {
namespace {

constexpr size_t kMostPoints = 2000;
constexpr size_t kMatrixSide = 2000;  // pixels

PlotLine curve_line(const std::string& name, const Curve& curve) {
  PlotLine line{name, {}, PlotStyle::line};
  for (const CurvePoint& point : thinned(curve, kMostPoints))
    line.points.emplace_back(curve.recall(point), Curve::precision(point));
  return line;
}

/// Query frame against the best match's frame, in one line a verdict.
std::vector<PlotLine> timeline(const Judgement& judgement) {
  std::vector<PlotLine> lines = {{"best match wrong", {}, PlotStyle::points},
                                 {"best match right", {}, PlotStyle::points},
                                 {"recognised, wrong", {}, PlotStyle::points},
                                 {"recognised, right", {}, PlotStyle::points}};
  for (const QueryOutcome& query : judgement.outcomes.queries) {
    if (!query.best || query.verdict == Verdict::ignored) continue;
    const size_t kind =
        (is_recognised(judgement, query) ? 2 : 0) + (query.verdict == Verdict::correct ? 1 : 0);
    lines[kind].points.emplace_back(query.frame, query.best->reference);
  }
  std::erase_if(lines, [](const PlotLine& line) { return line.points.empty(); });
  return lines;
}

}  // namespace

void draw_evaluation(const Json& report, const Judgement& judgement, const GroundTruth& truth,
                     const ScoreMatrix* matrix, const std::filesystem::path& folder,
                     const Monitor& monitor) {
  const std::string title =
      fmt::format("{} on {}", method_title(report), report["query"].get<std::string>());
  Plot curves{"precision-recall", title, "recall", "precision", false, false, {}, true};
  curves.lines.push_back(curve_line("best matches", judgement.single_best));
  if (judgement.all_pairs)
    curves.lines.push_back(curve_line("all pairs", judgement.all_pairs->curve));
  std::erase_if(curves.lines, [](const PlotLine& line) { return line.points.empty(); });
  if (!curves.lines.empty()) draw_plot(curves, folder);
  if (judgement.outcomes.has_ranks && judged_queries(judgement.outcomes) > 0) {
    Plot recall{"recall-at", title, "K", "recall@K", false, false, {{"recall@K", {}}}};
    for (size_t k = 1; k <= kRecallAt.back(); ++k)
      recall.lines[0].points.emplace_back(k, *recall_at(judgement.outcomes, k));
    draw_plot(recall, folder);
  }
  const Plot matches{"timeline", title, "query frame",      "reference frame",
                     false,      false, timeline(judgement)};
  if (!matches.lines.empty()) draw_plot(matches, folder);
  write_png(folder / "matrix.png", draw_scores(judgement, truth, matrix, kMatrixSide, monitor),
            Existing::refuse)
      .commit();
}

}  // namespace vpr
