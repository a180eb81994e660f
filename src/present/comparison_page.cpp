// Pages and charts of a comparison of reports.
#include <algorithm>
#include <functional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/json.h"
#include "base/text.h"
#include "evaluate/metrics.h"
#include "present/comparison_report.h"
#include "present/evaluation_charts.h"
#include "present/html_page.h"

namespace vpr {
namespace {

constexpr double kLaneHeight = 46;
constexpr double kLaneTop = 0.45;  // of a lane; its name is above

std::string title_of(std::span<const ComparisonReport> comparisons) {
  size_t methods = 0;
  std::vector<std::string> sets;
  for (const ComparisonReport& comparison : comparisons) {
    methods = std::max(methods, comparison.reports.size());
    sets.push_back(comparison.data_set);
  }
  return fmt::format("{} on {}", counted(methods, "method"), fmt::join(sets, ", "));
}

constexpr size_t kMostNamed = 3;  // methods in the sentence

// "Best matches of 111 frames are correct in 80.4 % by mine, 61.8 % by theirs.": the best methods
// first.
std::string sentence_of(const ComparisonReport& comparison) {
  std::vector<const ComparedValue*> values;
  for (const ComparedValue& value : comparison.found.values)
    if (value.metric == metric_at("recall_at", 1) && value.value &&
        comparison.is_paired(value.method))
      values.push_back(&value);
  if (values.empty()) return "No frame has a match.";
  std::ranges::stable_sort(values, std::greater(), [](const auto* value) { return *value->value; });
  std::string text = fmt::format("Best matches of {} are correct in ", comparison.frames());
  for (size_t i = 0; i < std::min(values.size(), kMostNamed); ++i)
    text += fmt::format("{}{:.1f} % by {}", i == 0 ? "" : ", ", 100 * *values[i]->value,
                        comparison.reports[values[i]->method].row_name);
  return text + (values.size() > kMostNamed ? ", less by others." : ".");
}

/// One curve per report, over its frames with a match; empty without frames or scores.
Chart curves_overlay(const std::string& title, std::span<const Report> reports) {
  Chart chart = precision_recall_chart(title);
  for (const Report& report : reports) {
    const Curve curve = single_best_curve(report.frames.outcomes);
    const auto area = find_metric("average_precision").of_curve(curve).value;
    Series series{
        fmt::format("{}: {}{}{}", report.row_name, counted(curve.positives, "frame"),
                    area ? fmt::format(", AP {:.4f}", *area) : "",
                    report.frames.outcomes.confidence == Confidence::margin ? ", by margin" : ""),
        {},
        SeriesStyle::line};
    if (curve.is_measurable()) series.points = curve_points(curve);
    chart.series.push_back(series);
  }
  return chart;
}

/// The verdicts of all query frames, one lane per report. Lanes of different selections differ in
/// length.
Chart lanes_chart(const std::string& title, std::span<const Report> reports) {
  Chart chart{"lanes", title, {"query frame"}};
  for (const Meaning meaning : {Meaning::unjudged, Meaning::incorrect, Meaning::correct})
    chart.series.push_back(series_of(meaning, SeriesStyle::boxes));
  size_t frames = 1;
  for (size_t r = 0; r < reports.size(); ++r) {
    const auto top = static_cast<double>(r);
    for (const ChartStretch& run : verdict_stretches(reports[r].frames.verdicts)) {
      Series& boxes = *std::ranges::find(chart.series, run.meaning, &Series::meaning);
      boxes.points.emplace_back(run.begin, top + kLaneTop);
      boxes.points.emplace_back(run.end, top + 0.95);
    }
    frames = std::max(frames, reports[r].frames.verdicts.size());
    chart.y.ticks.push_back({top + kLaneTop, reports[r].row_name});
  }
  erase_empty_series(chart);
  chart.y.has_text_inside = true;
  chart.x.range = {0, static_cast<double>(frames)};
  chart.y.range = {static_cast<double>(reports.size()), 0};
  chart.width = 1180;
  chart.height = 90 + kLaneHeight * static_cast<double>(reports.size());
  return chart;
}

}  // namespace

std::string comparison_page(std::span<const ComparisonReport> comparisons) {
  std::vector<Json> jsons;
  for (const ComparisonReport& comparison : comparisons)
    jsons.push_back(comparison_json(comparison));
  Json made = jsons.front()["provenance"];
  std::string numbers;
  if (comparisons.size() == 1)  // of several, the table with intervals has all columns
    numbers = table_html(compared_methods(comparisons, TableDetail::full, false));
  numbers += table_html(compared_methods(comparisons, TableDetail::brief, true));
  std::string figures;
  std::string sentences;
  std::string truths;
  for (size_t i = 0; i < comparisons.size(); ++i) {
    const ComparisonReport& comparison = comparisons[i];
    const std::string set = comparisons.size() == 1 ? "" : comparison.data_set + ": ";
    made[set + "bootstrap"] = jsons[i]["bootstrap"];
    Chart curves = curves_overlay(
        set + "Precision and recall of best matches, over frames with a match", comparison.reports);
    curves.width = 650;
    curves.height = 450;
    figures += figure_html(lanes_chart(set + "Recognitions along the path", comparison.reports)) +
               figure_html(curves);
    sentences += (sentences.empty() ? "" : " ") + set + sentence_of(comparison);
    truths += (truths.empty() ? "Ground truth: " : "; ") + set +
              comparison.reports.front().protocol.ground_truth;
  }
  for (const Table& differences : difference_tables(comparisons))
    numbers += table_html(differences);
  return sections_page(title_of(comparisons), sentences, truths,
                       section_html("Paths and curves", figures) + section_html("Numbers", numbers),
                       jsons.front()["protocol"], made);
}

void draw_comparison(std::span<const ComparisonReport> comparisons,
                     const std::filesystem::path& folder, const FigureSettings& figure) {
  for (size_t i = 0; i < comparisons.size(); ++i) {
    const std::string title = title_of(comparisons.subspan(i, 1));
    for (Chart chart : {curves_overlay(title, comparisons[i].reports),
                        lanes_chart(title, comparisons[i].reports)}) {
      if (comparisons.size() > 1) chart.file += fmt::format("-{}", i + 1);
      draw_chart(in_figure(chart, figure), folder);
    }
  }
}

}  // namespace vpr
