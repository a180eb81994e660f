#include "present/loops_report.h"

#include <algorithm>
#include <array>
#include <utility>

#include <fmt/format.h>

#include "base/json.h"
#include "base/json_fields.h"
#include "base/text.h"
#include "evaluate/metrics.h"
#include "present/evaluation_charts.h"
#include "present/evaluation_tables.h"
#include "present/html_page.h"
#include "present/route_map.h"
#include "truth/times.h"

namespace vpr {
namespace {

constexpr size_t kMostLines = 20;  // of a list of mistakes

std::optional<double> share(uint64_t part, uint64_t whole) {
  if (whole == 0) return std::nullopt;
  return static_cast<double>(part) / static_cast<double>(whole);
}

std::optional<double> precision(const LoopJudgment& judgment) {
  const uint64_t right = judgment.count(PlaceLabel::same);
  return share(right, right + judgment.count(PlaceLabel::different));
}

std::optional<double> recall(const LoopJudgment& judgment) {
  return share(judgment.frames_found(), judgment.frames_with_loop());
}

Json seconds(int64_t nanoseconds) { return static_cast<double>(nanoseconds) / double{kSecond}; }

std::string gap_words(const LoopGap& gap) {
  return gap.nanoseconds ? fmt::format("{} s", time_text(*gap.nanoseconds))
                         : counted(gap.frames, "frame");
}

Json protocol_json(const LoopsEvaluation& evaluation) {
  const LoopRules& rules = evaluation.rules;
  Json protocol = {
      {"radius_m", rules.radius_m},
      {"gap_s", rules.gap.nanoseconds ? seconds(*rules.gap.nanoseconds) : Json()},
      {"gap_frames", rules.gap.nanoseconds ? Json() : Json(rules.gap.frames)},
      {"loop",
       fmt::format("a loop is right if its two positions are within {} m, and one is at least {} "
                   "before the other; closer in time it is left out, neither right nor wrong",
                   rules.radius_m, gap_words(rules.gap))},
      {"frames",
       "a frame has a loop if any frame so long before it is that near; recall is the share of "
       "these frames of which a right loop is listed, and precision the share of right loops"},
      {"revisits", "consecutive frames with a loop are one revisit, found by one right loop"}};
  if (evaluation.judgment.curve) {
    protocol["scores_are"] = enum_name(rules.order);
    protocol["curve"] =
        "a threshold accepts the best loop of each frame if it scores at least as good; equal "
        "scores are accepted together; of equals the best is the first that is listed";
  }
  return protocol;
}

Json trajectory_json(const Trajectory& trajectory) {
  const auto known =
      static_cast<size_t>(std::count_if(trajectory.poses.begin(), trajectory.poses.end(),
                                        [](const auto& pose) { return pose.has_value(); }));
  return {{"frames", trajectory.poses.size()},
          {"poses", known},
          {"duration_s", trajectory.times_ns.empty()
                             ? Json()
                             : seconds(trajectory.times_ns.back() - trajectory.times_ns.front())}};
}

std::vector<JudgedLoop> wrong_loops(const LoopJudgment& judgment) {
  std::vector<JudgedLoop> wrong;
  for (const JudgedLoop& judged : judgment.loops)
    if (judged.label == PlaceLabel::different) wrong.push_back(judged);
  return wrong;
}

Json wrong_loops_json(const LoopJudgment& judgment) {
  Json wrong = Json::array();
  for (const JudgedLoop& judged : wrong_loops(judgment)) {
    Json row = {{"line", judged.loop.line},
                {"query", judged.loop.query},
                {"match", judged.loop.match},
                {"distance_m", judged.distance_m}};
    if (judged.loop.score) row["score"] = *judged.loop.score;
    wrong.push_back(row);
  }
  return wrong;
}

Json stretch_json(const Revisit& stretch) {
  return {{"first", stretch.first}, {"last", stretch.last}};
}

std::vector<Revisit> missed_revisits(const LoopJudgment& judgment) {
  std::vector<Revisit> missed;
  for (const Revisit& revisit : judgment.revisits)
    if (!revisit.is_found) missed.push_back(revisit);
  return missed;
}

Json missed_json(const LoopJudgment& judgment) {
  Json missed = Json::array();
  for (const Revisit& revisit : missed_revisits(judgment)) missed.push_back(stretch_json(revisit));
  return missed;
}

size_t longest_missed_frames(const LoopJudgment& judgment) {
  const auto longest = judgment.longest_missed();
  return longest ? longest->last - longest->first + 1 : 0;
}

constexpr size_t kMostDrawn = 2000;  // librsvg takes minutes for 100 000 that cross each other

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

// Of more than kMostDrawn loops, those at even distances in the list; the legend says so.
Series loop_series(const LoopsEvaluation& evaluation, const std::array<size_t, 2>& axes,
                   PlaceLabel label, const std::string& name) {
  std::vector<const ListedLoop*> loops;
  for (const JudgedLoop& judged : evaluation.judgment.loops)
    if (judged.label == label) loops.push_back(&judged.loop);
  Series lines{name, {}, SeriesStyle::line, meaning_of(label)};
  const size_t drawn = std::min(loops.size(), kMostDrawn);
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
  for (size_t frame = 0; frame < evaluation.judgment.is_found.size(); ++frame)
    if (evaluation.judgment.is_found[frame])
      found.points.push_back(point_of(*evaluation.trajectory.poses[frame], axes));
  return found;
}

Series missed_series(const LoopsEvaluation& evaluation, const std::array<size_t, 2>& axes) {
  Series missed{
      "frame with a loop, none listed", {}, SeriesStyle::points, Meaning::missed, SeriesMark::dot};
  const LoopJudgment& judgment = evaluation.judgment;
  for (size_t frame = 0; frame < judgment.has_loop.size(); ++frame)
    if (judgment.has_loop[frame] && !judgment.is_found[frame])
      missed.points.push_back(point_of(*evaluation.trajectory.poses[frame], axes));
  return missed;
}

/// Precision against recall of every frame's best loop. No series where the list has no scores.
Chart curve_chart(const LoopsEvaluation& evaluation) {
  Chart chart = precision_recall_chart(evaluation.name);
  if (!evaluation.judgment.curve || evaluation.judgment.curve->points.empty()) return chart;
  const Curve& curve = *evaluation.judgment.curve;
  Series series{"best loop of every frame", {}, SeriesStyle::line, Meaning::best_matches};
  series.points = curve_points(curve, 1000);
  chart.series.push_back(series);
  return chart;
}

/// The names of a chart's series, beside their colors.
std::string legend_of(const Chart& chart) {
  std::string html;
  for (const Series& series : chart.series)
    if (!series.name.empty() && series.meaning)
      html += fmt::format("<span class=\"entry\"><span class=\"key {}\"></span>{}</span> ",
                          color_of(*series.meaning).name, html_escaped(series.name));
  return html;
}

std::string figure(const Chart& chart) {
  return fmt::format("<figure><figcaption>{}</figcaption>{}<p class=\"legend\">{}</p></figure>",
                     chart.title, page_svg(chart), legend_of(chart));
}

std::string charts_html(const LoopsEvaluation& evaluation) {
  Chart map = loops_map_chart(evaluation);
  map.title = "Loops on the trajectory";
  std::string html = "<div class=\"charts\">" + figure(map);
  Chart curve = curve_chart(evaluation);
  curve.title = "Precision and recall";
  curve.width = 650;
  curve.height = 450;
  if (!curve.series.empty()) html += figure(curve);
  return html + "</div>";
}

}  // namespace

Json loops_json(const LoopsEvaluation& evaluation, const RunInfo& run) {
  const LoopJudgment& judgment = evaluation.judgment;
  const auto longest = judgment.longest_missed();
  Json json = {{"schema", "vpr.loops/1"}, {"name", evaluation.name}};
  json["protocol"] = protocol_json(evaluation);
  json["trajectory"] = trajectory_json(evaluation.trajectory);
  json["loops"] = {{"listed", evaluation.list.loops.size()},
                   {"repeated", judgment.repeated},
                   {"too_near", judgment.count(PlaceLabel::ignore)},
                   {"right", judgment.count(PlaceLabel::same)},
                   {"wrong", judgment.count(PlaceLabel::different)},
                   {"precision", or_null(precision(judgment))}};
  json["frames"] = {{"with_loop", judgment.frames_with_loop()},
                    {"found", judgment.frames_found()},
                    {"recall", or_null(recall(judgment))},
                    {"longest_missed", longest ? stretch_json(*longest) : Json()}};
  json["revisits"] = {{"count", judgment.revisits.size()},
                      {"found", judgment.revisits_found()},
                      {"missed", missed_json(judgment)}};
  json["wrong_loops"] = wrong_loops_json(judgment);
  json["metrics"] = judgment.curve ? curve_numbers_json(numbers_of(*judgment.curve)) : Json();
  json["curve"] = judgment.curve ? curve_json(reported_curve(*judgment.curve)) : Json();
  json["provenance"] = provenance_json(run);
  return json;
}

std::string loops_sentence(const LoopsEvaluation& evaluation) {
  const LoopJudgment& judgment = evaluation.judgment;
  const uint64_t wrong = judgment.count(PlaceLabel::different);
  const uint64_t judged = judgment.count(PlaceLabel::same) + wrong;
  const std::string of_loops =
      fmt::format("{} of {} wrong.", wrong == 0 ? "None" : fmt::to_string(wrong),
                  judged == 1 ? "1 loop is" : fmt::format("{} loops are", judged));
  if (judgment.frames_with_loop() == 0) return "No frame is near an earlier one. " + of_loops;
  return fmt::format("{} {} of {} have a right loop; the longest stretch without one has {}.",
                     of_loops, judgment.frames_found(),
                     counted(judgment.frames_with_loop(), "frame near an earlier one",
                             "frames near an earlier one"),
                     counted(longest_missed_frames(judgment), "frame"));
}

Table loops_table(const LoopsEvaluation& evaluation) {
  const LoopJudgment& judgment = evaluation.judgment;
  const LoopGap& gap = evaluation.rules.gap;
  Table table;
  // Numbers as in JSON: 2.0 m.
  table.title = fmt::format(
      "{} (within {} m, {} apart)", evaluation.name, Json(evaluation.rules.radius_m).dump(),
      gap.nanoseconds ? seconds(*gap.nanoseconds).dump() + " s" : counted(gap.frames, "frame"));
  const auto count = [&](const std::string& column, uint64_t number) {
    add_column(table, column, number);
  };
  const auto share = [&](const std::string& column, std::optional<double> value) {
    add_column(table, column, value ? fmt::format("{:.4f}", *value) : "-");
  };
  count("listed", evaluation.list.loops.size());
  count("right", judgment.count(PlaceLabel::same));
  count("wrong", judgment.count(PlaceLabel::different));
  count("too near", judgment.count(PlaceLabel::ignore));
  share("precision", precision(judgment));
  count("frames with a loop", judgment.frames_with_loop());
  count("found", judgment.frames_found());
  share("recall", recall(judgment));
  count("longest missed", longest_missed_frames(judgment));
  count("revisits", judgment.revisits.size());
  count("revisits found", judgment.revisits_found());
  if (judgment.curve)
    for (const Metric& metric : curve_metrics())
      add_column(table, metric.symbol, metric_cell(metric, metric.of_curve(*judgment.curve).value));
  return table;
}

std::string loops_mistakes(const LoopsEvaluation& evaluation) {
  std::string text;
  const auto add = [&](const auto& rows, const std::string& title, auto&& line) {
    if (rows.empty()) return;
    text += "\n" + title + "\n";
    for (size_t i = 0; i < std::min(rows.size(), kMostLines); ++i)
      text += "  " + line(rows[i]) + "\n";
    if (rows.size() > kMostLines) text += fmt::format("  and {} more\n", rows.size() - kMostLines);
  };
  add(wrong_loops(evaluation.judgment), "Wrong loops:", [](const JudgedLoop& judged) {
    const ListedLoop& loop = judged.loop;
    return fmt::format("line {}: frame {} at frame {}, {:.2f} m away", loop.line, loop.query,
                       loop.match, judged.distance_m);
  });
  add(missed_revisits(evaluation.judgment),
      "Revisits without a right loop:", [](const Revisit& revisit) {
        return fmt::format("frames {} to {}", revisit.first, revisit.last);
      });
  return text;
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
  const Chart curve = curve_chart(evaluation);
  if (!curve.series.empty()) draw_chart(curve, folder);
}

std::string loops_page(const LoopsEvaluation& evaluation, const RunInfo& run) {
  const Json protocol = protocol_json(evaluation);
  Json made = provenance_json(run);
  made["command_line"] = run.command_line;
  const std::string mistakes = loops_mistakes(evaluation);
  const std::string sections =
      section_html("Numbers", table_html(loops_table(evaluation))) +
      section_html("On the way", charts_html(evaluation)) +
      (mistakes.empty() ? ""
                        : "<section><h2>Mistakes</h2><pre>" + html_escaped(mistakes.substr(1)) +
                              "</pre></section>");
  return sections_page("Loop closures: " + evaluation.name, loops_sentence(evaluation),
                       protocol["loop"].get<std::string>(), sections, protocol, made);
}

}  // namespace vpr
