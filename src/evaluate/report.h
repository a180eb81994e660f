// Evaluation reports: the numbers of one evaluated result, or of evaluated scores. As JSON: of one
// result (vpr.report/5), and of several results (vpr.reports/5).
#pragma once

#include <array>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "base/json_fwd.h"
#include "evaluate/evaluation.h"
#include "query/run_info.h"

namespace vpr {

/// The query of scores without --query.
inline constexpr const char* kUnnamedQuery = "queries";

/// A cluster of recognitions. All frames are anchors.
struct ReportedCluster {
  std::string sequence;
  size_t query = 0;
  std::array<size_t, 2> query_range = {};  ///< first, last
  size_t train = 0;
  std::array<size_t, 2> train_range = {};
  PlaceLabel label = PlaceLabel::different;
  LabelCounts recognitions;
};

struct CurveNumbers {
  uint64_t positives = 0;
  /// One per entry of curve_metrics().
  std::vector<MetricValue> values = std::vector<MetricValue>(curve_metrics().size());
  std::optional<uint64_t> tied_queries;        ///< best matches of a matrix only
  std::optional<uint64_t> same_without_score;  ///< all pairs only
  std::optional<uint64_t> ignored;             ///< all pairs only
};

struct ReportedPoint {
  double threshold = 0;
  uint64_t correct = 0;
  uint64_t incorrect = 0;
};

/// At most 100 points of a curve.
struct ReportedCurve {
  size_t thresholds = 0;  ///< number of points of the whole curve
  std::vector<ReportedPoint> points;
};

/// A value for each way to accept matches.
template <class T>
struct ByAcceptance {
  T single_best;               ///< best matches by the outcomes' confidence
  std::optional<T> by_margin;  ///< best matches by the other confidence, if margins are known
  std::optional<T> by_score;
  std::optional<T> all_pairs;  ///< with a matrix only
};

using RankValues = std::map<size_t, std::optional<double>>;

struct ReportedAchievement {
  size_t stretch_frames = 0;
  size_t stretches = 0;                                  ///< with a query that has a match
  std::map<std::string, std::optional<double>> reached;  ///< shares by target
};

struct ReportedMetrics {
  ByAcceptance<CurveNumbers> curves;
  /// One per entry of rank_metrics(). Those that need all ranks are empty if ranks are unknown.
  std::vector<RankValues> ranks = std::vector<RankValues>(rank_metrics().size());
  ReportedAchievement recall_achievement;
};

/// Definitions of the metrics, in words.
struct Protocol {
  std::string ground_truth;
  int64_t tolerance_frames = 0;
  std::vector<std::pair<std::string, std::string>> definitions;  ///< key of the report, definition

  /// Empty for a key without definition.
  std::string definition(const std::string& key) const;
};

struct ReportSources {
  Provenance made_by;
  std::optional<std::string> result;  ///< or scores
  std::optional<std::string> scores;
  std::string ground_truth;  ///< of the labels of all pairs

  const std::string& evaluated() const { return result ? *result : *scores; }
};

struct Report {
  JudgedFrames frames;  ///< without the references of best matches if it was read from a file
  std::string method;
  std::string query;
  Selection selection;  ///< of the query; without sources if it was read from a file
  std::variant<QuerySettings, ScoreSettings> settings;  ///< of a result, or of scores
  Counts counts;                                        ///< for scores, best matches only
  std::optional<CountsByKeyframe> by_keyframe;
  std::optional<std::vector<ReportedCluster>> recognitions;
  std::optional<Estimate> estimate;  ///< of correct best matches, by labels of a sample
  ReportedMetrics metrics;
  ByAcceptance<ReportedCurve> curves;
  Protocol protocol;
  ReportSources provenance;
  std::optional<std::string> name;      ///< set by the user
  std::optional<std::string> data_set;  ///< likewise
  std::string row_name;                 ///< in tables of several reports; not in the file
  std::string caution;                  ///< of the evaluation; not in the file

  /// Null for scores.
  const QuerySettings* query_settings() const { return std::get_if<QuerySettings>(&settings); }
  /// Whether recognitions are along paths of the filter.
  bool has_paths() const;
  /// Whether the ground truth is labels of single pairs.
  bool has_labels() const { return !protocol.definition("labels").empty(); }
  /// Frames that are labeled, but not with their best match.
  uint64_t unlabeled() const { return has_labels() ? counts.best_match.ignored : 0; }
  /// "with a match" or "that are labeled".
  std::string_view frames_that_count() const {
    return has_labels() ? "that are labeled" : "with a match";
  }
  /// Whether references are places of FAB-MAP instead of frames.
  bool has_places() const;
};

Report report_of(const Evaluation& evaluation, const RunInfo& run, const Monitor& monitor = {});

/// A count, or a metric of best matches, by their confidence, or of the path: over all query frames
/// that have a match, which is the same for all methods on a query.
std::optional<double> value_of(const Report& report, const MetricAt& metric);

CurveNumbers numbers_of(const Curve& curve);
ReportedCurve reported_curve(const Curve& curve);

/// At most `most` points with evenly spaced indices, including the first and the last.
std::vector<CurvePoint> thinned(const Curve& curve, size_t most);

/// correct, mixed, incorrect or ignored.
std::string_view verdict_text(const JudgedCluster& judged);

/// The file without "machine" and "timing". Numbers that need a ground truth, or any verdict, are
/// absent without one.
Json report_json(const Report& report);
Json report_json(const Report& report, const RunInfo& run, double seconds);

/// Throws Error(usage) for a report without ground truth, and Error(data) for any other file and
/// for damage. `where`: the name of the file in messages.
Report parse_report(const Json& json, const std::string& where);

/// A letter per query frame: c(orrect), w(rong), i(gnored), u(nanswered); W, I and U for frames
/// without a match in the ground truth.
std::string outcome_letters(const Outcomes& outcomes);

/// Several reports in one file, and the schemas of one and of several.
Json reports_json(std::span<const Report> reports, const RunInfo& run, double seconds);
Json report_schema();
Json reports_schema();

}  // namespace vpr
