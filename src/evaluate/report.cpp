#include "evaluate/report.h"

#include <algorithm>

#include <fmt/format.h>

#include "truth/ground_truth.h"

namespace vpr {
namespace {

constexpr size_t kMostPoints = 100;  // of a curve in a report

/// Definitions that need no ground truth.
constexpr std::array<std::string_view, 3> kTruthless = {"anchor", "pairs", "localization"};

constexpr const char* kAnchorProtocol = "a window is judged at its last frame";
constexpr const char* kFramesProtocol =
    "all query frames with a match in the ground truth; those without an answer are not recognized";

std::vector<ReportedCluster> places_of(const EvaluatedResult& judged) {
  std::vector<ReportedCluster> places;
  const Result& result = *judged.result;
  const auto anchor = [&](size_t window) { return anchor_of(window, result.window_length()); };
  for (size_t c = 0; c < judged.clusters.size(); ++c) {
    const Cluster& cluster = result.clusters->all[c];
    places.push_back({result.sequences[cluster.sequence].sequence.name,
                      anchor(cluster.query_window),
                      {anchor(cluster.query_first), anchor(cluster.query_last)},
                      anchor(cluster.train_window),
                      {anchor(cluster.train_first), anchor(cluster.train_last)},
                      judged.clusters[c].label,
                      judged.clusters[c].recognitions});
  }
  return places;
}

using Definitions = std::vector<std::pair<std::string, std::string>>;

void define_windows(Definitions& define, const Result& result) {
  const auto& settings = std::get<SequenceQuerySettings>(result.settings);
  const std::string_view measure =
      has_paths(settings.rule) ? "path score" : score_kind(score_of(settings.rule)).measure;
  define.insert(
      define.end(),
      {{"anchor", kAnchorProtocol},
       {"pairs",
        fmt::format(fmt::runtime(decision_kind(decision_of(settings.rule)).recognitions), measure)},
       {"clusters", result.path ? "paths, judged at their middle frame"
                                : "clusters of recognitions, judged at their mean"},
       {"pairs_by_cluster", "recognitions, each with the verdict on its place"},
       {"mixed_clusters", "correct places with incorrect recognitions"},
       {"distinct", "correct places"},
       {"best_match",
        fmt::format("the window with the lowest {}, ties to the first; rate = correct / frames",
                    measure)},
       {"frames", kFramesProtocol}});
}

void define_places(Definitions& define) {
  define.insert(
      define.end(),
      {{"pairs", "pairs of a frame and a place of which a view is above t_p for c_w frames"},
       {"distinct", "places recognized correctly at least once"},
       {"best_match",
        "the place of the likeliest view, the new place omitted, ties to the first; rate = correct "
        "/ frames"},
       {"frames", kFramesProtocol}});
}

void define_scores(Definitions& define, size_t window_length) {
  if (window_length > 1) define.emplace_back("anchor", kAnchorProtocol);
  define.emplace_back(
      "best_match",
      "the reference with the best score, ties to the first; rate = correct / frames");
  define.emplace_back("frames", kFramesProtocol);
}

constexpr const char* kKeyframeProtocol =
    "consecutive frames that look alike are one keyframe; a pair of keyframes with recognitions, "
    "and a query keyframe with a match, counts once: correct or incorrect if all of its frames "
    "are, else mixed; a frame without an answer is not correct; rate = mean over query keyframes "
    "of the share of correct frames; recall_at_100_precision = of query keyframes, each with its "
    "most confident best match, which is correct if any frame of its training keyframe is";

void define_metrics(Definitions& define, const Judgment& judgment, bool is_result,
                    bool skips_ignored) {
  const bool has_ranks = judgment.outcomes.has_ranks;
  define.emplace_back(
      "single_best",
      fmt::format("a {}; recall is over frames with a match; the best match of a frame without one "
                  "is incorrect; {}",
                  judgment.outcomes.confidence == Confidence::margin
                      ? "margin accepts best matches that have at least this margin"
                      : "threshold accepts best matches that score at least as well",
                  skips_ignored ? "references labeled ignore are skipped"
                                : "a best match labeled ignore is not accepted"));
  if (judgment.outcomes.has_margins)
    define.emplace_back(
        "margin",
        "difference between the best match and the runner-up, in score per frame; a best match "
        "without a runner-up is never accepted by its margin");
  if (judgment.all_pairs)
    define.emplace_back(
        "all_pairs",
        "a threshold accepts pairs that score at least as well; recall is over all pairs of the "
        "same place, also without a score; pairs labeled ignore are omitted");
  if (has_ranks)
    define.emplace_back(
        "precision_at",
        "correct references among the K best, divided by K; mAP@K: mean over queries of the sum of "
        "the precision at each correct one among the K best, divided by the smaller of K and the "
        "number of correct ones");
  define.emplace_back(
      "recall_achievement",
      "the path is cut into stretches of about stretch_frames frames; share of the stretches with "
      "a match in the ground truth whose recall@1 reaches the target");
  define.emplace_back(
      "ties", "equal scores are accepted together; the best match and ranks take the first");
  define.emplace_back(
      "localization",
      is_result
          ? "a frame is recognized by its closest recognition"
          : fmt::format("a frame is recognized by its best match if it scores at least as well as "
                        "{}{}",
                        judgment.threshold ? fmt::format("{:.6g}", *judgment.threshold)
                                           : "any correct one before the first mistake",
                        judgment.is_oracle ? ", a threshold chosen from the ground truth" : ""));
}

template <class T>
ByAcceptance<T> by_acceptance(const Judgment& judgment, T (*function)(const Curve&)) {
  ByAcceptance<T> all{function(judgment.single_best), {}, {}, {}};
  const bool is_by_score = judgment.outcomes.confidence == Confidence::score;
  if (judgment.other_best)
    (is_by_score ? all.by_margin : all.by_score) = function(*judgment.other_best);
  if (judgment.all_pairs) all.all_pairs = function(judgment.all_pairs->curve);
  return all;
}

ReportedMetrics metrics_of(const Judgment& judgment) {
  const Outcomes& outcomes = judgment.outcomes;
  ReportedMetrics found;
  found.curves = by_acceptance(judgment, numbers_of);
  if (outcomes.has_ranks)
    found.curves.single_best.tied_queries =
        std::ranges::count(outcomes.queries, true, &QueryOutcome::is_tied);
  if (judgment.all_pairs) {
    found.curves.all_pairs->same_without_score = judgment.all_pairs->same_without_score;
    found.curves.all_pairs->ignored = judgment.all_pairs->ignored;
  }
  for (size_t m = 0; m < found.ranks.size(); ++m)
    for (const size_t k : judgment.recall_at)
      if (outcomes.has_ranks || rank_metrics()[m].is_known_at(outcomes, k))
        found.ranks[m][k] = rank_value({&rank_metrics()[m], k}, outcomes);
  const auto recalls = local_recalls(outcomes, judgment.stretch_frames);
  ReportedAchievement& achievement = found.recall_achievement;
  achievement.stretch_frames = judgment.stretch_frames;
  achievement.stretches = static_cast<size_t>(
      std::ranges::count_if(recalls, [](const auto& recall) { return recall.has_value(); }));
  for (const double target : kRecallTargets)
    achievement.reached[fmt::format("{:g}", target)] = recall_achievement(recalls, target);
  return found;
}

/// The parts that scores do not have.
void add_result(Report& report, const EvaluatedResult& judged) {
  const Result& result = *judged.result;
  report.method = method_of(result.settings);
  report.selection = result.query.selection;
  report.settings = result.settings;
  report.counts = judged.counts;
  report.by_keyframe = judged.by_keyframe;
  if (result.clusters) report.recognitions = places_of(judged);
  Definitions& define = report.protocol.definitions;
  if (result.places)
    define_places(define);
  else
    define_windows(define, result);
  if (judged.by_keyframe) define.emplace_back("by_keyframe", kKeyframeProtocol);
}

}  // namespace

std::string Protocol::definition(const std::string& key) const {
  for (const auto& [name, words] : definitions)
    if (name == key) return words;
  return "";
}

bool Report::has_paths() const {
  return query_settings() != nullptr && vpr::has_paths(*query_settings());
}

bool Report::has_places() const {
  const QuerySettings* of_query = query_settings();
  return of_query != nullptr && std::holds_alternative<FabmapQuerySettings>(*of_query);
}

Report report_of(const Evaluation& evaluation, const RunInfo& run, const Monitor& monitor) {
  const Judgment& judgment = evaluation.judgment;
  const GroundTruth& truth = evaluation.truth;
  Report report;
  report.frames = judgment;
  report.query = evaluation.query().name;
  report.name = evaluation.name;
  report.data_set = evaluation.data_set;
  report.caution = evaluation.caution;
  report.protocol = {
      truth.protocol, truth.applied_tolerance_frames.value_or(truth.tolerance_frames), {}};
  report.provenance.made_by = provenance_of(run);
  report.provenance.ground_truth = ground_truth_fingerprint(truth, judgment.layout.scope, monitor);
  if (evaluation.result) {
    add_result(report, *evaluation.result);
    report.provenance.result = evaluation.fingerprint;
  } else {
    report.method = evaluation.scores.method;
    report.selection = evaluation.scores.query.selection;
    report.settings = evaluation.scores;
    report.counts.best_match = best_match_counts(judgment.outcomes);
    define_scores(report.protocol.definitions, evaluation.scores.window_length);
    report.provenance.scores = evaluation.fingerprint;
  }
  define_metrics(report.protocol.definitions, judgment, evaluation.result.has_value(),
                 !evaluation.result && truth.asked.empty());
  if (!truth.asked.empty())
    report.protocol.definitions.emplace_back(
        "labels",
        fmt::format("frames are those that are labeled{}, and \"with a match\" means this; a pair "
                    "that is not labeled is neither correct nor incorrect, and counts for ranks",
                    truth.is_sample ? ", a sample spread along the query" : ""));
  if (judgment.by != JudgedBy::ground_truth) {
    Definitions& define = report.protocol.definitions;
    std::erase_if(define, [](const auto& definition) {
      return std::ranges::find(kTruthless, definition.first) == kTruthless.end();
    });
    if (judgment.by == JudgedBy::places)
      define.emplace_back("clusters",
                          "clusters or paths of recognitions, judged with all of their "
                          "recognitions by a person who "
                          "compared images; ignored without an answer");
  }
  report.estimate = estimated_recall(evaluation);
  report.metrics = metrics_of(judgment);
  report.curves = by_acceptance(judgment, reported_curve);
  return report;
}

std::optional<double> value_of(const Report& report, const MetricAt& metric) {
  const Metric& row = *metric.metric;
  if (row.of_path) return value_in(report.frames.localization, *row.of_path);
  if (row.of_best_match) return value_in(report.counts.best_match, *row.of_best_match);
  if (row.of_counts) return value_in(report.counts, *row.of_counts, metric.verdict);
  const auto index = [&](std::span<const Metric> all) {
    return static_cast<size_t>(&row - all.data());
  };
  if (row.of_curve != nullptr)
    return report.metrics.curves.single_best.values[index(curve_metrics())].value;
  const RankValues& ranks = report.metrics.ranks[index(rank_metrics())];
  const auto found = ranks.find(metric.k);
  return found == ranks.end() ? std::nullopt : found->second;
}

CurveNumbers numbers_of(const Curve& curve) {
  CurveNumbers numbers;
  numbers.positives = curve.positives;
  for (size_t m = 0; m < numbers.values.size(); ++m)
    numbers.values[m] = curve_metrics()[m].of_curve(curve);
  return numbers;
}

ReportedCurve reported_curve(const Curve& curve) {
  ReportedCurve found{curve.points.size(), {}};
  for (const CurvePoint& point : thinned(curve, kMostPoints))
    found.points.push_back({curve.threshold(point), point.correct, point.incorrect});
  return found;
}

std::vector<CurvePoint> thinned(const Curve& curve, size_t most) {
  const size_t count = curve.points.size();
  if (count <= most) return curve.points;
  std::vector<CurvePoint> points;
  for (size_t i = 0; i < most; ++i) points.push_back(curve.points[i * (count - 1) / (most - 1)]);
  return points;
}

std::string_view verdict_text(const JudgedCluster& judged) {
  if (judged.label == PlaceLabel::different) return "incorrect";
  if (judged.label == PlaceLabel::ignore) return "ignored";
  return judged.is_mixed() ? "mixed" : "correct";
}

}  // namespace vpr
