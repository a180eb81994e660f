#include "loops/loops_report.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <utility>

#include <fmt/format.h>

#include "base/json_schema.h"
#include "base/statistics.h"
#include "base/text.h"
#include "evaluate/metrics.h"
#include "evaluate/report_fields.h"
#include "present/evaluation_charts.h"
#include "present/evaluation_text.h"
#include "present/html_page.h"
#include "present/report_tables.h"
#include "truth/times.h"

namespace vpr {

VPR_FIELDS(Revisit, (first, "Its first frame."), (last, "Its last frame."))

namespace {

std::optional<double> precision(const LoopJudgment& judgment) {
  const uint64_t correct = judgment.count(PlaceLabel::same);
  return share_of(correct, correct + judgment.count(PlaceLabel::different));
}

std::optional<double> recall(const LoopJudgment& judgment) {
  return share_of(judgment.frames_found(), judgment.frames_with_loop());
}

std::string share_text(std::optional<double> share) {
  return share ? fmt::format("{:.4f}", *share) : "-";
}

double seconds(int64_t nanoseconds) { return static_cast<double>(nanoseconds) / double{kSecond}; }

std::string gap_words(const LoopGap& gap) {
  return gap.nanoseconds ? fmt::format("{} s", time_text(*gap.nanoseconds))
                         : counted(gap.frames, "frame");
}

/// Definition of a loop, in words and numbers.
struct LoopProtocol {
  double radius_m = 0;
  std::optional<double> gap_s;
  std::optional<size_t> gap_frames;
  std::string loop, frames, revisits;
  std::optional<double> angle_deg, ignore_radius_m;
  std::optional<ScoreOrder> score_order;
  std::optional<std::string> curve;
};

template <class Visitor>
void visit_fields(LoopProtocol& protocol, Visitor&& visit) {
  visit("radius_m", protocol.radius_m, "Largest distance of a loop.", at_least(0));
  visit("gap_s", protocol.gap_s, "Least time between the frames of a loop; null: gap_frames.",
        above(0));
  visit("gap_frames", protocol.gap_frames,
        "Least frames between the frames of a loop; null: gap_s.", at_least(1));
  visit("loop", protocol.loop, "Definition of verdicts.");
  visit("frames", protocol.frames, "Definition of recall and precision.");
  visit("revisits", protocol.revisits, "Definition of a revisit.");
  visit("angle_deg", IfSet{protocol.angle_deg},
        "Largest difference of headings of a loop; absent: any.", at_least(0));
  visit("ignore_radius_m", IfSet{protocol.ignore_radius_m},
        "Loops beyond radius_m, up to this distance, are ignored.", at_least(0));
  visit("score_order", IfSet{protocol.score_order}, "Direction of the scores.");
  visit("curve", IfSet{protocol.curve}, "Definition of the curve.");
}

LoopProtocol protocol_of(const LoopsEvaluation& evaluation) {
  const LoopRules& rules = evaluation.rules;
  LoopProtocol protocol;
  protocol.radius_m = rules.nearness.radius_m;
  if (rules.gap.nanoseconds)
    protocol.gap_s = seconds(*rules.gap.nanoseconds);
  else
    protocol.gap_frames = rules.gap.frames;
  protocol.loop = fmt::format(
      "a loop is correct if its two positions are within {} m, and one is at least {} "
      "before the other; closer in time it is omitted, neither correct nor incorrect",
      rules.nearness.radius_m, gap_words(rules.gap));
  protocol.frames =
      "a frame has a loop if an earlier frame, by at least the gap, shows the same place; recall "
      "is the share of "
      "these frames of which a correct loop is listed, and precision the share of correct loops";
  protocol.revisits = "consecutive frames with a loop are one revisit, found by one correct loop";
  protocol.angle_deg = rules.nearness.angle_deg;
  protocol.ignore_radius_m = rules.nearness.ignore_radius_m;
  if (evaluation.judgment.curve) {
    protocol.score_order = rules.order;
    protocol.curve =
        "a threshold accepts the best loop of each frame if it scores at least as well; equal "
        "scores are accepted together; of equals the best is the first that is listed";
  }
  return protocol;
}

struct TrajectoryCounts {
  size_t frames = 0, poses = 0;
  std::optional<double> duration_s;
};
VPR_FIELDS(TrajectoryCounts, (frames, "Its frames."), (poses, "Those with a pose."),
           (duration_s, "From first to last time."))

struct LoopCounts {
  uint64_t listed = 0, repeated = 0, too_near = 0, ignored = 0, correct = 0, incorrect = 0;
  std::optional<double> precision;
};
VPR_FIELDS(LoopCounts, (listed, "Lines of the list."), (repeated, "Repeated pairs."),
           (too_near, "Excluded by the gap."), (ignored, "Up to the ignore radius."),
           (correct, "Within the radius."), (incorrect, "Farther apart."),
           (precision, "correct / (correct + incorrect).", within(0, 1)))

struct FramesWithLoop {
  uint64_t with_loop = 0, found = 0;
  std::optional<double> recall;
  std::optional<Revisit> longest_missed;
};
VPR_FIELDS(FramesWithLoop, (with_loop, "Frames with a loop."),
           (found, "Those with a correct loop."), (recall, "found / with_loop.", within(0, 1)),
           (longest_missed,
            "The longest stretch of consecutive frames with a loop of which none is found; null "
            "where all are."))

struct RevisitCounts {
  uint64_t count = 0, found = 0;
  std::vector<Revisit> missed;
};
VPR_FIELDS(RevisitCounts, (count, "How many."), (found, "Those with a correct loop."),
           (missed, "The others."))

struct IncorrectLoop {
  size_t line = 0, query = 0, match = 0;
  std::optional<double> distance_m, score;
};

template <class Visitor>
void visit_fields(IncorrectLoop& loop, Visitor&& visit) {
  visit("line", loop.line, "Line in the file, from 1.");
  visit("query", loop.query, "The later frame.");
  visit("match", loop.match, "The earlier frame.");
  visit("distance_m", loop.distance_m, "Distance, in meters; null: on another floor.", at_least(0));
  visit("score", IfSet{loop.score}, "Its score; absent where the list has none.");
}

struct LoopsFile {
  std::string name;
  LoopProtocol protocol;
  TrajectoryCounts trajectory;
  LoopCounts loops;
  FramesWithLoop frames;
  RevisitCounts revisits;
  std::vector<IncorrectLoop> incorrect_loops;
  std::optional<CurveNumbers> metrics;
  std::optional<ReportedCurve> curve;
  Provenance provenance;
};

VPR_FILE(LoopsFile, "loops", (name, "Name of the list (--name; default: its file)."),
         (protocol, "Definition of a loop, in words and numbers."), (trajectory, "The trajectory."),
         (loops, "The loops of the list."), (frames, "The frames of the trajectory."),
         (revisits, "Stretches of consecutive frames with a loop."),
         (incorrect_loops, "Every incorrect loop, in the order of the list."),
         (metrics, "Metrics of the curve; null without scores."),
         (curve, "The curve, at most 100 points; null without scores."),
         (provenance, kProvenanceText))

TrajectoryCounts counts_of(const Trajectory& trajectory) {
  const auto known = std::ranges::count_if(trajectory.poses, &std::optional<Pose>::has_value);
  TrajectoryCounts counts{trajectory.poses.size(), static_cast<size_t>(known), {}};
  if (!trajectory.times_ns.empty())
    counts.duration_s = seconds(trajectory.times_ns.back() - trajectory.times_ns.front());
  return counts;
}

std::vector<JudgedLoop> incorrect_loops(const LoopJudgment& judgment) {
  std::vector<JudgedLoop> wrong;
  std::ranges::copy_if(judgment.loops, std::back_inserter(wrong), [](const JudgedLoop& judged) {
    return judged.label == PlaceLabel::different;
  });
  return wrong;
}

std::vector<Revisit> missed_revisits(const LoopJudgment& judgment) {
  std::vector<Revisit> missed;
  std::ranges::copy_if(judgment.revisits, std::back_inserter(missed),
                       [](const Revisit& revisit) { return !revisit.is_found; });
  return missed;
}

size_t longest_missed_frames(const LoopJudgment& judgment) {
  const auto longest = judgment.longest_missed();
  return longest ? longest->last - longest->first + 1 : 0;
}

constexpr size_t kMostDrawn = 2000;  // librsvg needs minutes for 100 000 crossing lines

/// The two coordinates with the largest extents, in their order: x and z for a camera that looks
/// ahead, x and y for a map.
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

// At most kMostDrawn loops, evenly spaced in the list; the legend states their number.
Series loop_series(const LoopsEvaluation& evaluation, const std::array<size_t, 2>& axes,
                   PlaceLabel label, const std::string& name) {
  std::vector<const ListedLoop*> loops;
  for (const JudgedLoop& judged : evaluation.judgment.loops)
    if (judged.label == label) loops.push_back(&judged.loop);
  Series lines{name, {}, SeriesStyle::line, meaning_of(verdict_of(label))};
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

Series frame_series(const LoopsEvaluation& evaluation, const std::array<size_t, 2>& axes,
                    bool is_found) {
  Series frames{"frame with a correct loop", {}, SeriesStyle::points, Meaning::correct};
  if (!is_found)
    frames = {"frame with a loop, none listed",
              {},
              SeriesStyle::points,
              Meaning::missed,
              SeriesMark::dot};
  const LoopJudgment& judgment = evaluation.judgment;
  for (size_t frame = 0; frame < judgment.has_loop.size(); ++frame)
    if (judgment.is_found[frame] == is_found && (is_found || judgment.has_loop[frame]))
      frames.points.push_back(point_of(*evaluation.trajectory.poses[frame], axes));
  return frames;
}

/// Precision against recall of the best loop per frame. No series without scores.
Chart curve_chart(const LoopsEvaluation& evaluation) {
  Chart chart = precision_recall_chart(evaluation.name);
  if (const auto& curve = evaluation.judgment.curve; curve && !curve->points.empty())
    chart.series.push_back({"best loop of every frame", curve_points(*curve), SeriesStyle::line,
                            Meaning::best_matches});
  return chart;
}

std::string charts_html(const LoopsEvaluation& evaluation) {
  Chart map = loops_map_chart(evaluation);
  map.title = "Loops on the trajectory";
  Chart curve = curve_chart(evaluation);
  curve.title = "Precision and recall";
  curve.width = 650;
  curve.height = 450;
  return figure_html(map) + (curve.series.empty() ? "" : figure_html(curve));
}

// "3 of 190 loops are incorrect. 17 of 20 frames near an earlier one have a correct loop; ..."
std::string loops_sentence(const LoopsEvaluation& evaluation) {
  const LoopJudgment& judgment = evaluation.judgment;
  const uint64_t incorrect = judgment.count(PlaceLabel::different);
  const uint64_t judged = judgment.count(PlaceLabel::same) + incorrect;
  const std::string of_loops =
      fmt::format("{} of {} incorrect.", incorrect == 0 ? "None" : fmt::to_string(incorrect),
                  judged == 1 ? "1 loop is" : fmt::format("{} loops are", judged));
  if (judgment.frames_with_loop() == 0) return "No frame is near an earlier one. " + of_loops;
  return fmt::format("{} {} of {} have a correct loop; the longest stretch without one has {}.",
                     of_loops, judgment.frames_found(),
                     counted(judgment.frames_with_loop(), "frame near an earlier one",
                             "frames near an earlier one"),
                     counted(longest_missed_frames(judgment), "frame"));
}

}  // namespace

Json loops_json(const LoopsEvaluation& evaluation, const RunInfo& run) {
  const LoopJudgment& judgment = evaluation.judgment;
  LoopsFile file;
  file.name = evaluation.name;
  file.protocol = protocol_of(evaluation);
  file.trajectory = counts_of(evaluation.trajectory);
  file.loops = {evaluation.list.loops.size(),
                judgment.repeated,
                judgment.too_near(),
                judgment.count(PlaceLabel::ignore) - judgment.too_near(),
                judgment.count(PlaceLabel::same),
                judgment.count(PlaceLabel::different),
                precision(judgment)};
  file.frames = {judgment.frames_with_loop(), judgment.frames_found(), recall(judgment),
                 judgment.longest_missed()};
  file.revisits = {judgment.revisits.size(), judgment.revisits_found(), missed_revisits(judgment)};
  for (const auto& [loop, distance_m, label, is_too_near] : incorrect_loops(judgment)) {
    file.incorrect_loops.push_back({loop.line, loop.query, loop.match, {}, loop.score});
    if (std::isfinite(distance_m)) file.incorrect_loops.back().distance_m = distance_m;
  }
  if (judgment.curve) file.metrics = numbers_of(*judgment.curve);
  if (judgment.curve) file.curve = reported_curve(*judgment.curve);
  file.provenance = provenance_of(run);
  return value_to_json(file, kDataForm);
}

Json loops_schema() { return with_run(schema_of<LoopsFile>()); }

Table loops_table(const LoopsEvaluation& evaluation) {
  const LoopJudgment& judgment = evaluation.judgment;
  const LoopGap& gap = evaluation.rules.gap;
  const Nearness& nearness = evaluation.rules.nearness;
  Table table;
  table.title =
      fmt::format("{} (within {} m{}, {} apart)", evaluation.name, Json(nearness.radius_m).dump(),
                  nearness.angle_deg ? fmt::format(" and {:g} degrees", *nearness.angle_deg) : "",
                  gap.nanoseconds ? Json(seconds(*gap.nanoseconds)).dump() + " s"
                                  : counted(gap.frames, "frame"));
  add_column(table, "listed", evaluation.list.loops.size());
  add_column(table, "correct", judgment.count(PlaceLabel::same));
  add_column(table, "incorrect", judgment.count(PlaceLabel::different));
  add_column(table, "too near", judgment.too_near());
  if (nearness.ignore_radius_m)
    add_column(table, "ignored", judgment.count(PlaceLabel::ignore) - judgment.too_near());
  add_column(table, "precision", share_text(precision(judgment)));
  add_column(table, "frames with a loop", judgment.frames_with_loop());
  add_column(table, "found", judgment.frames_found());
  add_column(table, "recall", share_text(recall(judgment)));
  add_column(table, "longest missed", longest_missed_frames(judgment));
  add_column(table, "revisits", judgment.revisits.size());
  add_column(table, "revisits found", judgment.revisits_found());
  if (judgment.curve)
    for (const Metric& metric : curve_metrics())
      add_column(table, metric.symbol, metric_cell(metric, metric.of_curve(*judgment.curve).value));
  return table;
}

std::string loops_mistakes(const LoopsEvaluation& evaluation, size_t most) {
  std::string text;
  const auto add = [&](const auto& rows, const std::string& title, auto&& line) {
    if (rows.empty()) return;
    text += "\n" + title + "\n";
    for (size_t i = 0; i < std::min(rows.size(), most); ++i) text += "  " + line(rows[i]) + "\n";
    if (rows.size() > most) text += fmt::format("  and {} more\n", rows.size() - most);
  };
  add(incorrect_loops(evaluation.judgment), "Incorrect loops:", [](const JudgedLoop& judged) {
    const ListedLoop& loop = judged.loop;
    return fmt::format("line {}: frame {} at frame {}, {}", loop.line, loop.query, loop.match,
                       std::isfinite(judged.distance_m)
                           ? fmt::format("{:.2f} m away", judged.distance_m)
                           : "on another floor");
  });
  add(missed_revisits(evaluation.judgment),
      "Revisits without a correct loop:", [](const Revisit& revisit) {
        return fmt::format("frames {} to {}", revisit.first, revisit.last);
      });
  return text;
}

std::string loops_text(const LoopsEvaluation& evaluation) {
  const LoopJudgment& judgment = evaluation.judgment;
  std::string text = wrapped_text(loops_sentence(evaluation));
  text += fmt::format("  precision {} of loops, recall {} of frames; {} of {} found\n",
                      share_text(precision(judgment)), share_text(recall(judgment)),
                      judgment.revisits_found(), counted(judgment.revisits.size(), "revisit"));
  if (judgment.curve)
    text +=
        fmt::format("  AP {}, R@100P {}\n", share_text(average_precision(*judgment.curve).value),
                    share_text(recall_at_full_precision(*judgment.curve).value));
  return text + loops_mistakes(evaluation, 1);
}

Chart loops_map_chart(const LoopsEvaluation& evaluation) {
  const auto axes = plan_axes(evaluation.trajectory.poses);
  return plan_chart(
      "loops", evaluation.name,
      {path_series(evaluation.trajectory.poses, axes), frame_series(evaluation, axes, false),
       loop_series(evaluation, axes, PlaceLabel::same, ""), frame_series(evaluation, axes, true),
       loop_series(evaluation, axes, PlaceLabel::different, "incorrect loop")});
}

void draw_loops(const LoopsEvaluation& evaluation, const std::filesystem::path& folder) {
  draw_chart(loops_map_chart(evaluation), folder);
  const Chart curve = curve_chart(evaluation);
  if (!curve.series.empty()) draw_chart(curve, folder);
}

std::string loops_page(const LoopsEvaluation& evaluation, const RunInfo& run) {
  const Json protocol = value_to_json(protocol_of(evaluation), kDataForm);
  Json made = provenance_json(run);
  made["command_line"] = run.command_line;
  const std::string mistakes = loops_mistakes(evaluation);
  const std::string sections =
      section_html("Along the path", charts_html(evaluation)) +
      section_html("Numbers",
                   table_html(loops_table(evaluation)) +
                       (mistakes.empty()
                            ? ""
                            : folded_html("Mistakes",
                                          "<pre>" + html_escaped(mistakes.substr(1)) + "</pre>")));
  return sections_page("Loop closures: " + evaluation.name, loops_sentence(evaluation),
                       "Protocol: " + protocol["loop"].get<std::string>(), sections, protocol,
                       made);
}

}  // namespace vpr
