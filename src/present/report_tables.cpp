#include "present/report_tables.h"

#include <algorithm>
#include <array>

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

// "80.4", or "-" without a value.
std::string percent(std::optional<double> rate) {
  return rate ? fmt::format("{:.1f}", 100 * *rate) : "-";
}

std::string method_title(const Report& report) {
  if (report.name) return *report.name;
  const std::string_view score = title_score(report);
  return score.empty() ? report.method : fmt::format("{}, {}", report.method, score);
}

// " The first, frame 29, is confirmed at frame 49 (2.4 s), 20 frames later." After incorrect ones:
// " The first correct one, frame ..."
std::string first_of(const Judgment& judgment, std::optional<double> frames_per_second) {
  if (!judgment.localization.first_recognition_frames) return "";
  const size_t confirmed = *judgment.localization.first_recognition_frames;
  const auto first = static_cast<size_t>(std::ranges::find(judgment.verdicts, Verdict::correct) -
                                         judgment.verdicts.begin());
  const auto recognized =
      std::ranges::find_if(judgment.verdicts, [](Verdict one) { return one != Verdict::none; });
  const char* which = *recognized == Verdict::correct ? "The first" : "The first correct one";
  const std::string time =
      frames_per_second
          ? fmt::format(" ({:.1f} s)", static_cast<double>(confirmed) / *frames_per_second)
          : "";
  if (first == confirmed) return fmt::format(" {} is confirmed at frame {}{}.", which, first, time);
  return fmt::format(" {}, frame {}, is confirmed at frame {}{}, {} later.", which, first,
                     confirmed, time, counted(confirmed - first, "frame"));
}

// "; 12 frames can be accepted before the first mistake (...)"; empty without a mistake, and if all
// best matches have the same score.
std::string oracle_words(const Judgment& judgment) {
  const auto& points = judgment.single_best.points;
  if (points.size() < 2 || points.back().incorrect == 0) return "";
  return fmt::format(
      "; {} can be accepted before the first mistake (threshold chosen with the ground truth)",
      counted(judgment.localization.correct, "frame"));
}

// "106 frames with a match".
std::string frames_words(const Evaluation& evaluation) {
  const BestMatchCounts counts = best_match_counts(evaluation.judgment.outcomes);
  const bool all_count = counts.without_match == 0 || !evaluation.truth.asked.empty();
  return counted(counts.frames, "frame") + (all_count ? "" : " with a match");
}

// ", over 20 of 111 frames that are labeled"; empty if all pairs are known.
std::string labeled_words(const Evaluation& evaluation) {
  if (evaluation.truth.asked.empty()) return "";
  const Outcomes& outcomes = evaluation.judgment.outcomes;
  return fmt::format(", over {} of {} that are labeled", frames_with_match(outcomes),
                     counted(outcomes.queries.size(), "frame"));
}

// "Best match correct in 106 of 200 frames (53.0 %)".
std::string best_match_words(const Evaluation& evaluation) {
  const BestMatchCounts counts = best_match_counts(evaluation.judgment.outcomes);
  if (!counts.rate()) return "No frame has a match in the ground truth";
  return fmt::format("Best match correct in {} of {} ({:.1f} %){}", counts.correct,
                     frames_words(evaluation), 100 * *counts.rate(), labeled_words(evaluation));
}

std::string pair_words(const Evaluation& evaluation) {
  if (!evaluation.result) return "";
  const bool by_places = evaluation.judgment.by == JudgedBy::places;
  const Counts& counts = evaluation.result->counts;
  const LabelCounts& pairs =
      by_places ? counts.recognitions_by_place.value_or(LabelCounts{}) : counts.recognitions;
  return incorrect_pairs_text({evaluation.judgment.localization, pairs},
                              evaluation.result->result->places.has_value(),
                              by_places || !evaluation.truth.asked.empty());
}

