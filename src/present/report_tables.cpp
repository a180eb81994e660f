#include "present/report_tables.h"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/json.h"
#include "base/text.h"
#include "files/report.h"
#include "match/match.h"
#include "present/evaluation_text.h"
#include "settings/query_settings.h"

namespace vpr {
namespace {

constexpr size_t kMostPlaces = 20;  // in a printed list

using NamedSetting = std::pair<std::string_view, std::string>;

// c_l or c_w; "-" for paths.
NamedSetting window_of(const QuerySettings& settings) {
  const auto* of_places = std::get_if<FabmapQuerySettings>(&settings);
  if (has_paths(settings)) return {score_of(settings).window_symbol, "-"};
  return {score_of(settings).window_symbol,
          std::to_string(of_places != nullptr ? of_places->window : window_length_of(settings))};
}

std::string number_text(std::optional<double> number) { return number ? to_line(*number) : "auto"; }

// t_r, t_p, or the setting of another decision.
NamedSetting decided_by(const QuerySettings& settings) {
  if (const auto* of_places = std::get_if<FabmapQuerySettings>(&settings))
    return {score_of(settings).threshold_symbol, number_text(of_places->place_threshold)};
  const auto& of_windows = std::get<SequenceQuerySettings>(settings);
  return {decision_kind(of_windows.decision).symbol,
          number_text(of_windows.decision == Decision::margin ? of_windows.margin
                                                              : of_windows.distance_threshold)};
}

std::string range_text(const std::array<size_t, 2>& range) {
  return range[0] == range[1] ? std::to_string(range[0])
                              : fmt::format("{} to {}", range[0], range[1]);
}

// The name set by the user, or the method with its score, unless it is raw or without windows.
std::string method_title(const Report& report) {
  if (report.name) return *report.name;
  const QuerySettings* settings = report.query_settings();
  const auto* windows =
      settings == nullptr ? nullptr : std::get_if<SequenceQuerySettings>(settings);
  if (windows == nullptr || report.has_paths() || windows->score == Score::raw)
    return report.method;
  return fmt::format("{}, {}", report.method, enum_name(windows->score));
}

struct NamedNumbers {
  std::string name;    ///< in the first column
  std::string prefix;  ///< of columns in CSV
  const CurveNumbers* numbers = nullptr;
};

std::vector<NamedNumbers> curves_of(const Report& report) {
  const auto& curves = report.metrics.curves;
  const bool by_margin = report.outcomes.confidence == Confidence::margin;
  std::vector<NamedNumbers> all = {
      {by_margin ? "best matches, by margin" : "best matches", "best", &curves.single_best}};
  if (curves.by_margin) all.push_back({"best matches, by margin", "margin", &*curves.by_margin});
  if (curves.by_score) all.push_back({"best matches, by score", "score", &*curves.by_score});
  if (curves.all_pairs) all.push_back({"all pairs", "pairs", &*curves.all_pairs});
  return all;
}

std::string curve_cell(const CurveNumbers& numbers, size_t metric) {
  return metric_cell(curve_metrics()[metric], numbers.values[metric].value);
}

Table curve_table(const Report& report) {
  const BestMatchCounts& best = report.counts.best_match;
  const auto& tied = report.metrics.curves.single_best.tied_queries;
  Table table;
  table.title = fmt::format(
      "Metrics over {} {} ({} without an answer, {} ignored: not recognized; {} without {}{})",
      counted(best.frames, "frame"), report.frames_that_count(), best.no_answer, best.ignored,
      counted(best.without_match, "frame"),
      report.has_labels() ? "a label: not judged" : "a match: incorrect if accepted",
      tied ? fmt::format("; {} tied, to the first", *tied) : "");
  table.columns = {"of", "to find"};
  for (const Metric& metric : curve_metrics()) table.columns.emplace_back(metric.symbol);
  for (const NamedNumbers& curve : curves_of(report)) {
    auto& row = table.rows.emplace_back();
    row = {curve.name, std::to_string(curve.numbers->positives)};
    for (size_t m = 0; m < curve_metrics().size(); ++m)
      row.push_back(curve_cell(*curve.numbers, m));
  }
  return table;
}

// The metrics that need all ranks of correct references, or those that do not. No columns if
// ranks are unknown.
Table rank_table(const Report& report, bool needs_all_ranks) {
  std::vector<std::string_view> titles;
  Table table;
  for (size_t m = 0; m < rank_metrics().size(); ++m) {
    const Metric& metric = rank_metrics()[m];
    if (metric.needs_all_ranks != needs_all_ranks) continue;
    titles.push_back(metric.title);
    for (const auto& [k, value] : report.metrics.ranks[m])
      add_column(table, MetricAt{&metric, k}.symbol(), metric_cell(metric, value));
  }
  const bool skips_ignored = report.query_settings() == nullptr && !report.has_labels();
  table.title = fmt::format("{} (over frames {}; ties to the first; ignored references {})",
                            fmt::join(titles, " and "), report.frames_that_count(),
                            skips_ignored ? "skipped" : "count");
  return table;
}

Table achievement_table(const Report& report) {
  const ReportedAchievement& found = report.metrics.recall_achievement;
  const Metric& metric = find_metric("recall_achievement");
  Table table;
  table.title = fmt::format(
      "Recall achievement rate (share of {} of about {} whose recall@1 reaches the target)",
      counted(found.stretches, "stretch", "stretches"), counted(found.stretch_frames, "frame"));
  for (const auto& [target, share] : found.reached)
    add_column(table, fmt::format("{}{}", metric.symbol, target), metric_cell(metric, share));
  return table;
}

Table localization_table(const Report& report) {
  Table table;
  table.title = fmt::format("Along the path ({})", report.protocol.definition("localization"));
  add_column(table, fmt::format("frames {}", report.frames_that_count()),
             report.localization.frames_with_match);
  const Localization& path = report.localization;
  for (const bool in_meters : {false, true})
    for (const Metric& metric : metrics())
      if (metric.of_path && !metric.symbol.empty() && metric.key.ends_with("_m") == in_meters &&
          (!in_meters || path.longest_gap_m))  // positions are known
        add_column(table, metric.symbol, metric_cell(metric, value_in(path, *metric.of_path)));
  return table;
}

Table keyframe_table(const CountsByKeyframe& counts) {
  const auto& [query_keyframes, train_keyframes, recognitions, best, rate, recall] = counts;
  Table table;
  table.title = fmt::format(
      "By keyframe (consecutive frames that look alike count once: {} and {})",
      counted(query_keyframes, "query keyframe"), counted(train_keyframes, "training keyframe"));
  add_column(table, "keyframe pairs correct", recognitions.correct);
  add_column(table, "keyframe pairs incorrect", recognitions.incorrect);
  add_column(table, "keyframe pairs mixed", recognitions.mixed);
  add_column(table, "keyframes correct", best.correct);
  add_column(table, "keyframes incorrect", best.incorrect);
  add_column(table, "keyframes mixed", best.mixed);
  add_column(table, "keyframes %", percent(rate));
  add_column(table, "keyframes R@100P", percent(recall));
  return table;
}

// The first kMostPlaces places; empty without places.
std::string recognitions_text(const Report& report) {
  if (!report.recognitions || report.recognitions->empty()) return "";
  const std::vector<ReportedCluster>& places = *report.recognitions;
  Table table;
  table.title = fmt::format(
      "Places, judged at their {} (mixed: correct there, but some recognitions are incorrect)",
      report.has_paths() ? "middle frame" : "mean");
  table.columns = {"sequence", "query frames",  "train frames",
                   "place",    "pairs correct", "pairs incorrect"};
  for (const ReportedCluster& place : places) {
    if (table.rows.size() == kMostPlaces) break;
    const LabelCounts& recognitions = place.recognitions;
    add_row(table, place.sequence, range_text(place.query_range), range_text(place.train_range),
            verdict_text({place.label, recognitions}), recognitions.correct,
            recognitions.incorrect);
  }
  return render_table(table, TableFormat::text) +
         (places.size() > kMostPlaces
              ? fmt::format("... and {} more\n", places.size() - kMostPlaces)
              : "");
}

// A column per key.
void add_metrics(Table& table, const Report& report, std::initializer_list<std::string_view> keys) {
  for (const std::string_view key : keys) {
    const MetricAt metric = metric_at(key);
    add_column(table, metric.symbol(), metric_cell(*metric.metric, value_of(report, metric)));
  }
}

Table csv_row(const Report& report) {
  Table table;
  add_column(table, "method", report.method);
  add_column(table, "query", report.query);
  const Table counts = report_table(report);
  table.title = counts.title;
  add_columns(table, counts);
  if (report.counts.recognitions_by_place)
    add_metrics(table, report,
                {"pairs_by_place.correct", "pairs_by_place.incorrect", "pairs_by_place.ignored"});
  if (report.by_keyframe) add_columns(table, keyframe_table(*report.by_keyframe));
  for (const NamedNumbers& curve : curves_of(report))
    for (size_t m = 0; m < curve_metrics().size(); ++m)
      add_column(table, fmt::format("{} {}", curve.prefix, curve_metrics()[m].symbol),
                 curve_cell(*curve.numbers, m));
  for (const Table& more : {rank_table(report, false), rank_table(report, true),
                            achievement_table(report), localization_table(report)})
    add_columns(table, more);
  return table;
}

}  // namespace

std::string metric_cell(const Metric& metric, std::optional<double> value) {
  if (metric.is_percent) return percent(value);
  return value ? fmt::format("{:.{}f}", *value, metric.digits) : "-";
}

std::string evaluation_title(const Report& report) {
  return fmt::format("{} on {}", method_title(report), report.query);
}

std::string title_with_settings(const Report& report) {
  std::string title = evaluation_title(report);
  const QuerySettings* settings = report.query_settings();
  if (settings == nullptr) return title;
  if (!report.has_paths()) {
    const auto& [symbol, length] = window_of(*settings);
    title += fmt::format(", {} {}", symbol, length);
  }
  const auto& [symbol, value] = decided_by(*settings);
  return title + fmt::format(", {} {}", symbol, value);
}

std::string reference_word(const Report& report) {
  return report.has_places() ? "training place" : "training frame";
}

Table report_table(const Report& report) {
  const QuerySettings* of_query = report.query_settings();
  Table table;
  table.title = fmt::format("{} ({})", evaluation_title(report), report.protocol.ground_truth);
  if (of_query != nullptr) {
    for (const auto& [symbol, value] : {window_of(*of_query), decided_by(*of_query)})
      add_column(table, symbol, value);
    if (const auto* windows = std::get_if<SequenceQuerySettings>(of_query);
        windows != nullptr && windows->decision == Decision::threshold)
      add_column(table, "scale",
                 enum_name(windows->distance_threshold ? scale_of(*windows)
                                                       : score_of(*of_query).frame_scale));
    add_metrics(table, report, {"pairs.correct", "pairs.incorrect"});
    if (report.counts.clusters)
      add_metrics(table, report, {"places.correct", "mixed_places", "places.incorrect"});
    add_metrics(table, report, {"distinct"});
  } else {
    const auto& of_scores = std::get<ScoreSettings>(report.settings);
    add_column(table, "scores", enum_name(order_of(of_scores.format)));
    add_column(table, "window", of_scores.window_length);
  }
  add_metrics(table, report, {"best_match.correct", "best_match.frames", "best_match.rate"});
  return table;
}

Table places_table(const Report& report) {
  const Counts& counts = report.counts;
  const Localization& path = report.localization;
  const bool is_judged = report.judged == JudgedBy::places;
  Table table;
  table.title = fmt::format("{} ({})", evaluation_title(report),
                            is_judged ? report.protocol.ground_truth : "not judged");
  const auto add = [&](const std::string& noun, const LabelCounts& labels) {
    add_column(table, noun, labels.all());
    if (!is_judged) return;
    add_column(table, noun + " correct", labels.correct);
    add_column(table, noun + " incorrect", labels.incorrect);
  };
  add("pairs", counts.recognitions_by_place.value_or(counts.recognitions));
  if (counts.clusters) add("places", *counts.clusters);
  add("frames", {path.correct, path.incorrect, path.recognized - path.correct - path.incorrect});
  add_column(table, "of", path.frames);
  add_column(table, "%", percent(path.recognized_share()));
  return table;
}

std::vector<Table> metrics_tables(const Report& report) {
  std::vector<Table> tables = {curve_table(report)};
  if (Table recalls = rank_table(report, false); recalls.columns.size() > 1)
    tables.push_back(std::move(recalls));
  if (Table ranking = rank_table(report, true); !ranking.columns.empty())
    tables.push_back(std::move(ranking));
  tables.push_back(achievement_table(report));
  tables.push_back(localization_table(report));
  return tables;
}

std::string reports_text(std::span<const Report> reports, TableFormat format) {
  if (format == TableFormat::csv) {
    std::vector<Table> rows;
    std::vector<std::string> names;
    for (const Report& report : reports) {
      rows.push_back(csv_row(report));
      names.push_back(report.row_name);
    }
    return render_table(stack_tables(rows, "name", names), format);
  }
  if (format == TableFormat::latex) return render_table(overview_table(reports, "method"), format);
  const bool is_one = reports.size() == 1;
  std::vector<std::vector<Table>> kinds;  // the same table of all reports
  std::vector<std::vector<std::string>> names;
  for (const Report& report : reports) {
    std::vector<Table> tables = {report_table(report)};
    if (report.by_keyframe) tables.push_back(keyframe_table(*report.by_keyframe));
    for (Table& more : metrics_tables(report)) tables.push_back(std::move(more));
    kinds.resize(std::max(kinds.size(), tables.size()));
    names.resize(kinds.size());
    for (size_t t = 0; t < tables.size(); ++t) {
      kinds[t].push_back(std::move(tables[t]));
      names[t].push_back(report.row_name);
    }
  }
  std::string text;
  for (size_t t = 0; t < kinds.size(); ++t) {
    const Table table = is_one ? kinds[t][0] : stack_tables(kinds[t], "name", names[t]);
    text += (t == 0 ? "" : "\n") + render_table(table, format);
    if (t > 0 || !is_one || format != TableFormat::text) continue;
    const std::string places = recognitions_text(reports[0]);
    if (!places.empty()) text += "\n" + places;
  }
  return text;
}

}  // namespace vpr
