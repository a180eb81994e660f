#include "present/comparison_report.h"

#include <algorithm>
#include <array>
#include <map>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/json_schema.h"
#include "base/text.h"
#include "evaluate/report_fields.h"
#include "present/evaluation_text.h"
#include "present/report_tables.h"
#include "present/summary.h"

namespace vpr {
namespace {

namespace fs = std::filesystem;

// The protocol of the recording's ground truth, without the selection of the query.
std::string recording_protocol(const Report& report) {
  std::string protocol = report.protocol.ground_truth;
  const std::string selection = ", query " + selection_text(report.selection);
  const size_t at = protocol.rfind(selection);
  if (!report.selection_words().empty() && at != std::string::npos)
    protocol.erase(at, selection.size());
  return protocol;
}

using Value = std::optional<double>;

// "filter" of filter.report.json.
std::string method_name(const fs::path& path) {
  fs::path stem = path.stem();
  return (stem.extension() == ".report" ? stem.stem() : stem).string();
}

// Unset without an interval.
std::array<Value, 2> ends_of(const std::optional<Interval>& interval) {
  if (!interval) return {};
  return {interval->low, interval->high};
}

// Empty if the interval contains 0, and if best matches of the reports are not judged.
std::string verdict_of(const ComparisonReport& comparison, const ComparedValue& value) {
  if (!value.interval || lack_labels(comparison.reports)) return "";
  const bool is_higher = value.interval->low > 0;
  if (!is_higher && value.interval->high >= 0) return "";
  return is_higher != value.metric.metric->is_low_good ? "better" : "worse";
}

// The report over these frames of the query alone, without the numbers that need all of them.
void restrict_to(Report& report, const std::vector<size_t>& frames) {
  std::vector<QueryOutcome>& queries = report.frames.outcomes.queries;
  std::vector<Verdict> verdicts;
  uint64_t off_map = 0;
  for (size_t frame = 0; frame < queries.size(); ++frame) {
    if (std::ranges::binary_search(frames, frame)) {
      verdicts.push_back(report.frames.verdicts[frame]);
      off_map += !queries[frame].has_match && verdicts.back() == Verdict::incorrect;
      continue;
    }
    queries[frame] = QueryOutcome{};
    queries[frame].frame = frame;
    report.frames.verdicts[frame] = Verdict::none;
  }
  report.counts.best_match = best_match_counts(report.frames.outcomes);
  report.frames.localization = localize(verdicts, {});
  report.frames.localization.frames_with_match = report.counts.best_match.frames;
  report.frames.localization.off_map = off_map;
  report.frames.localization.first_recognition_frames.reset();
  report.metrics.curves = {numbers_of(single_best_curve(report.frames.outcomes)), {}, {}, {}};
  report.metrics.recall_achievement = {};
  for (size_t m = 0; m < report.metrics.ranks.size(); ++m)
    for (auto& [k, value] : report.metrics.ranks[m])
      value = rank_metrics()[m].needs_all_ranks
                  ? std::nullopt
                  : rank_value({&rank_metrics()[m], k}, report.frames.outcomes);
}

// Whether the reports are on one query of one data set.
bool have_same_data(const Report& a, const Report& b) {
  if (a.data_set && b.data_set && *a.data_set != *b.data_set) return false;
  return a.query == b.query || a.query == kUnnamedQuery || b.query == kUnnamedQuery ||
         a.provenance.ground_truth == b.provenance.ground_truth;
}

// Names the rows by the user or after the file, with a number if a name occurs twice.
void name_rows(ComparisonReport& comparison) {
  std::vector<std::string> names;
  for (size_t r = 0; r < comparison.reports.size(); ++r)
    names.push_back(comparison.reports[r].name.value_or(method_name(comparison.paths[r])));
  names = numbered_names(names);
  for (size_t r = 0; r < names.size(); ++r) comparison.reports[r].row_name = names[r];
}

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
  Value value, difference, low, high, own_low, own_high;
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
    const Value value = value_of(report, metric_at(key));
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
  if (!report.selection_words().empty()) compared.selection = report.selection_words();
  return compared;
}

// A row per paired method after the first: its differences in the main metrics, with intervals.
Table difference_table(const ComparisonReport& comparison) {
  Table table;
  table.title =
      fmt::format("Differences to {} over {}, with 95 % intervals by blocks of {}",
                  comparison.reports.front().row_name, comparison.frames(), comparison.found.block);
  table.columns = {"method"};
  std::map<size_t, size_t> rows;  // by method
  for (size_t r = 1; r < comparison.reports.size(); ++r) {
    if (!comparison.is_paired(r)) continue;
    rows[r] = table.rows.size();
    table.rows.push_back({comparison.reports[r].row_name});
  }
  for (const ComparedValue& value : comparison.found.values) {
    if (value.metric.metric->detail == TableDetail::data || value.metric.k > 1) continue;
    if (value.method == 0) {
      table.columns.push_back(value.metric.symbol());
      for (auto& row : table.rows) row.emplace_back("-");
    } else if (value.difference && rows.contains(value.method)) {
      std::string& cell = table.rows[rows[value.method]].back();
      cell = fmt::format("{:+.4f}", *value.difference);
      if (value.interval)
        cell += fmt::format(" ({:+.4f} to {:+.4f})", value.interval->low, value.interval->high);
    }
  }
  return table;
}

}  // namespace

