#include "present/report_tables.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/json.h"
#include "base/text.h"
#include "evaluate/report.h"
#include "match/match.h"
#include "present/methods_table.h"
#include "present/result_text.h"
#include "query/query_settings.h"

namespace vpr {
namespace {

constexpr size_t kMostPlaces = 20;  // in a printed list

// c_l or c_w.
NamedSetting window_of(const QuerySettings& settings) {
  const auto* of_places = std::get_if<FabmapQuerySettings>(&settings);
  return {score_of(settings).window_symbol,
          std::to_string(of_places != nullptr ? of_places->window : window_length_of(settings))};
}

std::string number_text(std::optional<double> number) { return number ? to_line(*number) : "auto"; }

// t_r, t_p, or the setting of another decision.
NamedSetting decided_by(const QuerySettings& settings) {
  if (const auto* of_places = std::get_if<FabmapQuerySettings>(&settings))
    return {score_of(settings).threshold_symbol, number_text(of_places->place_threshold)};
  const auto& of_windows = std::get<SequenceQuerySettings>(settings);
  return {decision_kind(decision_of(of_windows.rule)).symbol,
          number_text(limit_of(of_windows.rule))};
}

std::string range_text(const std::array<size_t, 2>& range) {
  return range[0] == range[1] ? std::to_string(range[0])
                              : fmt::format("{} to {}", range[0], range[1]);
}

// The name set by the user, or the method.
std::string method_title(const Report& report) {
  if (report.name) return *report.name;
  const QuerySettings* settings = report.query_settings();
  return settings == nullptr ? report.method : method_text(*settings);
}

using NamedNumbers = std::pair<std::string, const CurveNumbers*>;

std::vector<NamedNumbers> curves_of(const Report& report) {
  const auto& curves = report.metrics.curves;
  const bool by_margin = report.frames.outcomes.confidence == Confidence::margin;
  std::vector<NamedNumbers> all = {
      {by_margin ? "best matches, by margin" : "best matches", &curves.single_best}};
  if (curves.by_margin) all.emplace_back("best matches, by margin", &*curves.by_margin);
  if (curves.by_score) all.emplace_back("best matches, by score", &*curves.by_score);
  if (curves.all_pairs) all.emplace_back("all pairs", &*curves.all_pairs);
  return all;
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
  for (const auto& [name, numbers] : curves_of(report)) {
    auto& row = table.rows.emplace_back();
    row = {name, std::to_string(numbers->positives)};
    for (size_t m = 0; m < curve_metrics().size(); ++m)
      row.push_back(metric_cell(curve_metrics()[m], numbers->values[m].value));
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
             report.frames.localization.frames_with_match);
  const Localization& path = report.frames.localization;
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
  if (report.query_settings() == nullptr) return title;
  for (const auto& [symbol, value] : settings_of(report))
    if (symbol != "scale") title += fmt::format(", {} {}", symbol, value);
  return title;
}

std::string reference_word(const Report& report) {
  return report.has_places() ? "training place" : "training frame";
}

std::vector<NamedSetting> settings_of(const Report& report) {
  const QuerySettings* of_query = report.query_settings();
  if (of_query == nullptr) {
    const auto& of_scores = std::get<ScoreSettings>(report.settings);
    return {{"scores", std::string(enum_name(order_of(of_scores.format)))},
            {"window", std::to_string(of_scores.window_length)}};
  }
  std::vector<NamedSetting> settings;
  if (!report.has_paths()) settings.push_back(window_of(*of_query));
  settings.push_back(decided_by(*of_query));
  if (const auto* windows = std::get_if<SequenceQuerySettings>(of_query);
      windows != nullptr && decision_of(windows->rule) == Decision::threshold)
    settings.emplace_back(
        "scale",
        enum_name(limit_of(windows->rule) ? *scale_of(*windows) : score_of(*of_query).frame_scale));
  return settings;
}

Table report_table(const Report& report) {
  Table table;
  table.title = fmt::format("{} ({})", evaluation_title(report), report.protocol.ground_truth);
  for (const auto& [symbol, value] : settings_of(report)) add_column(table, symbol, value);
  if (report.query_settings() != nullptr) {
    add_metrics(table, report, {"pairs.correct", "pairs.incorrect"});
    if (report.counts.clusters)
      add_metrics(table, report, {"clusters.correct", "mixed_clusters", "clusters.incorrect"});
    add_metrics(table, report, {"distinct"});
  }
  add_metrics(table, report, {"best_match.correct", "best_match.frames", "best_match.rate"});
  return table;
}

Table places_table(const Report& report) {
  const Counts& counts = report.counts;
  const Localization& path = report.frames.localization;
  const bool is_judged = report.frames.by == JudgedBy::places;
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
  if (format == TableFormat::latex || format == TableFormat::csv || reports.size() > 1)
    return render_table(methods_table(side_by_side(reports), detail_of(format)), format);
  const Report& report = reports.front();
  std::string text = render_table(report_table(report), format);
  if (format == TableFormat::text) {
    const std::string places = recognitions_text(report);
    if (!places.empty()) text += "\n" + places;
  }
  std::vector<Table> tables = metrics_tables(report);
  if (report.by_keyframe) tables.insert(tables.begin(), keyframe_table(*report.by_keyframe));
  for (const Table& table : tables) text += "\n" + render_table(table, format);
  return text;
}

}  // namespace vpr
