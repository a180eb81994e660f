#include "present/evaluation_report.h"

#include <fmt/format.h>

#include "base/json.h"
#include "match/match.h"
#include "present/json_fields.h"
#include "present/metrics_report.h"
#include "truth/check.h"

namespace vpr {
namespace {

constexpr const char* kAnchorProtocol = "a window is judged at its last frame";
constexpr const char* kUnreachableProtocol =
    "neither is one whose anchor has matches only where no training window ends";

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
  protocol["anchor"] = kAnchorProtocol;
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
  protocol["unreachable"] = kUnreachableProtocol;
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

Json settings_json(const ScoreSettings& settings) {
  return {{"method", settings.method},
          {"scores", settings.format.is_similarity ? "similarity" : "distance"},
          {"references_first", settings.format.references_first},
          {"missing", or_null(settings.format.missing)},
          {"window", settings.window_length},
          {"threshold", or_null(settings.threshold)}};
}

Json protocol_json(const GroundTruth& truth) {
  return {{"ground_truth", truth.protocol}, {"tolerance_frames", truth.tolerance_frames}};
}

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

void add_run(Json& json, const RunInfo& run, double seconds) {
  json["machine"] = machine_json(run);
  json["timing"] = timing_json({{"evaluate", seconds}});
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

Json scores_report_json(const ScoreSettings& settings, const std::string& query,
                        const Judgement& judgement, const GroundTruth& truth,
                        const std::string& fingerprint, const RunInfo& run) {
  Json json = {{"schema", "vpr.report/1"}, {"method", settings.method}};
  json["query"] = query;
  if (settings.replay) add_replay(json, *settings.replay);
  json["settings"] = settings_json(settings);
  json["best_match"] = best_match_json(best_match_counts(judgement.outcomes));
  add_judgement(json, judgement);
  json["protocol"] = protocol_json(truth);
  if (settings.window_length > 1) json["protocol"]["anchor"] = kAnchorProtocol;
  json["protocol"]["best_match"] =
      "the reference with the best score, ties to the first; rate = correct / (queries - ignored)";
  json["protocol"]["without_match"] =
      "a query without a match in the ground truth is not among the queries of rate and recall";
  if (settings.window_length > 1) json["protocol"]["unreachable"] = kUnreachableProtocol;
  json["protocol"]["unreadable"] = "a query without any score";
  add_metrics_protocol(json["protocol"], judgement, false);
  json["provenance"] = provenance_json(run);
  json["provenance"]["scores"] = fingerprint;
  json["provenance"]["ground_truth"] = ground_truth_fingerprint(truth, judgement.layout.scope);
  return json;
}

Json report_json(const Evaluation& evaluation, const RunInfo& run, const Monitor& monitor) {
  Json json = evaluation.result ? result_report_json(evaluation, run, monitor)
                                : scores_report_json(evaluation.scores, evaluation.query_name,
                                                     evaluation.judgement, evaluation.truth,
                                                     evaluation.fingerprint, run);
  if (evaluation.name) json["name"] = *evaluation.name;
  return json;
}

Json reports_json(const std::vector<Json>& reports, const std::vector<std::string>& names,
                  const RunInfo& run, double seconds) {
  Json json = {{"schema", "vpr.reports/1"}, {"reports", Json::array()}};
  for (size_t i = 0; i < reports.size(); ++i)
    json["reports"].push_back({{"name", names[i]}, {"report", reports[i]}});
  add_run(json, run, seconds);
  return json;
}

Json protocols_json(const std::vector<ProtocolReport>& reports, const RunInfo& run,
                    double seconds) {
  Json json = {{"schema", "vpr.protocols/1"}, {"protocols", Json::array()}};
  for (const auto& [preset, report] : reports)
    json["protocols"].push_back(
        {{"name", preset->name}, {"source", preset->source}, {"report", report}});
  add_run(json, run, seconds);
  return json;
}

}  // namespace vpr
