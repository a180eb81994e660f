#include "report/evaluation_report.h"

#include <fmt/format.h>

#include "base/json.h"
#include "base/text.h"
#include "ground_truth/check.h"
#include "matching/methods.h"
#include "report/json_fields.h"
#include "report/metrics_report.h"
#include "report/scores_report.h"

namespace vpr {
namespace {

constexpr size_t kMostPlaces = 20;  // in a printed list

Json label_counts_json(const LabelCounts& counts) {
  return {
      {"correct", counts.correct}, {"incorrect", counts.incorrect}, {"ignored", counts.ignored}};
}

// Every place with what its hits are: the place is judged at its mean, whatever they say.
Json recognitions_json(const Result& result, const std::vector<JudgedCluster>& judged) {
  Json json = Json::array();
  const size_t length = result.window_length();
  for (size_t c = 0; c < judged.size(); ++c) {
    const Cluster& cluster = result.clusters->all[c];
    const auto anchors = [&](size_t first, size_t last) {
      return Json{anchor_of(first, length), anchor_of(last, length)};
    };
    json.push_back({{"sequence", result.targets[cluster.target].name},
                    {"query", anchor_of(cluster.query_window, length)},
                    {"query_range", anchors(cluster.query_first, cluster.query_last)},
                    {"train", anchor_of(cluster.train_window, length)},
                    {"train_range", anchors(cluster.train_first, cluster.train_last)},
                    {"label", enum_name(judged[c].label)},
                    {"hits", label_counts_json(judged[c].hits)}});
  }
  return json;
}

void add_window_protocol(Json& protocol, const SequenceQuerySettings& settings) {
  const std::string_view measure =
      has_paths(settings.method) ? "path score" : score_kind(settings.score).measure;
  protocol["anchor"] = "a window is judged at its last frame";
  protocol["hits"] = fmt::format(fmt::runtime(decision_kind(settings.decision).hits), measure);
  protocol["places"] = "clusters of hits, judged at their mean";
  protocol["mixed_places"] = "correct places of whose hits some are incorrect";
  protocol["distinct"] = "correct places";
  protocol["best_match"] = fmt::format(
      "the window with the lowest {}, ties to the first; rate = correct / (queries - "
      "ignored)",
      measure);
  protocol["without_match"] =
      "a query window whose anchor has no match in the ground truth is not among the queries";
  protocol["unreachable"] =
      "neither is one whose anchor has matches only where no training window ends";
}

void add_place_protocol(Json& protocol) {
  protocol["hits"] = "pairs of a frame and a place of which a view is above t_p for c_w frames";
  protocol["distinct"] = "places recognised correctly at least once";
  protocol["best_match"] =
      "the place of the likeliest view, the new place left out, ties to the first; a frame without "
      "words is wrong; rate = correct / (queries - ignored)";
  protocol["without_match"] =
      "a frame without a match in the ground truth is not among the queries";
}

constexpr const char* kViewProtocol =
    "frames in a row that look alike are one view; a pair of views with hits, and a query view "
    "with "
    "best matches, counts once: correct or incorrect if all of its windows are, else mixed; rate = "
    "mean over query views of the share of their windows that is right";

Json view_counts_json(const ViewCounts& counts) {
  return {{"correct", counts.correct},
          {"incorrect", counts.incorrect},
          {"mixed", counts.mixed},
          {"ignored", counts.ignored}};
}

Json counts_by_view_json(const CountsByView& counts) {
  Json json = {{"query_views", counts.query_views},
               {"train_views", counts.train_views},
               {"hits", view_counts_json(counts.hits)},
               {"best_match", view_counts_json(counts.best_match)}};
  json["best_match"]["rate"] = or_null(counts.best_match_rate());
  return json;
}

// Settings of raw distances name no score, and those of FAB-MAP have another threshold.
const ScoreKind& score_kind_of(const Json& settings) {
  if (settings.contains(std::string(probability_kind().threshold_symbol)))
    return probability_kind();
  const auto named = enum_value<Score>(settings.value("score", std::string()));
  return score_kind(named.value_or(Score::raw));
}

// What hits were decided by: t_r, t_p, or the setting of another decision.
std::string_view decided_by(const Json& settings) {
  const auto decision = enum_value<Decision>(settings.value("decide", std::string()));
  return decision ? decision_kind(*decision).symbol : score_kind_of(settings).threshold_symbol;
}

std::string text(const Json& json) {
  return json.is_string() ? json.get<std::string>() : json.dump();
}

std::string range_text(const Json& range) {
  const std::string first = text(range[0]);
  return range[0] == range[1] ? first : fmt::format("{} to {}", first, text(range[1]));
}

// Of a place in a report.
std::string verdict_text(const Json& place) {
  if (place["label"] == enum_name(PlaceLabel::different)) return "wrong";
  if (place["label"] == enum_name(PlaceLabel::ignore)) return "ignored";
  return place["hits"]["incorrect"] == 0 ? "right" : "mixed";
}

}  // namespace

Json counts_json(const Counts& counts) {
  Json json = {{"hits", label_counts_json(counts.hits)}};
  if (counts.clusters) {
    json["places"] = label_counts_json(*counts.clusters);
    json["mixed_places"] = counts.mixed_clusters;
  }
  json["distinct"] = counts.distinct;
  return json;
}

Json best_match_json(const BestMatchCounts& counts) {
  return {{"queries", counts.queries},         {"correct", counts.correct},
          {"ignored", counts.ignored},         {"without_match", counts.without_match},
          {"unreachable", counts.unreachable}, {"unreadable", counts.unreadable},
          {"rate", or_null(counts.rate())}};
}

Json protocol_json(const GroundTruth& truth) {
  return {{"ground_truth", truth.protocol}, {"tolerance_frames", truth.tolerance_frames}};
}

namespace {

Json result_report_json(const Evaluation& evaluation, const RunInfo& run, const Monitor& monitor) {
  const auto& [result, counts, by_view, clusters] = *evaluation.result;
  const GroundTruth& truth = evaluation.truth;
  const Judgement& judgement = evaluation.judgement;
  Json json = {{"schema", "vpr.report/1"}, {"method", method_of(result.settings)}};
  json["query"] = result.query_name;
  if (result.replay) add_replay(json, *result.replay);
  json["settings"] = settings_in_force(result.settings);
  json["counts"] = counts_json(counts);
  json["best_match"] = best_match_json(counts.best_match);
  if (by_view) json["by_view"] = counts_by_view_json(*by_view);
  if (result.clusters) json["recognitions"] = recognitions_json(result, clusters);
  add_judgement(json, judgement);
  json["protocol"] = protocol_json(truth);
  if (result.places)
    add_place_protocol(json["protocol"]);
  else
    add_window_protocol(json["protocol"], std::get<SequenceQuerySettings>(result.settings));
  if (result.path) json["protocol"]["places"] = "confirmed tracks, judged at their middle frame";
  if (by_view) json["protocol"]["by_view"] = kViewProtocol;
  add_metrics_protocol(json["protocol"], judgement, true);
  json["provenance"] = provenance_json(run);
  json["provenance"]["result"] = evaluation.fingerprint;
  json["provenance"]["ground_truth"] =
      ground_truth_fingerprint(truth, judgement.layout.scope, monitor);
  return json;
}

// What a report is of, for titles: the name that the user gave; else the method, and the score
// where it is not raw distances.
std::string method_title(const Json& report) {
  if (report.contains("name")) return text(report["name"]);
  const std::string method = text(report["method"]);
  const bool has_score = report.contains("settings") && report["settings"].contains("score");
  return has_score ? method + ", " + text(report["settings"]["score"]) : method;
}

std::string setting_text(const Json& settings, std::string_view symbol) {
  const auto found = settings.find(std::string(symbol));
  return found == settings.end() ? "" : fmt::format(", {} {}", symbol, text(*found));
}

}  // namespace

Json report_json(const Evaluation& evaluation, const RunInfo& run, const Monitor& monitor) {
  Json json = evaluation.result ? result_report_json(evaluation, run, monitor)
                                : scores_report_json(evaluation.scores, evaluation.query_name,
                                                     evaluation.judgement, evaluation.truth,
                                                     evaluation.fingerprint, run);
  if (evaluation.name) json["name"] = *evaluation.name;
  return json;
}

std::string evaluation_title(const Json& report) {
  return fmt::format("{} on {}", method_title(report), text(report["query"]));
}

std::string title_with_settings(const Json& report) {
  std::string title = evaluation_title(report);
  title += setting_text(report["settings"], score_kind(Score::raw).window_symbol);
  for (const DecisionKind& decision : decision_kinds())
    title += setting_text(report["settings"], decision.symbol);
  for (const std::string_view symbol :
       {probability_kind().window_symbol, probability_kind().threshold_symbol})
    title += setting_text(report["settings"], symbol);
  return title;
}

std::string reference_word(const Json& report) {
  return report.contains("settings") && report["settings"].contains("t_p") ? "training place"
                                                                           : "training frame";
}

std::string score_words(const Json& report) {
  if (!report.contains("counts")) return text(report["outcomes"]["scores_are"]);
  return std::string(score_kind_of(report["settings"]).title);
}

Table view_table(const Json& report) {
  const Json& counts = report["by_view"];
  const Json& hits = counts["hits"];
  const Json& best = counts["best_match"];
  Table table;
  table.title = fmt::format("By view (frames in a row that look alike count once: {} and {})",
                            counted(counts["query_views"].get<uint64_t>(), "query view"),
                            counted(counts["train_views"].get<uint64_t>(), "training view"));
  table.columns = {"view pairs right", "view pairs wrong", "view pairs mixed", "views right",
                   "views wrong",      "views mixed",      "views per cent"};
  table.rows = {
      {hits["correct"].dump(), hits["incorrect"].dump(), hits["mixed"].dump(),
       best["correct"].dump(), best["incorrect"].dump(), best["mixed"].dump(),
       best["rate"].is_null() ? "-" : fmt::format("{:.1f}", 100 * best["rate"].get<double>())}};
  return table;
}

Table report_table(const Json& report) {
  const Json& settings = report["settings"];
  const Json& counts = report["counts"];
  const Json& best = report["best_match"];
  Table table;
  table.title = fmt::format("{} on {} ({})", method_title(report), text(report["query"]),
                            text(report["protocol"]["ground_truth"]));
  std::vector<std::string> row;
  const auto add = [&](const std::string& column, const std::string& value) {
    table.columns.push_back(column);
    row.push_back(value);
  };
  const ScoreKind& score = score_kind_of(settings);
  for (const std::string_view symbol : {score.window_symbol, decided_by(settings)})
    add(std::string(symbol), text(settings[std::string(symbol)]));
  if (settings.contains("t_r_scale"))
    add("scale", settings["t_r"].is_string() ? std::string(enum_name(score.frame_scale))
                                             : text(settings["t_r_scale"]));
  add("hits right", text(counts["hits"]["correct"]));
  add("hits wrong", text(counts["hits"]["incorrect"]));
  if (counts.contains("places")) {
    add("places right", text(counts["places"]["correct"]));
    add("of these mixed", text(counts["mixed_places"]));
    add("places wrong", text(counts["places"]["incorrect"]));
  }
  add("distinct", text(counts["distinct"]));
  add("best right", text(best["correct"]));
  add("of", std::to_string(best["queries"].get<uint64_t>() - best["ignored"].get<uint64_t>()));
  add("per cent",
      best["rate"].is_null() ? "-" : fmt::format("{:.1f}", 100 * best["rate"].get<double>()));
  table.rows = {row};
  return table;
}

std::string recognitions_text(const Json& report) {
  if (!report.contains("recognitions")) return "";
  Table table;
  const bool has_tracks = has_paths(report["settings"].value("method", std::string()));
  table.title =
      fmt::format("Places, judged at their {} (mixed: right there, but some hits are wrong)",
                  has_tracks ? "middle frame" : "mean");
  table.columns = {"sequence", "query frames", "train frames", "place", "hits right", "hits wrong"};
  const Json& places = report["recognitions"];
  for (const Json& place : places) {
    if (table.rows.size() == kMostPlaces) break;
    const Json& hits = place["hits"];
    table.rows.push_back({text(place["sequence"]), range_text(place["query_range"]),
                          range_text(place["train_range"]), verdict_text(place),
                          text(hits["correct"]), text(hits["incorrect"])});
  }
  if (table.rows.empty()) return "";
  return render_table(table, TableFormat::text) +
         (places.size() > kMostPlaces
              ? fmt::format("... and {} more\n", places.size() - kMostPlaces)
              : "");
}

}  // namespace vpr