GroundTruths compare_ground_truths(std::span<const Report> reports) {
  std::map<bool, std::string> of_kind;  // places or frames
  for (const Report& report : reports) {
    if (report.selection_words() != reports.front().selection_words()) {
      // Fingerprints of different selections always differ.
      if (recording_protocol(report) != recording_protocol(reports.front()))
        return GroundTruths::different;
      continue;
    }
    const std::string& fingerprint = report.provenance.ground_truth;
    if (of_kind.emplace(report.has_places(), fingerprint).first->second != fingerprint)
      return GroundTruths::different;
  }
  const bool agree = of_kind.size() < 2 || of_kind[true] == of_kind[false];
  return agree ? GroundTruths::same : GroundTruths::of_places_and_frames;
}

std::vector<ComparisonReport> by_data_set(std::vector<Report> reports,
                                          const std::vector<std::string>& paths) {
  std::vector<ComparisonReport> sets;
  for (size_t r = 0; r < reports.size(); ++r) {
    auto set = std::ranges::find_if(sets, [&](const ComparisonReport& one) {
      return have_same_data(one.reports.front(), reports[r]);
    });
    if (set == sets.end()) set = sets.emplace(sets.end());
    set->reports.push_back(std::move(reports[r]));
    set->paths.push_back(paths[r]);
  }
  std::vector<std::string> names;
  for (ComparisonReport& set : sets) {
    names.push_back(set.reports.front().data_set.value_or(set.query()));
    name_rows(set);
  }
  names = numbered_names(names);
  for (size_t s = 0; s < sets.size(); ++s) sets[s].data_set = names[s];
  return sets;
}

std::string ComparisonReport::query() const {
  const auto named = std::ranges::find_if(
      reports, [](const Report& report) { return report.query != kUnnamedQuery; });
  return named == reports.end() ? kUnnamedQuery : named->query;
}

std::string ComparisonReport::frames() const {
  return fmt::format("{} {}",
                     counted(found.with_match, settings.only_common ? "common frame" : "frame"),
                     reports.front().frames_that_count());
}

void compare_reports(ComparisonReport& comparison, const Monitor& monitor) {
  // Reports have the first correct rank of each query, so that any K is known.
  for (Report& report : comparison.reports)
    for (const size_t k : comparison.settings.recall_at)
      for (size_t m = 0; m < rank_metrics().size(); ++m)
        if (const Outcomes& outcomes = report.frames.outcomes;
            !rank_metrics()[m].needs_all_ranks &&
            (k == 1 || (outcomes.has_ranks && rank_metrics()[m].is_known_at(outcomes, k))))
          report.metrics.ranks[m][k] = rank_value({&rank_metrics()[m], k}, outcomes);
  if (compare_ground_truths(comparison.reports) == GroundTruths::of_places_and_frames)
    comparison.settings.omit_disputed = true;
  std::vector<NamedOutcomes> methods;
  for (size_t r = 0; r < comparison.reports.size(); ++r)
    methods.push_back({comparison.reports[r].row_name, comparison.reports[r].frames.outcomes,
                       comparison.is_paired(r)});
  comparison.found = compare_outcomes(methods, comparison.settings, monitor);
  comparison.omits_frames =
      comparison.found.frames.size() < comparison.reports.front().frames.outcomes.queries.size();
  for (size_t r = 0; r < comparison.reports.size(); ++r)
    if (comparison.omits_frames && comparison.is_paired(r))
      restrict_to(comparison.reports[r], comparison.found.frames);
}

