#include "report/loops_report.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/json.h"
#include "base/text.h"
#include "evaluation/metrics.h"
#include "ground_truth/times.h"
#include "report/metrics_report.h"

namespace vpr {
namespace {

constexpr size_t kMostLines = 20;

Json share(uint64_t part, uint64_t whole) {
  if (whole == 0) return nullptr;
  return static_cast<double>(part) / static_cast<double>(whole);
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
  if (evaluation.judgement.curve) {
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

Json wrong_loops_json(const LoopJudgement& judgement) {
  Json wrong = Json::array();
  for (const JudgedLoop& judged : judgement.loops) {
    if (judged.label != PlaceLabel::different) continue;
    Json row = {{"line", judged.loop.line},
                {"query", judged.loop.query},
                {"match", judged.loop.match},
                {"distance_m", judged.distance_m}};
    if (judged.loop.score) row["score"] = *judged.loop.score;
    wrong.push_back(row);
  }
  return wrong;
}

Json missed_json(const LoopJudgement& judgement) {
  Json missed = Json::array();
  for (const Revisit& revisit : judgement.revisits)
    if (!revisit.is_found) missed.push_back({{"first", revisit.first}, {"last", revisit.last}});
  return missed;
}

Json longest_missed_json(const LoopJudgement& judgement) {
  const auto longest = judgement.longest_missed();
  if (!longest) return nullptr;
  return {{"first", longest->first}, {"last", longest->last}};
}

uint64_t length_of(const Json& stretch) {
  if (stretch.is_null()) return 0;
  return stretch["last"].get<uint64_t>() - stretch["first"].get<uint64_t>() + 1;
}

std::string shown(const Json& value) {
  if (value.is_null()) return "-";
  return value.is_number_integer() ? value.dump() : fmt::format("{:.4f}", value.get<double>());
}

}  // namespace

Json loops_json(const LoopsEvaluation& evaluation, const RunInfo& run) {
  const LoopJudgement& judgement = evaluation.judgement;
  const uint64_t right = judgement.count(PlaceLabel::same);
  const uint64_t wrong = judgement.count(PlaceLabel::different);
  Json json = {{"schema", "vpr.loops/1"}, {"name", evaluation.name}};
  json["protocol"] = protocol_json(evaluation);
  json["trajectory"] = trajectory_json(evaluation.trajectory);
  json["loops"] = {{"listed", evaluation.list.loops.size()},
                   {"repeated", judgement.repeated},
                   {"too_near", judgement.count(PlaceLabel::ignore)},
                   {"right", right},
                   {"wrong", wrong},
                   {"precision", share(right, right + wrong)}};
  json["frames"] = {{"with_loop", judgement.frames_with_loop()},
                    {"found", judgement.frames_found()},
                    {"recall", share(judgement.frames_found(), judgement.frames_with_loop())},
                    {"longest_missed", longest_missed_json(judgement)}};
  json["revisits"] = {{"count", judgement.revisits.size()},
                      {"found", judgement.revisits_found()},
                      {"missed", missed_json(judgement)}};
  json["wrong_loops"] = wrong_loops_json(judgement);
  json["metrics"] = judgement.curve ? curve_metrics_json(*judgement.curve) : Json();
  json["curve"] = judgement.curve ? curve_json(*judgement.curve) : Json();
  json["provenance"] = provenance_json(run);
  return json;
}

std::string loops_sentence(const Json& report) {
  const Json& frames = report["frames"];
  const Json& loops = report["loops"];
  const auto judged = loops["right"].get<uint64_t>() + loops["wrong"].get<uint64_t>();
  const auto wrong = loops["wrong"].get<uint64_t>();
  const std::string of_loops =
      fmt::format("{} of {} wrong.", wrong == 0 ? "None" : fmt::to_string(wrong),
                  judged == 1 ? "1 loop is" : fmt::format("{} loops are", judged));
  if (frames["with_loop"] == 0) return "No frame is near an earlier one. " + of_loops;
  return fmt::format("{} {} of {} have a right loop; the longest stretch without one has {}.",
                     of_loops, frames["found"].dump(),
                     counted(frames["with_loop"].get<uint64_t>(), "frame near an earlier one",
                             "frames near an earlier one"),
                     counted(length_of(frames["longest_missed"]), "frame"));
}

Table loops_table(const Json& report) {
  const Json& loops = report["loops"];
  const Json& frames = report["frames"];
  Table table;
  table.title = fmt::format("{} (within {} m, {} apart)", report["name"].get<std::string>(),
                            report["protocol"]["radius_m"].dump(),
                            report["protocol"]["gap_s"].is_null()
                                ? counted(report["protocol"]["gap_frames"].get<uint64_t>(), "frame")
                                : report["protocol"]["gap_s"].dump() + " s");
  const auto add = [&](const std::string& column, const std::string& cell) {
    table.columns.push_back(column);
    if (table.rows.empty()) table.rows.emplace_back();
    table.rows[0].push_back(cell);
  };
  for (const char* key : {"listed", "right", "wrong"}) add(key, shown(loops[key]));
  add("too near", shown(loops["too_near"]));
  add("precision", shown(loops["precision"]));
  add("frames with a loop", shown(frames["with_loop"]));
  add("found", shown(frames["found"]));
  add("recall", shown(frames["recall"]));
  add("longest missed", std::to_string(length_of(frames["longest_missed"])));
  add("revisits", shown(report["revisits"]["count"]));
  add("revisits found", shown(report["revisits"]["found"]));
  if (!report["metrics"].is_null())
    for (const CurveMetric& metric : curve_metrics())
      add(std::string(metric.column), shown(report["metrics"][std::string(metric.key)]));
  return table;
}

std::string loops_mistakes(const Json& report) {
  std::string text;
  const auto add = [&](const Json& rows, const std::string& title, auto&& line) {
    if (rows.empty()) return;
    text += "\n" + title + "\n";
    for (size_t i = 0; i < std::min(rows.size(), kMostLines); ++i)
      text += "  " + line(rows[i]) + "\n";
    if (rows.size() > kMostLines) text += fmt::format("  and {} more\n", rows.size() - kMostLines);
  };
  add(report["wrong_loops"], "Wrong loops:", [](const Json& row) {
    return fmt::format("line {}: frame {} at frame {}, {:.2f} m away", row["line"].dump(),
                       row["query"].dump(), row["match"].dump(), row["distance_m"].get<double>());
  });
  add(report["revisits"]["missed"], "Revisits without a right loop:", [](const Json& row) {
    return fmt::format("frames {} to {}", row["first"].dump(), row["last"].dump());
  });
  return text;
}

}  // namespace vpr
