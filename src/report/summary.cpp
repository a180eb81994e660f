#include "report/summary.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/json.h"
#include "base/text.h"
#include "report/evaluation_report.h"

namespace vpr {
namespace {

size_t count_of(const Judgement& judgement, Fix fix) {
  return static_cast<size_t>(std::count(judgement.fixes.begin(), judgement.fixes.end(), fix));
}

std::string time_of(size_t frame, std::optional<double> frames_per_second) {
  if (!frames_per_second) return "";
  return fmt::format(" ({:.1f} s)", static_cast<double>(frame) / *frames_per_second);
}

std::string first_of(const Judgement& judgement, bool is_judged,
                     std::optional<double> frames_per_second) {
  const auto& fixes = judgement.fixes;
  const auto first = std::find_if(fixes.begin(), fixes.end(), [&](Fix fix) {
    return is_judged ? fix == Fix::right : fix != Fix::none;
  });
  if (first == fixes.end()) return "";
  const auto frame = static_cast<size_t>(first - fixes.begin());
  return fmt::format("; the first {}one at frame {}{}", is_judged ? "right " : "", frame,
                     time_of(frame, frames_per_second));
}

// "12 before the first mistake, at a threshold chosen from the ground truth"; empty where there is
// no mistake, or all best matches score the same.
std::string oracle_words(const Judgement& judgement) {
  const auto& points = judgement.single_best.points;
  if (points.size() < 2 || points.back().incorrect == 0) return "";
  const size_t right = count_of(judgement, Fix::right);
  return fmt::format("; {} before the first mistake, at a threshold chosen from the ground truth",
                     right == 0 ? "none" : std::to_string(right));
}

// Of scores: "Best match right in 106 of 200 frames (53.0 %)".
std::string best_match_words(const Judgement& judgement) {
  const BestMatchCounts counts = best_match_counts(judgement.outcomes);
  const std::string unit = judgement.layout.window_length > 1 ? "window" : "frame";
  if (!counts.rate()) return fmt::format("No {} has a match in the ground truth", unit);
  const bool all_match = counts.without_match + counts.unreachable == 0;
  const std::string more = all_match ? "" : " with a match";
  return fmt::format("Best match right in {} of {} ({:.1f} %)", counts.correct,
                     counted(counts.queries - counts.ignored, unit + more, unit + "s" + more),
                     100 * *counts.rate());
}

}  // namespace

std::string summary_sentence(const Judgement& judgement, bool is_judged,
                             std::optional<double> frames_per_second) {
  if (judgement.is_oracle) return best_match_words(judgement) + oracle_words(judgement) + ".";
  const size_t right = count_of(judgement, Fix::right);
  const size_t wrong = count_of(judgement, Fix::wrong);
  const size_t unjudged = count_of(judgement, Fix::unjudged);
  const size_t all = right + wrong + unjudged;
  const auto some = [](size_t count) { return count == 0 ? "none" : std::to_string(count); };
  std::string text = judgement.threshold ? best_match_words(judgement) + ". " : "";
  text +=
      fmt::format("Recognised in {} of {}", some(all), counted(judgement.fixes.size(), "frame"));
  if (all > 0 && is_judged) {
    text += fmt::format(", {} of them wrong", some(wrong));
    if (unjudged > 0) text += fmt::format(", {} to be ignored", unjudged);
  }
  text += first_of(judgement, is_judged, frames_per_second) + ".";
  return is_judged ? text : text + " Nothing is judged without a ground truth.";
}

Table unjudged_table(const Json& report) {
  Table table;
  table.title = evaluation_title(report) + ", not judged";
  std::vector<std::string> row;
  for (const char* key : {"hits", "places"}) {
    if (!report["counts"].contains(key)) continue;
    table.columns.emplace_back(key);
    row.push_back(report["counts"][key]["ignored"].dump());
  }
  const auto best = report["outcomes"]["best"].get<std::string>();
  table.columns.emplace_back("best matches");
  row.push_back(std::to_string(std::count(best.begin(), best.end(), 'i')));
  table.rows = {row};
  return table;
}

}  // namespace vpr
