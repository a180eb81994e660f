#include "present/evaluation_text.h"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/text.h"
#include "present/report_tables.h"
#include "present/result_text.h"
#include "present/summary.h"

namespace vpr {
namespace {

constexpr size_t kLabelWidth = 14;

std::string line(const std::string& label, const std::string& value) {
  return wrapped_text(fmt::format("  {:<{}}{}", label, kLabelWidth, value), kLabelWidth + 2);
}

// "AP 0.9910, R@100P 0.7387".
std::string curve_text(const CurveNumbers& numbers) {
  std::vector<std::string> words;
  for (size_t m = 0; m < curve_metrics().size(); ++m)
    if (const Metric& metric = curve_metrics()[m];
        metric.key == "average_precision" || metric.key == "recall_at_100_precision")
      words.push_back(
          fmt::format("{} {}", metric.symbol, metric_cell(metric, numbers.values[m].value)));
  return fmt::format("{}", fmt::join(words, ", "));
}

std::string best_match_text(const Report& report) {
  const BestMatchCounts& best = report.counts.best_match;
  if (best.frames == 0) return "";
  return fmt::format("correct in {} of {}{}, R@1 {}", best.correct, counted(best.frames, "frame"),
                     best.without_match == 0 || report.has_labels() ? "" : " with a match",
                     metric_cell(find_metric("recall_at"), best.rate()));
}

// Names the metrics that the data do not determine.
std::string unknown_text(const Outcomes& outcomes) {
  std::string text;
  if (!outcomes.has_scores) text = "AP and R@100P need scores";
  if (outcomes.known_ranks < kMaxRank)
    text +=
        fmt::format("{}R@K is known up to K = {}, the shortest list without ignored references{}",
                    text.empty() ? "" : "; ", outcomes.known_ranks,
                    outcomes.has_scores ? "; all pairs are those that are listed" : "");
  return text;
}

std::string recall_text(const Report& report) {
  std::vector<std::string> values;
  for (size_t m = 0; m < rank_metrics().size(); ++m) {
    const Metric& metric = rank_metrics()[m];
    if (metric.needs_all_ranks) continue;
    for (const auto& [k, value] : report.metrics.ranks[m])
      values.push_back(
          fmt::format("{} {}", MetricAt{&metric, k}.symbol(), metric_cell(metric, value)));
  }
  return fmt::format("{}", fmt::join(values, ", "));
}

std::vector<RecognizedRange> judged_ranges(const Evaluation& evaluation) {
  const Result& result = *evaluation.result->result;
  std::vector<RecognizedRange> ranges = recognized_ranges(result);
  if (evaluation.judgment.by == JudgedBy::nothing) return ranges;
  const std::vector<const Match*> closest = recognitions_by_frame(result);
  for (RecognizedRange& range : ranges) {
    size_t frames = 0;  // whose closest recognition is in the range
    size_t incorrect = 0;
    LabelCounts labels;  // of its recognitions
    for (const uint32_t recognition : range.recognitions) {
      const Match& match = result.recognitions[recognition];
      const MatchedFrame at = anchors_of(match, result.window_length());
      const PlaceLabel label = evaluation.judgment.by == JudgedBy::places
                                   ? evaluation.result->clusters[cluster_of(result, match)].label
                                   : label_of(evaluation.truth, at);
      labels.add(label);
      if (closest[at.query] != &match) continue;
      ++frames;
      incorrect += label == PlaceLabel::different;
    }
    if (labels.ignored == labels.all())
      range.verdict = ": not judged";
    else if (labels.incorrect == labels.all())
      range.verdict = frames > 0 ? ": incorrect" : ": incorrect, not the best";
    else if (incorrect > 0)
      range.verdict = fmt::format(": {} of {} incorrect", incorrect, counted(frames, "frame"));
  }
  return ranges;
}

// "12, of 345 recognitions", or the same by verdict.
std::string places_text(const Report& report) {
  const auto& [correct, incorrect, ignored] = *report.counts.clusters;
  const LabelCounts& pairs = *report.counts.recognitions_by_place;
  if (report.judged == JudgedBy::nothing)
    return fmt::format("{}, of {}", ignored, counted(pairs.ignored, "recognition"));
  return fmt::format(
      "{} correct, {} incorrect, {} without an answer; of {}, {} and {} recognitions", correct,
      incorrect, ignored, pairs.correct, pairs.incorrect, pairs.ignored);
}

// Incorrect pairs that are accepted next to the best match of their frame.
bool has_incorrect_pairs(const Report& report) {
  return report.query_settings() != nullptr && !report.has_paths() &&
         report.counts.recognitions.incorrect > 0;
}

// "412 of 639".
std::string pairs_cell(const Report& report) {
  if (report.query_settings() == nullptr || report.has_paths()) return "-";
  const LabelCounts& pairs = report.counts.recognitions;
  return fmt::format("{} of {}", pairs.incorrect, pairs.all());
}

}  // namespace

std::string wrapped_text(const std::string& text, size_t indent) {
  return wrapped_line(text, 80, indent) + "\n";
}

std::string evaluation_text(const Evaluation& evaluation, const Report& report,
                            const std::string& summary, size_t most_ranges) {
  std::string text = wrapped_text(summary);
  const Result* result = evaluation.result ? evaluation.result->result.get() : nullptr;
  if (result != nullptr) text += line("settings", settings_text(*result));
  if (evaluation.truth.is_known) {
    text += line("ground truth", report.protocol.ground_truth);
    const std::string best = result != nullptr ? best_match_text(report) : "";
    if (!best.empty()) text += line("best match", best);
    if (report.outcomes.has_ranks) text += line("recall", recall_text(report));
    const auto& curves = report.metrics.curves;
    const bool by_margin = report.outcomes.confidence == Confidence::margin;
    if (report.outcomes.has_scores) {
      text += line("curve", curve_text(curves.single_best) + (by_margin ? ", by margin" : ""));
      if (curves.all_pairs) text += line("all pairs", curve_text(*curves.all_pairs));
    }
    if (const std::string unknown = unknown_text(report.outcomes); !unknown.empty())
      text += line("not known", unknown);
  }
  if (result != nullptr && report.judged != JudgedBy::ground_truth && report.counts.clusters)
    text += line("places", places_text(report));
  if (result != nullptr)
    text += ranges_text(*result, judged_ranges(evaluation), most_ranges, "other range");
  return text;
}

std::string short_text(Table table, bool is_terminal) {
  const size_t kLongestName = is_terminal ? 22 : std::string::npos;
  for (auto& row : table.rows) {
    if (row[0].size() <= kLongestName) continue;
    size_t cut = kLongestName - 3;
    while (cut > 0 && (row[0][cut] & 0xc0) == 0x80) --cut;  // not within a letter in UTF-8
    row[0] = row[0].substr(0, cut) + "...";
  }
  return render_table(table, TableFormat::text);
}

Table overview_table(std::span<const Report> reports, const std::string& key) {
  const Report& first = reports.front();
  const bool is_one_query = std::ranges::all_of(reports, [&](const Report& report) {
    return report.provenance.ground_truth == first.provenance.ground_truth;
  });
  const bool has_pairs = std::ranges::any_of(
      reports, [](const Report& report) { return has_incorrect_pairs(report); });
  Table table;
  table.title = is_one_query ? fmt::format("{}: over {} {}", first.query,
                                           counted(first.counts.best_match.frames, "frame"),
                                           first.frames_that_count())
                             : "Over all frames with a match";
  table.title += off_map_words(reports);
  table.label = "results";
  table.columns = {key};
  for (const Report& report : reports) table.rows.push_back({report.row_name});
  const auto add = [&](const std::string& column, const auto& cell_of) {
    table.columns.push_back(column);
    for (size_t r = 0; r < reports.size(); ++r) table.rows[r].push_back(cell_of(reports[r]));
  };
  if (!is_one_query)
    add("n", [](const Report& one) { return std::to_string(one.counts.best_match.frames); });
  for (const MetricAt& metric : {metric_at("recall_at", 1), metric_at("average_precision"),
                                 metric_at("recall_at_100_precision")}) {
    std::vector<std::optional<double>> values;
    for (const Report& report : reports) values.push_back(value_of(report, metric));
    if (is_one_query && reports.size() > 1 && !lack_labels(reports))
      mark_best(table, table.columns.size(), values, false);
    add(metric.symbol(),
        [&](const Report& one) { return metric_cell(*metric.metric, value_of(one, metric)); });
  }
  for (const auto& [column, metric] :
       {std::pair("correct", metric_at("correct")), std::pair("incorrect", metric_at("incorrect")),
        std::pair("first", metric_at("first_recognition_frames"))})
    add(column, [at = metric](const Report& one) {
      return one.is_oracle ? "-" : metric_cell(*at.metric, value_of(one, at));
    });
  if (has_pairs) add("pairs incorrect", pairs_cell);
  return table;
}

std::string overview_text(std::span<const Report> reports, const std::string& key) {
  std::string text = short_text(overview_table(reports, key));
  for (const Report& report : reports)
    if (const std::string caution = caution_of(report); !caution.empty())
      text += wrapped_text(fmt::format("{}: {}", report.row_name, caution), 2);
  return text;
}

}  // namespace vpr
