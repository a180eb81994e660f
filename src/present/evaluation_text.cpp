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

// "30 of 1500 frames have a better match than the first incorrect one of 200 labels, at 312".
std::string measured_threshold_text(const Evaluation& evaluation) {
  const std::optional<LabeledThreshold> found = labeled_threshold(evaluation);
  if (!found) return "";
  const Outcomes& outcomes = evaluation.judgment.outcomes;
  const std::string frames =
      fmt::format("{} of {}", found->accepted, counted(outcomes.queries.size(), "frame"));
  if (!found->threshold)
    return fmt::format("all {} say same; {} have a match", counted(found->labels, "label"), frames);
  return fmt::format("{} match better than the first incorrect one of {}, at {} {:.6g}", frames,
                     counted(found->labels, "label"), enum_name(outcomes.confidence),
                     *found->threshold);
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
                                   ? evaluation.result->answers->of_recognition[recognition]
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
  if (report.frames.by == JudgedBy::nothing)
    return fmt::format("{}, of {}", ignored, counted(pairs.ignored, "recognition"));
  return fmt::format(
      "{} correct, {} incorrect, {} without an answer; of {}, {} and {} recognitions", correct,
      incorrect, ignored, pairs.correct, pairs.incorrect, pairs.ignored);
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
    if (report.frames.outcomes.has_ranks) text += line("recall", recall_text(report));
    const auto& curves = report.metrics.curves;
    const bool by_margin = report.frames.outcomes.confidence == Confidence::margin;
    if (report.frames.outcomes.has_scores) {
      text += line("ranking", curve_text(curves.single_best) + (by_margin ? " (by margin)" : ""));
      if (curves.all_pairs) text += line("all pairs", curve_text(*curves.all_pairs));
    }
    if (const std::string threshold = measured_threshold_text(evaluation); !threshold.empty())
      text += line("labels", threshold);
    if (const std::string unknown = unknown_text(report.frames.outcomes); !unknown.empty())
      text += line("not known", unknown);
  }
  if (result != nullptr && report.frames.by != JudgedBy::ground_truth && report.counts.clusters)
    text += line("places", places_text(report));
  if (result != nullptr)
    text += ranges_text(*result, judged_ranges(evaluation), most_ranges, "other range");
  return text;
}

}  // namespace vpr
