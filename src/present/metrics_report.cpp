#include "present/metrics_report.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/json.h"
#include "base/text.h"
#include "evaluate/metrics.h"
#include "evaluate/outcomes.h"
#include "present/json_fields.h"

namespace vpr {
namespace {

constexpr size_t kMostPoints = 100;  // of a curve in a report

// At most `most` points, evenly spaced by their place, first and last among them.
std::vector<CurvePoint> thinned(const Curve& curve, size_t most) {
  const size_t count = curve.points.size();
  if (count <= most) return curve.points;
  std::vector<CurvePoint> points;
  for (size_t i = 0; i < most; ++i) points.push_back(curve.points[i * (count - 1) / (most - 1)]);
  return points;
}

// JSON has no infinity.
Json threshold_json(std::optional<double> threshold) {
  return threshold && std::isfinite(*threshold) ? Json(*threshold) : Json();
}

// The key of best matches by the confidence that is not in force.
const char* other_key(Confidence confidence) {
  return confidence == Confidence::score ? "by_margin" : "by_score";
}

Json achievement_json(const Judgement& judgement) {
  const auto recalls = local_recalls(judgement.outcomes, judgement.stretch_frames);
  const auto known = std::ranges::count_if(recalls, [](const auto& r) { return r.has_value(); });
  Json json = {{"stretch_frames", judgement.stretch_frames}, {"stretches", known}};
  for (const double target : kRecallTargets)
    json["targets"][fmt::format("{:g}", target)] = or_null(recall_achievement(recalls, target));
  return json;
}

Json metrics_json(const Judgement& judgement) {
  Json json = {{"single_best", curve_metrics_json(judgement.single_best)}};
  if (judgement.outcomes.has_ranks)
    json["single_best"]["tied_queries"] = tied_queries(judgement.outcomes);
  if (judgement.other_best)
    json[other_key(judgement.outcomes.confidence)] = curve_metrics_json(*judgement.other_best);
  if (judgement.all_pairs) {
    json["all_pairs"] = curve_metrics_json(judgement.all_pairs->curve);
    json["all_pairs"]["same_without_score"] = judgement.all_pairs->same_without_score;
    json["all_pairs"]["ignored"] = judgement.all_pairs->ignored;
  }
  Json recall = Json::object();
  for (const size_t k : judgement.recall_at)
    if (k == 1 || judgement.outcomes.has_ranks)
      recall[std::to_string(k)] = or_null(recall_at(judgement.outcomes, k));
  json["recall_at"] = recall;
  json["recall_achievement"] = achievement_json(judgement);
  if (!judgement.outcomes.has_ranks) return json;
  for (const size_t k : judgement.recall_at) {
    if (k > kMostRanked) continue;
    json["precision_at"][std::to_string(k)] = or_null(precision_at(judgement.outcomes, k));
    json["map_at"][std::to_string(k)] = or_null(mean_average_precision_at(judgement.outcomes, k));
  }
  return json;
}

Json localisation_json(const Judgement& judgement) {
  const Localisation& found = judgement.localisation;
  return {{"frames", found.frames},
          {"frames_with_match", judgement.frames_with_match},
          {"right", found.right},
          {"wrong", found.wrong},
          {"share", or_null(found.share())},
          {"longest_gap_frames", found.longest_gap_frames},
          {"longest_gap_m", or_null(found.longest_gap_m)},
          {"first_fix_frames", or_null(found.first_fix_frames)},
          {"first_fix_m", or_null(found.first_fix_m)}};
}

char letter_of(const QueryOutcome& query) {
  switch (query.verdict) {
    case Verdict::correct:
      return 'c';
    case Verdict::incorrect:
      return query.has_match ? 'w' : query.is_unreachable ? 'b' : 'n';
    case Verdict::ignored:
      return 'i';
    case Verdict::unreadable:
      return 'u';
  }
  return 'u';
}

char letter_of(Fix fix) {
  constexpr std::string_view kLetters = ".rwi";
  return kLetters[static_cast<size_t>(fix)];
}

Json outcomes_json(const Outcomes& outcomes) {
  std::string letters;
  std::string scores;
  std::string ranks;
  std::string margins;
  for (const QueryOutcome& query : outcomes.queries) {
    const std::string space = letters.empty() ? "" : " ";
    letters += letter_of(query);
    scores += query.best ? fmt::format("{}{}", space, score_of_key(query.key, outcomes.kind))
                         : space + "-";
    ranks += query.rank ? fmt::format("{}{}", space, *query.rank) : space + "-";
    margins += query.margin ? fmt::format("{}{}", space, *query.margin) : space + "-";
  }
  Json json = {{"first_frame", outcomes.window_length - 1},
               {"scores_are", enum_name(outcomes.kind)},
               {"best", letters},
               {"scores", scores}};
  if (outcomes.has_margins) json["margins"] = margins;
  if (outcomes.has_ranks) json["ranks"] = ranks;
  return json;
}

std::vector<std::string> metric_cells(const Json& mode) {
  std::vector<std::string> cells;
  for (const CurveMetric& metric : curve_metrics())
    cells.push_back(shown(mode.value(std::string(metric.key), Json()), 4));
  return cells;
}

Table curve_table(const Json& report) {
  const Json& best = report["best_match"];
  const Json& metrics = report["metrics"];
  Table table;
  table.title = fmt::format(
      "Metrics ({} with a match; {} without one, wrong if accepted{}; {} ignored, {} "
      "unreadable, left out{})",
      counted(best["queries"].get<uint64_t>(), "query", "queries"), best["without_match"].dump(),
      best["unreachable"] == 0
          ? ""
          : fmt::format("; {} whose place lies where no training window ends, likewise",
                        best["unreachable"].dump()),
      best["ignored"].dump(), best["unreadable"].dump(),
      metrics["single_best"].contains("tied_queries")
          ? fmt::format("; {} tied, to the first", metrics["single_best"]["tied_queries"].dump())
          : "");
  table.columns = {"of", "to find"};
  for (const CurveMetric& metric : curve_metrics()) table.columns.emplace_back(metric.column);
  const auto add = [&](const std::string& name, const Json& mode) {
    table.rows.push_back({name, mode["to_find"].dump()});
    for (std::string& cell : metric_cells(mode)) table.rows.back().push_back(std::move(cell));
  };
  const bool by_margin = report.contains("confidence");
  add(by_margin ? "best matches, by margin" : "best matches", metrics["single_best"]);
  for (const auto& [key, name] :
       {std::pair("by_margin", "the same by margin"), std::pair("by_score", "the same by score")})
    if (metrics.contains(key)) add(name, metrics[key]);
  if (metrics.contains("all_pairs")) add("all pairs", metrics["all_pairs"]);
  return table;
}

// A column for each value, in the first row; `prefix` goes before its key.
void add_values(Table& table, const std::string& prefix, const Json& values) {
  for (const auto& item : values.items()) {
    table.columns.push_back(prefix + item.key());
    table.rows[0].push_back(shown(item.value(), 4));
  }
}

Table recall_table(const Json& report) {
  Table table;
  table.title =
      "Recall@K (queries with a match; ties to the first; ignored references passed over)";
  table.rows.emplace_back();
  add_values(table, "R@", report["metrics"]["recall_at"]);
  return table;
}

// No columns where ranks are unknown.
Table ranking_table(const Json& report) {
  const Json& metrics = report["metrics"];
  Table table;
  table.title =
      "Precision@K and mAP@K (queries with a match; ties to the first; ignored references passed "
      "over)";
  table.rows.emplace_back();
  for (const auto& [key, name] : {std::pair("precision_at", "P@"), std::pair("map_at", "mAP@")})
    if (metrics.contains(key)) add_values(table, name, metrics[key]);
  return table;
}

Table achievement_table(const Json& report) {
  const Json& found = report["metrics"]["recall_achievement"];
  Table table;
  table.rows.emplace_back();
  table.title = fmt::format(
      "Recall achievement rate (share of {} of about {} whose recall@1 reaches the target)",
      counted(found["stretches"].get<uint64_t>(), "stretch", "stretches"),
      counted(found["stretch_frames"].get<uint64_t>(), "frame"));
  add_values(table, "RAR ", found["targets"]);
  return table;
}

Table localisation_table(const Json& report) {
  const Json& found = report["localisation"];
  Table table;
  table.title =
      fmt::format("Along the path ({})", report["protocol"]["localisation"].get<std::string>());
  table.columns = {"frames", "right", "wrong", "share", "longest gap", "first fix"};
  table.rows = {{found["frames"].dump(), found["right"].dump(), found["wrong"].dump(),
                 shown(found["share"], 4), found["longest_gap_frames"].dump(),
                 shown(found["first_fix_frames"], 0)}};
  if (found["longest_gap_m"].is_null()) return table;
  table.columns.insert(table.columns.end(), {"longest gap m", "first fix m"});
  table.rows[0].push_back(shown(found["longest_gap_m"], 2));
  table.rows[0].push_back(shown(found["first_fix_m"], 2));
  return table;
}

}  // namespace

std::vector<std::pair<double, double>> curve_points(const Curve& curve, size_t most) {
  std::vector<std::pair<double, double>> points;
  for (const CurvePoint& point : thinned(curve, most))
    points.emplace_back(curve.recall(point), Curve::precision(point));
  return points;
}

Json curve_metrics_json(const Curve& curve) {
  Json json = {{"to_find", curve.to_find}};
  Json thresholds = Json::object();
  for (const CurveMetric& metric : curve_metrics()) {
    const MetricValue value = metric.compute(curve);
    json[std::string(metric.key)] = or_null(value.value);
    if (value.threshold) thresholds[std::string(metric.key)] = threshold_json(value.threshold);
  }
  json["thresholds"] = thresholds;
  return json;
}

Json curve_json(const Curve& curve) {
  Json points = Json::array();
  for (const CurvePoint& point : thinned(curve, kMostPoints))
    points.push_back({{"threshold", threshold_json(curve.threshold(point))},
                      {"correct", point.correct},
                      {"incorrect", point.incorrect}});
  return {{"thresholds", curve.points.size()}, {"points", points}};
}

void add_judgement(Json& report, const Judgement& judgement) {
  report["metrics"] = metrics_json(judgement);
  report["localisation"] = localisation_json(judgement);
  if (judgement.outcomes.confidence != Confidence::score)
    report["confidence"] = enum_name(judgement.outcomes.confidence);
  if (judgement.is_oracle) report["oracle"] = true;
  report["curves"] = {{"single_best", curve_json(judgement.single_best)}};
  if (judgement.other_best)
    report["curves"][other_key(judgement.outcomes.confidence)] = curve_json(*judgement.other_best);
  if (judgement.all_pairs) report["curves"]["all_pairs"] = curve_json(judgement.all_pairs->curve);
  report["outcomes"] = outcomes_json(judgement.outcomes);
  std::string fixes;
  for (const Fix fix : judgement.fixes) fixes += letter_of(fix);
  report["outcomes"]["fixes"] = fixes;
}

void add_metrics_protocol(Json& protocol, const Judgement& judgement, bool is_result) {
  const bool has_ranks = judgement.outcomes.has_ranks;
  protocol["single_best"] = fmt::format(
      "a {}; recall is over queries with a match; the best match of a query without one is "
      "incorrect; {}",
      judgement.outcomes.confidence == Confidence::margin
          ? "margin accepts best matches that have at least this margin"
          : "threshold accepts best matches that score at least as good",
      has_ranks ? "references labelled ignore are passed over"
                : "a query whose best match is labelled ignore is left out");
  if (judgement.outcomes.has_margins)
    protocol["margin"] =
        "how much better the best match is than the best one elsewhere, in score a frame; a best "
        "match without one is never accepted by its margin";
  if (judgement.all_pairs)
    protocol["all_pairs"] =
        "a threshold accepts pairs that score at least as good; recall is over all pairs of the "
        "same place; pairs labelled ignore, and queries without any score, are left out";
  if (has_ranks)
    protocol["precision_at"] =
        "right references among the K best, of K; mAP@K: mean over queries of the precision at "
        "each right one among the K best, of as many right ones as K can hold";
  protocol["recall_achievement"] =
      "the path is cut into stretches of about as many frames; share of those with a query to "
      "find whose recall@1 reaches the target";
  protocol["ties"] =
      "equal scores are accepted together; the best match, and ranks, take the first";
  protocol["localisation"] =
      is_result ? "a frame's fix is its closest recognition"
                : fmt::format(
                      "a frame's fix is its best match where it scores at least as good as "
                      "{}{}",
                      judgement.threshold ? fmt::format("{:.6g}", *judgement.threshold)
                                          : "any correct one before the first mistake",
                      judgement.is_oracle ? ", a threshold chosen from the ground truth" : "");
}

std::string shown(const Json& value, int digits) {
  if (value.is_null()) return "-";
  if (value.is_number_integer()) return value.dump();
  return fmt::format("{:.{}f}", value.get<double>(), digits);
}

std::vector<Table> metrics_tables(const Json& report) {
  std::vector<Table> tables = {curve_table(report)};
  if (report["metrics"]["recall_at"].size() > 1) tables.push_back(recall_table(report));
  if (report["metrics"].contains("precision_at")) tables.push_back(ranking_table(report));
  tables.push_back(achievement_table(report));
  tables.push_back(localisation_table(report));
  return tables;
}

void append_metrics(Table& table, const Json& report) {
  const auto add = [&](const std::string& column, const std::string& value) {
    table.columns.push_back(column);
    table.rows.front().push_back(value);
  };
  for (const auto& [key, name] :
       {std::pair("single_best", "best"), std::pair("by_margin", "margin"),
        std::pair("by_score", "score"), std::pair("all_pairs", "pairs")}) {
    if (!report["metrics"].contains(key)) continue;
    const std::vector<std::string> cells = metric_cells(report["metrics"][key]);
    for (size_t m = 0; m < cells.size(); ++m)
      add(fmt::format("{} {}", name, curve_metrics()[m].column), cells[m]);
  }
  for (const Table& more : {recall_table(report), ranking_table(report), achievement_table(report),
                            localisation_table(report)})
    for (size_t c = 0; c < more.columns.size(); ++c) add(more.columns[c], more.rows[0][c]);
}

}  // namespace vpr
