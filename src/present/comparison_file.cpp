// The files of comparisons.
#include <optional>
#include <string>
#include <vector>

#include "base/json_schema.h"
#include "evaluate/report_fields.h"
#include "present/comparison_report.h"
#include "present/report_tables.h"

namespace vpr {
namespace {

/// Over the frames with a match.
struct ComparedPath {
  std::optional<double> share;
  std::optional<uint64_t> incorrect, longest_gap_frames;
};
VPR_FIELDS(ComparedPath, (share, "Share of frames recognized correctly."),
           (incorrect, "Frames recognized incorrectly."),
           (longest_gap_frames, "Longest run of frames without a correct recognition."))

struct ComparedReport {
  std::string name, method, ground_truth;
  uint64_t frames = 0;
  bool paired = true;
  ComparedPath localization;
  bool oracle = false;
  Confidence confidence = {};
  std::string fingerprint;
  std::optional<LabelCounts> pairs;
  std::optional<std::string> selection;
  std::string ground_truth_fingerprint;
};

template <class Visitor>
void visit_fields(ComparedReport& report, Visitor&& visit) {
  visit("name", report.name, "Name of the report.");
  visit("method", report.method, "Method of the report.");
  visit("ground_truth", report.ground_truth, "Its protocol, in words.");
  visit("frames", report.frames, "Frames with a match that its numbers are over.");
  visit("paired", report.paired, "Whether its query frames are those of the first report.");
  visit("localization", report.localization, "Over the frames with a match.");
  visit("oracle", report.oracle, "Whether the ground truth chose the threshold of recognitions.");
  visit("confidence", report.confidence, "Acceptance of best matches in AP, R@100P and curves.");
  visit("fingerprint", report.fingerprint, "Checksum of the judged result or matrix.", kIsChecksum);
  visit("pairs", IfSet{report.pairs}, "Accepted pairs of a result, over all of its frames.");
  visit("selection", IfSet{report.selection},
        "Selection of the query (--fps, --speed), in words; absent: all frames.");
  visit("ground_truth_fingerprint", report.ground_truth_fingerprint,
        "Checksum of the labels of all pairs, tolerance applied.", kIsChecksum);
}

struct ComparedFrames {
  size_t compared = 0, with_match = 0, disputed = 0;
  bool only_common = false;
};
VPR_FIELDS(ComparedFrames, (compared, "All frames of the query, or those of --common."),
           (with_match, "Those with a match."),
           (disputed, "Omitted frames that only some ground truths have a match for."),
           (only_common, "Only frames for which every paired report has a judged best match."))

struct BootstrapSettings {
  size_t block = 0, resamples = 0;
  double confidence = 0.95;
};
VPR_FIELDS(BootstrapSettings, (block, "Frames per block."), (resamples, "Number of resamples."),
           (confidence, "Confidence of the intervals."))

struct ComparedMetric {
  std::string metric, report;
  std::optional<double> value, difference, low, high, own_low, own_high;
  bool best = false;
};
VPR_FIELDS(ComparedMetric, (metric, "Key: recall_at_1, average_precision, ..."),
           (report, "Name of the report."), (value, "Over the compared frames."),
           (difference, "To the first report."),
           (low, "Lower end of the 95 % interval of the difference."),
           (high, "Upper end of the 95 % interval of the difference."),
           (own_low, "Lower end of the 95 % interval of the value; null if it is not paired."),
           (own_high, "Upper end of the 95 % interval of the value."),
           (best, "Better than every other paired report: no interval of a difference contains 0."))

struct ComparisonFile {
  std::string query;
  std::vector<ComparedReport> reports;
  GroundTruths ground_truths = GroundTruths::same;
  ComparedFrames frames;
  BootstrapSettings bootstrap;
  std::vector<ComparedMetric> metrics;
  nlohmann::ordered_map<std::string, std::string> protocol;
  Provenance provenance;
};

VPR_FILE(ComparisonFile, "comparison", (query, "Name of the query, of the first report."),
         (reports, "Compared reports; the others are compared with the first."),
         (ground_truths, "Whether the reports have one ground truth."),
         (frames, "Query frames that the comparison is over."),
         (bootstrap, "Computation of intervals."),
         (metrics, "One entry for each metric and report."),
         (protocol, "Definition of the comparison, in words."), (provenance, kProvenanceText))

/// A comparison in a file of several.
struct NamedComparison {
  std::string data_set;
  Json comparison;
};
VPR_FIELDS(NamedComparison, (data_set, "Its name: of --data-set, or of the query."),
           (comparison, "The comparison on it, without machine and timing.", kAs<ComparisonFile>))

struct ComparisonsFile {
  std::vector<NamedComparison> comparisons;
  Provenance provenance;
};
VPR_FILE(ComparisonsFile, "comparisons",
         (comparisons, "One per data set, in the order of their first reports."),
         (provenance, kProvenanceText))

ComparedReport compared_report(const ComparisonReport& comparison, size_t r) {
  const Report& report = comparison.reports[r];
  const auto count = [&](std::string_view key) -> std::optional<uint64_t> {
    const std::optional<double> value = value_of(report, metric_at(key));
    if (!value) return std::nullopt;
    return static_cast<uint64_t>(*value);
  };
  ComparedReport compared{
      report.row_name,
      report.method,
      report.protocol.ground_truth,
      report.counts.best_match.frames,
      comparison.is_paired(r),
      {value_of(report, metric_at("share")), count("incorrect"), count("longest_gap_frames")},
      report.frames.is_oracle,
      report.frames.outcomes.confidence,
      report.provenance.evaluated(),
      {},
      {},
      report.provenance.ground_truth};
  if (report.query_settings() != nullptr) compared.pairs = report.counts.recognitions;
  compared.selection = selection_text(report.selection);
  return compared;
}

}  // namespace

Json comparison_json(const ComparisonReport& comparison) {
  const Comparison& found = comparison.found;
  ComparisonFile file;
  file.query = comparison.query();
  for (size_t r = 0; r < comparison.reports.size(); ++r)
    file.reports.push_back(compared_report(comparison, r));
  file.ground_truths = compare_ground_truths(comparison.reports);
  file.frames = {found.frames.size(), found.with_match, found.disputed,
                 comparison.settings.only_common};
  file.bootstrap = {found.block, comparison.settings.resamples};
  for (const ComparedValue& value : found.values) {
    const auto [low, high] = ends_of(value.interval);
    const auto [own_low, own_high] = ends_of(value.own);
    file.metrics.push_back({value.metric.key(), comparison.reports[value.method].row_name,
                            value.value, value.difference, low, high, own_low, own_high,
                            value.is_best});
  }
  file.protocol = {
      {"frames",
       comparison.settings.only_common
           ? "query frames for which every paired report has a best match that is not ignored"
           : "all query frames except disputed ones; a frame without an answer is not recognized; "
             "a report of another selection is not paired, and is measured over its own"},
      {"localization",
       "share of the frames with a match that are recognized correctly, frames recognized "
       "incorrectly, and most consecutive frames without a correct recognition"},
      {"oracle",
       "recognitions of a report with an oracle threshold are best matches up to a threshold that "
       "was chosen from the ground truth"},
      {"confidence", "the value by which AP, R@100P, max F1 and curves accept best matches"},
      {"disputed", "omitted frames, which have a match in only some of the ground truths"},
      {"metrics",
       "of best matches; an accepted best match of a frame without a match is incorrect"},
      {"interval",
       "central 95 % of the value (own), and of the difference to the first report, under the "
       "circular block bootstrap, the same blocks of neighboring frames for all reports"},
      {"block",
       comparison.settings.block > 0
           ? "set by the user"
           : "from the autocorrelation of correct best matches (Politis and White 2004), the "
             "largest of the paired reports"}};
  file.provenance = comparison.made_by;
  return value_to_json(file, kDataForm);
}

Json comparisons_json(std::span<const ComparisonReport> comparisons) {
  if (comparisons.size() == 1) return comparison_json(comparisons.front());
  ComparisonsFile file{{}, comparisons.front().made_by};
  for (const ComparisonReport& comparison : comparisons)
    file.comparisons.push_back({comparison.data_set, comparison_json(comparison)});
  return value_to_json(file, kDataForm);
}

Json comparison_schema() { return with_run(schema_of<ComparisonFile>()); }

Json comparisons_schema() { return with_run(schema_of<ComparisonsFile>()); }

}  // namespace vpr
