#include "present/summary.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/text.h"
#include "present/table.h"

namespace vpr {
namespace {

// " The first is confirmed at frame 49 (2.4 s), for frame 29 on." After incorrect ones: " The first
// correct one ..."
std::string first_of(const Judgment& judgment, const Sequence& query,
                     std::optional<double> recorded_fps) {
  if (!judgment.localization.first_recognition_frames) return "";
  const size_t confirmed = *judgment.localization.first_recognition_frames;
  const auto first = static_cast<size_t>(std::ranges::find(judgment.verdicts, Verdict::correct) -
                                         judgment.verdicts.begin());
  const auto recognized =
      std::ranges::find_if(judgment.verdicts, [](Verdict one) { return one != Verdict::none; });
  const char* which = *recognized == Verdict::correct ? "The first" : "The first correct one";
  const size_t recorded =
      query.selection.speed.empty() ? query.selection.source_of(confirmed) : confirmed;
  const std::string time =
      recorded_fps ? fmt::format(" ({:.1f} s)", static_cast<double>(recorded) / *recorded_fps) : "";
  if (first == confirmed) return fmt::format(" {} is confirmed at frame {}{}.", which, first, time);
  return fmt::format(" {} is confirmed at frame {}{}, for frame {} on.", which, confirmed, time,
                     first);
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
  const uint64_t open = best_match_counts(outcomes).ignored;
  return fmt::format(
      ", over {} of {} that are labeled{}", frames_with_match(outcomes),
      counted(outcomes.queries.size(), "frame"),
      evaluation.truth.is_sample && open > 0
          ? fmt::format(
                "; {} of their best matches are not labeled, so nothing is estimated: label "
                "them with --ask-frames",
                open)
          : "");
}

// "84 to 98 %".
std::string interval_words(const Interval& interval) {
  return fmt::format("{:.0f} to {:.0f} %", 100 * interval.low, 100 * interval.high);
}

// "; 27 answers, each for at most 50 frames": by places.
std::string answers_words(const Evaluation& evaluation) {
  if (!evaluation.result || !evaluation.result->answers) return "";
  const PlaceAnswers& answers = *evaluation.result->answers;
  return fmt::format(", by {}, {}for {}{}", counted(answers.answers, "answer"),
                     answers.answers == 1 ? "" : "each ", answers.answers == 1 ? "" : "at most ",
                     counted(answers.most_frames, "frame"));
}

// "Best match correct in 106 of 200 frames (53.0 %)".
std::string best_match_words(const Evaluation& evaluation) {
  const BestMatchCounts counts = best_match_counts(evaluation.judgment.outcomes);
  if (!counts.rate()) return "No frame has a match in the ground truth";
  return fmt::format("Best match correct in {} of {} ({:.1f} %){}", counts.correct,
                     frames_words(evaluation), 100 * *counts.rate(), labeled_words(evaluation));
}

// "; 412 of the 639 accepted window pairs are incorrect". Empty if none is, and if each frame has a
// single pair, by which it is judged. With answers, only pairs of places with an answer count.
std::string incorrect_pairs_text(const FrameCounts& counts, bool has_places, bool has_answers) {
  const auto& [path, pairs] = counts;
  if (pairs.incorrect == 0 || pairs.all() == path.recognized) return "";
  return fmt::format("; {} of the {} accepted {}{} {} incorrect", pairs.incorrect,
                     has_answers ? pairs.correct + pairs.incorrect : pairs.all(),
                     has_answers ? "labeled " : "",
                     has_places ? "pairs of a frame and a place" : "window pairs",
                     pairs.incorrect == 1 ? "is" : "are");
}

std::string pair_words(const Evaluation& evaluation) {
  // Labels of frames are of few pairs around them, so most of the labeled pairs are correct.
  if (!evaluation.result || !evaluation.truth.asked.empty()) return "";
  const bool by_places = evaluation.judgment.by == JudgedBy::places;
  const Counts& counts = evaluation.result->counts;
  const LabelCounts& pairs =
      by_places ? counts.recognitions_by_place.value_or(LabelCounts{}) : counts.recognitions;
  return incorrect_pairs_text({evaluation.judgment.localization, pairs},
                              evaluation.result->result->places.has_value(), by_places);
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
  text += labeled_words(evaluation) + answers_words(evaluation);
  if (path.off_map > 0)
    text += fmt::format("; {} of {} without a match recognized, which is incorrect", path.off_map,
                        counted(path.frames - path.frames_with_match, "frame"));
  return text + pairs;
}

// "Best match correct, estimated from 50 frames spread along the query: 94 % (84 to 98 %). 44 of
// these frames recognized, 1 of them incorrectly (0 to 12 %)."
std::string estimate_words(const Evaluation& evaluation, const Estimate& found) {
  const Judgment& judgment = evaluation.judgment;
  std::string text =
      fmt::format("Best match correct, estimated from {} spread along the query: {:.0f} % ({}).",
                  counted(found.frames, "frame"), 100 * found.rate, interval_words(found.interval));
  if (!evaluation.result && !judgment.threshold) return text;
  const Localization& path = judgment.localization;
  const uint64_t judged = path.correct + path.incorrect;
  text +=
      fmt::format(" {} of these frames recognized", judged == 0 ? "None" : std::to_string(judged));
  if (judged > 0)
    text += fmt::format(", {} of them incorrectly ({})", path.incorrect,
                        interval_words(estimate_share(path.incorrect, judged).interval));
  return text + pair_words(evaluation) + ".";
}

}  // namespace

std::string frame_counts_text(const FrameCounts& counts, bool has_places) {
  const Localization& path = counts.path;
  return fmt::format(
      "{} of {} correctly, {} incorrectly{}{}", path.correct,
      counted(path.frames_with_match, "frame"), path.incorrect,
      path.off_map > 0 ? fmt::format(" ({} of them without a match)", path.off_map) : "",
      incorrect_pairs_text(counts, has_places, false));
}

std::string summary_sentence(const Evaluation& evaluation, std::optional<double> recorded_fps) {
  const Judgment& judgment = evaluation.judgment;
  const Localization& path = judgment.localization;
  if (judgment.by == JudgedBy::nothing)
    return fmt::format("{} of {} recognized ({} %). Nothing is judged without a ground truth.",
                       path.recognized == 0 ? "None" : std::to_string(path.recognized),
                       counted(path.frames, "frame"), percent(path.recognized_share()));
  if (const auto estimate = estimated_recall(evaluation))
    return estimate_words(evaluation, *estimate);
  const std::string best_match = best_match_words(evaluation);
  const std::string end = evaluation.caution.empty() ? "" : " " + evaluation.caution;
  if (!evaluation.result && !judgment.threshold) return best_match + "." + end;
  if (judgment.is_oracle) return best_match + oracle_words(judgment) + "." + end;
  return (judgment.threshold ? best_match + ". " : "") + recognized_words(evaluation) + "." +
         first_of(judgment, evaluation.query(), recorded_fps) + end;
}

std::string off_map_words(std::span<const Report> reports) {
  const bool any = std::ranges::any_of(
      reports, [](const Report& report) { return report.frames.localization.off_map > 0; });
  return any ? "; incorrect also counts frames without a match" : "";
}

bool lack_labels(std::span<const Report> reports) {
  return std::ranges::any_of(reports, [](const Report& report) { return report.unlabeled() > 0; });
}

std::string caution_of(const Report& report) {
  if (report.unlabeled() == 0) return report.caution;
  return fmt::format(
      "{}{}Caution: {} without a label {} as not recognized. Label them with --ask-frames to "
      "compare results.",
      report.caution, report.caution.empty() ? "" : " ",
      counted(report.unlabeled(), "best match", "best matches"),
      report.unlabeled() == 1 ? "counts" : "count");
}

}  // namespace vpr
