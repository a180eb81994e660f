// Evaluation reports: one (vpr.report/1), those of several results (vpr.reports/1), and those of
// one result under several protocols (vpr.protocols/1).
#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "base/json_fwd.h"
#include "present/run_info.h"
#include "run/evaluate.h"
#include "truth/presets.h"

namespace vpr {

/// The query of scores of which nobody says what the query is.
inline constexpr const char* kUnnamedQuery = "queries";

/// A place of a result, in frames: the anchors of its windows.
struct ReportedPlace {
  std::string sequence;
  size_t query = 0;
  std::array<size_t, 2> query_range = {};  ///< first and last
  size_t train = 0;
  std::array<size_t, 2> train_range = {};
  JudgedCluster judged;
};

/// The metrics of a precision-recall curve.
struct CurveNumbers {
  uint64_t to_find = 0;
  /// One for each of curve_metrics().
  std::vector<MetricValue> values = std::vector<MetricValue>(curve_metrics().size());
  std::optional<uint64_t> tied_queries;        ///< of best matches in a matrix
  std::optional<uint64_t> same_without_score;  ///< of all pairs
  std::optional<uint64_t> ignored;             ///< of all pairs
};

struct ReportedPoint {
  double threshold = 0;
  uint64_t correct = 0;
  uint64_t incorrect = 0;
};

/// At most 100 points of a curve.
struct ReportedCurve {
  size_t thresholds = 0;  ///< points of the whole curve
  std::vector<ReportedPoint> points;
};

/// Values of one kind for each way to accept matches.
template <class T>
struct ByAcceptance {
  T single_best;               ///< best matches, by the confidence in force
  std::optional<T> by_margin;  ///< by the other confidence, where margins are known
  std::optional<T> by_score;
  std::optional<T> all_pairs;  ///< of a matrix
};

/// A metric by K.
using RankValues = std::map<size_t, std::optional<double>>;

struct ReportedAchievement {
  size_t stretch_frames = 0;
  size_t stretches = 0;  ///< with a query to find
  std::array<std::optional<double>, kRecallTargets.size()> shares = {};
};

struct ReportedMetrics {
  ByAcceptance<CurveNumbers> curves;
  RankValues recall_at;
  std::optional<RankValues> precision_at;  ///< where ranks are known
  std::optional<RankValues> map_at;
  ReportedAchievement recall_achievement;
};

/// What is counted, in words.
struct Protocol {
  std::string ground_truth;
  int64_t tolerance_frames = 0;
  std::vector<std::pair<std::string, std::string>> definitions;  ///< of keys of the report

  /// The definition of a key; empty where there is none.
  std::string definition(const std::string& key) const;
};

/// Fingerprints of what a report is of.
struct ReportSources {
  Provenance made_by;
  std::optional<std::string> result;  ///< either this
  std::optional<std::string> scores;  ///< or that
  std::string ground_truth;           ///< of the labels of all pairs

  const std::string& evaluated() const { return result ? *result : *scores; }
};

/// An evaluation as a file holds it.
struct Report {
  std::string method;
  std::string query;
  Selection selection;  ///< of the query, without the frames if it was read
  std::variant<QuerySettings, ScoreSettings> settings;  ///< of a result, or of scores alone
  Counts counts;                                        ///< of scores alone: best matches only
  std::optional<CountsByView> by_view;
  std::optional<std::vector<ReportedPlace>> recognitions;
  ReportedMetrics metrics;
  Localization localization;
  bool is_oracle = false;  ///< fixes are by a threshold from the ground truth
  ByAcceptance<ReportedCurve> curves;
  Outcomes outcomes;  ///< if it was read: without the references of best matches
  std::vector<Fix> fixes;
  Protocol protocol;
  ReportSources provenance;
  std::optional<std::string> name;  ///< that the user gave

  /// The settings of a result; null for scores alone.
  const QuerySettings* query_settings() const { return std::get_if<QuerySettings>(&settings); }
  /// The settings as the file has them.
  Json settings_json() const;
  /// Whether references are places of FAB-MAP, and not frames.
  bool has_places() const;
  /// "5 frames a second, replayed: varying, seed 1"; empty for a query as it was recorded.
  std::string walk() const;
};

Report report_of(const Evaluation& evaluation, const RunInfo& run, const Monitor& monitor = {});

/// The file without "machine" and "timing".
Json report_json(const Report& report);
/// The same with them.
Json report_json(const Report& report, const RunInfo& run, double seconds);

/// Reads a report. Throws Error(input) if the file can't be read, Error(usage) for a result,
/// Error(data) if it is something else, or damaged.
Report read_report(const std::filesystem::path& path);
/// The same of a report that was parsed; `where` is what messages call it.
Report parse_report(const Json& json, const std::string& where);

/// A letter per query: c(orrect), w(rong), n(o match), b(eyond reach), i(gnored), u(nreadable).
std::string outcome_letters(const Outcomes& outcomes);

CurveNumbers numbers_of(const Curve& curve);
Json curve_numbers_json(const CurveNumbers& numbers);
ReportedCurve reported_curve(const Curve& curve);
Json curve_json(const ReportedCurve& curve);

/// At most `most` points, evenly spaced by their place, first and last among them.
std::vector<CurvePoint> thinned(const Curve& curve, size_t most);

/// "counts" of a report, or of a cell of a sweep.
Json counts_json(const Counts& counts);

/// `names`: one for each.
Json reports_json(std::span<const Report> reports, const std::vector<std::string>& names,
                  const RunInfo& run, double seconds);

/// One result as one of the presets judges it.
struct ProtocolReport {
  const GroundTruthPreset* preset = nullptr;
  Report report;
};

Json protocols_json(const std::vector<ProtocolReport>& reports, const RunInfo& run, double seconds);

}  // namespace vpr