Json comparison_json(const ComparisonReport& comparison) {
  const Comparison& found = comparison.found;
  ComparisonFile file;
  file.query = comparison.query();
  for (size_t r = 0; r < comparison.reports.size(); ++r)
    file.reports.push_back(compared_report(comparison, r));
  file.ground_truths = compare_ground_truths(comparison.reports);
  file.frames = {found.frames.size(), found.with_match, found.disputed,
                 comparison.settings.only_common};
  file.bootstrap = {found.block, comparison.settings.resamples, 0.95};
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

SideBySide side_by_side(const ComparisonReport& comparison) {
  const std::vector<Report>& reports = comparison.reports;
  const bool differ = compare_ground_truths(reports) != GroundTruths::same;
  SideBySide methods{.reports = reports,
                     .query = comparison.data_set,
                     .frames = comparison.frames(),
                     .is_comparable = {},
                     .notes = {},
                     .omits_frames = comparison.omits_frames,
                     .recall_at = comparison.settings.recall_at,
                     .compared = comparison.found.values};
  for (size_t r = 0; r < reports.size(); ++r) {
    methods.is_comparable.push_back(comparison.is_paired(r));
    methods.notes.push_back(note_of(reports[r], comparison.is_paired(r), differ));
  }
  return methods;
}

Table compared_methods(std::span<const ComparisonReport> comparisons, TableDetail detail,
                       bool has_intervals) {
  std::vector<std::pair<std::string, Table>> tables;
  if (comparisons.size() > 1 && detail == TableDetail::full) detail = TableDetail::brief;
  for (const ComparisonReport& comparison : comparisons) {
    SideBySide methods = side_by_side(comparison);
    methods.has_intervals = has_intervals;
    tables.emplace_back(comparison.data_set, methods_table(methods, detail));
    if (has_intervals)
      tables.back().second.title += fmt::format("; in brackets 95 % intervals, by blocks of {}",
                                                counted(comparison.found.block, "frame"));
  }
  return tables.size() == 1 ? tables.front().second : joined_tables(tables);
}

std::string comparison_text(std::span<const ComparisonReport> comparisons) {
  std::string text = short_text(compared_methods(comparisons, TableDetail::brief, false));
  for (const ComparisonReport& comparison : comparisons) {
    const std::string set = comparisons.size() == 1 ? "" : comparison.data_set + ": ";
    std::vector<std::string> own;
    std::string differences;
    for (const ComparedValue& value : comparison.found.values) {
      if (value.metric != metric_at("recall_at", 1)) continue;
      const std::string& name = comparison.reports[value.method].row_name;
      if (value.own)
        own.push_back(fmt::format("{} {:.4f} to {:.4f}", name, value.own->low, value.own->high));
      if (!value.interval) continue;
      const std::string verdict = verdict_of(comparison, value);
      differences += wrapped_text(
          fmt::format("{}{} - {}: R@1 {:+.4f} (95 %: {:+.4f} to {:+.4f}){}", set, name,
                      comparison.reports.front().row_name, *value.difference, value.interval->low,
                      value.interval->high, verdict.empty() ? "" : ", " + verdict),
          2);
    }
    if (!own.empty())
      text +=
          wrapped_text(fmt::format("{}R@1, 95 %, by blocks of {}: {}", set,
                                   counted(comparison.found.block, "frame"), fmt::join(own, ", ")),
                       2);
    text += differences;
  }
  return text;
}

std::vector<Table> difference_tables(std::span<const ComparisonReport> comparisons) {
  std::vector<Table> tables;
  for (const ComparisonReport& comparison : comparisons) {
    Table table = difference_table(comparison);
    if (comparisons.size() > 1) table.title = comparison.data_set + ": " + table.title;
    if (!table.rows.empty()) tables.push_back(std::move(table));
  }
  return tables;
}

std::string comparison_tables(std::span<const ComparisonReport> comparisons, TableFormat format) {
  if (format != TableFormat::csv) {
    std::string text = render_table(compared_methods(comparisons, detail_of(format), true), format);
    for (const Table& differences : difference_tables(comparisons))
      text += "\n" + render_table(differences, format);
    return text;
  }
  std::vector<std::pair<std::string, Table>> tables;
  for (const ComparisonReport& comparison : comparisons) {
    Table table = methods_table(side_by_side(comparison), TableDetail::data);
    for (const ComparedValue& value : comparison.found.values) {
      const auto [low, high] = ends_of(value.interval);
      const auto [own_low, own_high] = ends_of(value.own);
      const std::array<std::pair<std::string_view, Value>, 5> numbers = {
          {{"own low", own_low},
           {"own high", own_high},
           {"difference", value.difference},
           {"low", low},
           {"high", high}}};
      for (const auto& [name, number] : numbers) {
        if (value.method == 0)
          table.columns.push_back(fmt::format("{} {}", value.metric.symbol(), name));
        table.rows[value.method].push_back(number ? to_line(*number) : "");
      }
    }
    tables.emplace_back(comparison.data_set, std::move(table));
  }
  return render_table(tables.size() == 1 ? tables.front().second : joined_tables(tables), format);
}

}  // namespace vpr
