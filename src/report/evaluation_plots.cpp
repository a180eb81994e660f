#include "report/evaluation_plots.h"

#include <fmt/format.h>
#include <opencv2/core/mat.hpp>

#include "base/json.h"
#include "evaluation/metrics.h"
#include "evaluation/recall_at.h"
#include "report/evaluation_report.h"
#include "report/frame_axis.h"
#include "report/metrics_report.h"
#include "report/plot.h"
#include "report/score_picture.h"
#include "report/timeline.h"

namespace vpr {
namespace {

constexpr size_t kMostPoints = 2000;
constexpr size_t kMostTruth = 1000;   // frames whose ground truth is drawn
constexpr size_t kMatrixSide = 1000;  // pixels
constexpr size_t kMostTicks = 10;

PlotLine curve_line(Meaning meaning, const Curve& curve) {
  PlotLine line{std::string(colour_of(meaning).words), {}, PlotStyle::line, hex_of(meaning)};
  for (const CurvePoint& point : thinned(curve, kMostPoints))
    line.points.emplace_back(curve.recall(point), Curve::precision(point));
  return line;
}

PlotLine marks_line(Meaning meaning, PlotMark mark) {
  return {std::string(colour_of(meaning).words), {}, PlotStyle::points, hex_of(meaning), mark};
}

void set_axis(const std::vector<FrameBand>& bands, std::vector<PlotTick>& ticks,
              std::vector<PlotBand>& names) {
  for (const AxisTick& tick : ticks_of(bands, kMostTicks))
    ticks.push_back({tick.position, std::to_string(tick.frame)});
  for (const FrameBand& band : bands)
    if (!band.name.empty()) names.push_back({static_cast<double>(band.at), band.name});
}

PlotLine truth_line(const Judgement& judgement, const GroundTruth& truth,
                    const std::vector<FrameBand>& bands, const Monitor& monitor) {
  PlotLine line = marks_line(Meaning::truth, PlotMark::square);
  line.style = PlotStyle::boxes;
  for (const TruthBox& box : truth_boxes(judgement, truth, bands, kMostTruth, monitor)) {
    line.points.emplace_back(box.begin, box.low);
    line.points.emplace_back(box.end, box.high);
  }
  return line;
}

}  // namespace

Plot timeline_plot(const Json& report, const Judgement& judgement, const GroundTruth& truth,
                   const Monitor& monitor) {
  Plot plot{"timeline", evaluation_title(report), "query frame", reference_word(report)};
  const std::vector<FrameBand> bands = frame_bands(judgement.layout);
  const size_t frames = judgement.fixes.size();
  set_axis({{"", 0, 0, 0, frames}}, plot.x_ticks, plot.x_bands);
  set_axis(bands, plot.y_ticks, plot.y_bands);
  plot.x_end = std::max<double>(1, static_cast<double>(frames));
  plot.y_end = std::max<double>(1, static_cast<double>(length_of(bands)));
  plot.lines.push_back(truth_line(judgement, truth, bands, monitor));
  const std::vector<TimelineMark> marks = timeline_marks(judgement, bands);
  for (const Meaning meaning : kMarkOrder) {
    PlotLine line = marks_line(meaning, is_weak(meaning) ? PlotMark::dot : PlotMark::disc);
    for (const TimelineMark& mark : marks)
      if (mark.meaning == meaning)
        line.points.emplace_back(static_cast<double>(mark.frame) + 0.5,
                                 static_cast<double>(mark.position) + 0.5);
    plot.lines.push_back(line);
  }
  std::erase_if(plot.lines, [](const PlotLine& line) { return line.points.empty(); });
  return plot;
}

Plot matrix_plot(const Json& report, const Judgement& judgement, const GroundTruth& truth,
                 const ScoreMatrix* matrix, const Monitor& monitor) {
  const ScorePicture picture = draw_scores(judgement, truth, matrix, kMatrixSide, monitor);
  Plot plot{"matrix", evaluation_title(report), reference_word(report), "query frame"};
  set_axis(column_bands(judgement.layout), plot.x_ticks, plot.x_bands);
  set_axis(row_bands(judgement.layout), plot.y_ticks, plot.y_bands);
  PlotImage image{static_cast<size_t>(picture.image.cols), static_cast<size_t>(picture.image.rows),
                  static_cast<double>(picture.cells)};
  for (int y = 0; y < picture.image.rows; ++y)
    for (int x = 0; x < picture.image.cols; ++x) {
      const auto& pixel = picture.image.at<cv::Vec3b>(y, x);
      image.rgb.insert(image.rgb.end(), {pixel[2], pixel[1], pixel[0]});
    }
  image.columns = static_cast<double>(column_count(judgement.layout));
  image.rows = static_cast<double>(row_count(judgement.layout));
  image.greys = picture.greys;
  image.grey_label = score_words(report);
  plot.image = std::move(image);
  for (const Meaning meaning : picture.shown)
    plot.lines.push_back(marks_line(meaning, PlotMark::square));
  return plot;
}

void draw_evaluation(const Json& report, const Judgement& judgement, const GroundTruth& truth,
                     const ScoreMatrix* matrix, const std::filesystem::path& folder,
                     const Monitor& monitor) {
  Plot curves{
      "precision-recall", evaluation_title(report), "recall", "precision", false, false, {}, true};
  curves.lines.push_back(curve_line(Meaning::best_matches, judgement.single_best));
  if (judgement.all_pairs)
    curves.lines.push_back(curve_line(Meaning::all_pairs, judgement.all_pairs->curve));
  std::erase_if(curves.lines, [](const PlotLine& line) { return line.points.empty(); });
  if (!curves.lines.empty()) draw_plot(curves, folder);
  if (judgement.outcomes.has_ranks && judged_queries(judgement.outcomes) > 0) {
    Plot recall{"recall-at", evaluation_title(report), "K", "recall@K"};
    PlotLine& line = recall.lines.emplace_back(PlotLine{"recall@K", {}});
    line.colour = hex_of(Meaning::best_matches);
    for (size_t k = 1; k <= kRecallAt.back(); ++k)
      line.points.emplace_back(k, *recall_at(judgement.outcomes, k));
    draw_plot(recall, folder);
  }
  const Plot timeline = timeline_plot(report, judgement, truth, monitor);
  if (!timeline.lines.empty()) draw_plot(timeline, folder);
  draw_plot(matrix_plot(report, judgement, truth, matrix, monitor), folder);
}

}  // namespace vpr
