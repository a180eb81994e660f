#include "present/comparison_report.h"

#include <algorithm>
#include <array>
#include <map>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/text.h"
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
  if (report.selection.is_selected() && at != std::string::npos)
    protocol.erase(at, selection.size());
  return protocol;
}

// "filter" of filter.report.json.
std::string method_name(const fs::path& path) {
  fs::path stem = path.stem();
  return (stem.extension() == ".report" ? stem.stem() : stem).string();
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
  report.frames.localization.longest_gap_frames.reset();
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
    if (selection_text(report.selection) != selection_text(reports.front().selection)) {
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
  constexpr double kMostRank = 1e7;
  for (const size_t k : comparison.settings.recall_at)
    require_range("recall_at", static_cast<double>(k), 1, kMostRank);
  // Reports have the first correct rank of each query, so that any K is known.
  for (Report& report : comparison.reports)
    for (const size_t k : comparison.settings.recall_at)
      for (size_t m = 0; m < rank_metrics().size(); ++m)
        if (const Outcomes& outcomes = report.frames.outcomes;
            !rank_metrics()[m].needs_all_ranks && rank_metrics()[m].is_known_at(outcomes, k))
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
      const std::array<std::pair<std::string_view, std::optional<double>>, 5> numbers = {
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