// "17 of 111 frames recognized, 3 of them incorrectly".
std::string recognized_words(const Evaluation& evaluation) {
  const Judgment& judgment = evaluation.judgment;
  const Localization& path = judgment.localization;
  const auto on_map = static_cast<size_t>(
      std::ranges::count_if(judgment.outcomes.queries, [&](const QueryOutcome& query) {
        return query.has_match && judgment.verdicts[query.frame] != Verdict::none;
      }));
  const size_t incorrect = path.incorrect - path.off_map;
  const size_t unjudged = on_map - path.correct - incorrect;
  const std::string pairs = pair_words(evaluation);
  std::string text =
      fmt::format("{} of {} recognized", on_map == 0 ? "None" : std::to_string(on_map),
                  frames_words(evaluation));
  if (on_map > 0 && incorrect > 0)
    text += fmt::format(", {} of them incorrectly", incorrect);
  else if (path.correct > 0)
    text += unjudged > 0    ? fmt::format(", {} correctly", path.correct)
            : pairs.empty() ? ", all correctly"
            : on_map == 1   ? ", its best match correct"
                            : ", their best matches all correct";
  if (unjudged > 0)
    text += fmt::format(", {} {}", unjudged,
                        judgment.by == JudgedBy::places  ? "without an answer"
                        : evaluation.truth.asked.empty() ? "to be ignored"
                                                         : "at places that are not labeled");
  text += labeled_words(evaluation);
  if (path.off_map > 0)
    text += fmt::format("; {} of {} without a match recognized, which is incorrect", path.off_map,
                        counted(path.frames - path.frames_with_match, "frame"));
  return text + pairs;
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
  table.title = fmt::format("{} (over frames {}; ties to the first)", fmt::join(titles, " and "),
                            report.frames_that_count());
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

// The tables of all reports in one, with their names in the column `key`.
Table stacked(std::span<const Report> reports, const std::string& key,
              Table (*table_of)(const Report&)) {
  std::vector<Table> tables;
  std::vector<std::string> names;
  for (const Report& report : reports) {
    tables.push_back(table_of(report));
    names.push_back(report.row_name);
  }
  return stack_tables(tables, key, names);
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

std::string_view title_score(const Report& report) {
  const QuerySettings* settings = report.query_settings();
  const auto* windows =
      settings == nullptr ? nullptr : std::get_if<SequenceQuerySettings>(settings);
  if (windows == nullptr || report.has_paths() || windows->score == Score::raw) return {};
  return enum_name(windows->score);
}

std::optional<NamedSetting> title_window(const Report& report) {
  if (report.has_paths()) return std::nullopt;
  if (const QuerySettings* settings = report.query_settings()) return window_of(*settings);
  return NamedSetting{"window",
                      std::to_string(std::get<ScoreSettings>(report.settings).window_length)};
}

std::string evaluation_title(const Report& report) {
  return fmt::format("{} on {}", method_title(report), report.query);
}

std::string title_with_settings(const Report& report) {
  std::string title = evaluation_title(report);
  const QuerySettings* settings = report.query_settings();
  if (settings == nullptr) return title;
  if (const auto window = title_window(report))
    title += fmt::format(", {} {}", window->first, window->second);
  const auto& [symbol, value] = decided_by(*settings);
  return title + fmt::format(", {} {}", symbol, value);
}

std::string reference_word(const Report& report) {
  return report.has_places() ? "training place" : "training frame";
}

std::string incorrect_pairs_text(const FrameCounts& counts, bool has_places, bool has_labels) {
  const auto& [path, pairs] = counts;
  if (pairs.incorrect == 0 || pairs.all() == path.recognized) return "";
  return fmt::format("; {} of the {} accepted {}{} {} incorrect", pairs.incorrect,
                     has_labels ? pairs.correct + pairs.incorrect : pairs.all(),
                     has_labels ? "labeled " : "",
                     has_places ? "pairs of a frame and a place" : "window pairs",
                     pairs.incorrect == 1 ? "is" : "are");
}

std::string frame_counts_text(const FrameCounts& counts, bool has_places) {
  const Localization& path = counts.path;
  return fmt::format(
      "{} of {} correctly, {} incorrectly{}{}", path.correct,
      counted(path.frames_with_match, "frame"), path.incorrect,
      path.off_map > 0 ? fmt::format(" ({} of them without a match)", path.off_map) : "",
      incorrect_pairs_text(counts, has_places, false));
}

std::string summary_sentence(const Evaluation& evaluation,
                             std::optional<double> frames_per_second) {
  const Judgment& judgment = evaluation.judgment;
  const Localization& path = judgment.localization;
  const Sequence& query = evaluation.query();
  if (query.selection.selected_fps > 0) frames_per_second = query.fps;
  if (judgment.by == JudgedBy::nothing)
    return fmt::format("{} of {} recognized ({} %). Nothing is judged without a ground truth.",
                       path.recognized == 0 ? "None" : std::to_string(path.recognized),
                       counted(path.frames, "frame"), percent(path.recognized_share()));
  const std::string best_match = best_match_words(evaluation);
  if (!evaluation.result && !judgment.threshold) return best_match + "." + evaluation.caution;
  if (judgment.is_oracle) return best_match + oracle_words(judgment) + "." + evaluation.caution;
  return (judgment.threshold ? best_match + ". " : "") + recognized_words(evaluation) + "." +
         first_of(judgment, frames_per_second) + evaluation.caution;
}

std::string off_map_words(std::span<const Report> reports) {
  const bool any = std::ranges::any_of(
      reports, [](const Report& report) { return report.localization.off_map > 0; });
  return any ? "; incorrect also counts frames without a match" : "";
}

bool lack_labels(std::span<const Report> reports) {
  return std::ranges::any_of(reports, [](const Report& report) { return report.unlabeled() > 0; });
}

std::string caution_of(const Report& report) {
  if (report.unlabeled() == 0) return report.caution;
  return report.caution + fmt::format(
                              " Caution: {} without a label {} as not recognized. Label them with "
                              "--ask-frames to compare results.",
                              counted(report.unlabeled(), "best match", "best matches"),
                              report.unlabeled() == 1 ? "counts" : "count");
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
  if (format == TableFormat::csv) return render_table(stacked(reports, "name", csv_row), format);
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

Table protocols_table(std::span<const Report> reports) {
  Table table = stacked(reports, "protocol", report_table);
  table.title = evaluation_title(reports.front());
  return table;
}

}  // namespace vpr
