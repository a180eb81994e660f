#include "present/evaluation_tables.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/json.h"
#include "base/text.h"
#include "decide/score_kind.h"
#include "match/match.h"

namespace vpr {
namespace {

constexpr size_t kMostPlaces = 20;  // in a printed list

// Settings of raw distances name no score, and those of FAB-MAP have another threshold.
const ScoreKind& score_kind_of(const Json& settings) {
  if (settings.contains(std::string(probability_kind().threshold_symbol)))
    return probability_kind();
  const auto named = enum_value<Score>(settings.value("score", std::string()));
  return score_kind(named.value_or(Score::raw));
}

// What hits were decided by: t_r, t_p, or the setting of another decision.
std::string_view decided_by(const Json& settings) {
  const auto decision = enum_value<Decision>(settings.value("decide", std::string()));
  return decision ? decision_kind(*decision).symbol : score_kind_of(settings).threshold_symbol;
}

std::string text(const Json& json) {
  return json.is_string() ? json.get<std::string>() : json.dump();
}

std::string range_text(const Json& range) {
  const std::string first = text(range[0]);
  return range[0] == range[1] ? first : fmt::format("{} to {}", first, text(range[1]));
}

// Of a place in a report.
std::string verdict_text(const Json& place) {
  if (place["label"] == enum_name(PlaceLabel::different)) return "wrong";
  if (place["label"] == enum_name(PlaceLabel::ignore)) return "ignored";
  return place["hits"]["incorrect"] == 0 ? "right" : "mixed";
}

// "80.4", or "-" where nothing is judged.
std::string per_cent(const Json& counts) {
  return counts["rate"].is_null() ? "-" : fmt::format("{:.1f}", 100 * counts["rate"].get<double>());
}

// What a report is of, for titles: the name that the user gave; else the method, and the score
// where it is not raw distances.
std::string method_title(const Json& report) {
  if (report.contains("name")) return text(report["name"]);
  const std::string method = text(report["method"]);
  const bool has_score = report["settings"].contains("score");
  return has_score ? method + ", " + text(report["settings"]["score"]) : method;
}

std::string setting_text(const Json& settings, std::string_view symbol) {
  const auto found = settings.find(std::string(symbol));
  return found == settings.end() ? "" : fmt::format(", {} {}", symbol, text(*found));
}

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

std::string evaluation_title(const Json& report) {
  return fmt::format("{} on {}", method_title(report), text(report["query"]));
}

std::string title_with_settings(const Json& report) {
  std::string title = evaluation_title(report);
  title += setting_text(report["settings"], score_kind(Score::raw).window_symbol);
  for (const DecisionKind& decision : decision_kinds())
    title += setting_text(report["settings"], decision.symbol);
  for (const std::string_view symbol :
       {probability_kind().window_symbol, probability_kind().threshold_symbol})
    title += setting_text(report["settings"], symbol);
  return title;
}

std::string reference_word(const Json& report) {
  return report["settings"].contains("t_p") ? "training place" : "training frame";
}

std::string score_words(const Json& report) {
  if (!report.contains("counts")) return text(report["outcomes"]["scores_are"]);
  return std::string(score_kind_of(report["settings"]).title);
}

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

Table report_table(const Json& report) {
  const Json& settings = report["settings"];
  const Json& best = report["best_match"];
  const bool is_result = report.contains("counts");
  Table table;
  table.title =
      fmt::format("{} on {} ({})", is_result ? method_title(report) : text(report["method"]),
                  text(report["query"]), text(report["protocol"]["ground_truth"]));
  table.rows.emplace_back();
  const auto add = [&](const std::string_view column, const std::string& value) {
    table.columns.emplace_back(column);
    table.rows[0].push_back(value);
  };
  if (is_result) {
    const Json& counts = report["counts"];
    const ScoreKind& score = score_kind_of(settings);
    for (const std::string_view symbol : {score.window_symbol, decided_by(settings)})
      add(symbol, text(settings[std::string(symbol)]));
    if (settings.contains("t_r_scale"))
      add("scale", settings["t_r"].is_string() ? std::string(enum_name(score.frame_scale))
                                               : text(settings["t_r_scale"]));
    add("hits right", text(counts["hits"]["correct"]));
    add("hits wrong", text(counts["hits"]["incorrect"]));
    if (counts.contains("places")) {
      add("places right", text(counts["places"]["correct"]));
      add("of these mixed", text(counts["mixed_places"]));
      add("places wrong", text(counts["places"]["incorrect"]));
    }
    add("distinct", text(counts["distinct"]));
  } else {
    add("scores", text(settings["scores"]));
    add("window", text(settings["window"]));
  }
  add("best right", text(best["correct"]));
  add("of", std::to_string(best["queries"].get<uint64_t>() - best["ignored"].get<uint64_t>()));
  add("per cent", per_cent(best));
  return table;
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

Table view_table(const Json& report) {
  const Json& counts = report["by_view"];
  const Json& hits = counts["hits"];
  const Json& best = counts["best_match"];
  Table table;
  table.title = fmt::format("By view (frames in a row that look alike count once: {} and {})",
                            counted(counts["query_views"].get<uint64_t>(), "query view"),
                            counted(counts["train_views"].get<uint64_t>(), "training view"));
  table.columns = {"view pairs right", "view pairs wrong", "view pairs mixed", "views right",
                   "views wrong",      "views mixed",      "views per cent"};
  table.rows = {{hits["correct"].dump(), hits["incorrect"].dump(), hits["mixed"].dump(),
                 best["correct"].dump(), best["incorrect"].dump(), best["mixed"].dump(),
                 per_cent(best)}};
  return table;
}

std::string recognitions_text(const Json& report) {
  if (!report.contains("recognitions")) return "";
  Table table;
  const bool has_tracks = has_paths(report["settings"].value("method", std::string()));
  table.title =
      fmt::format("Places, judged at their {} (mixed: right there, but some hits are wrong)",
                  has_tracks ? "middle frame" : "mean");
  table.columns = {"sequence", "query frames", "train frames", "place", "hits right", "hits wrong"};
  const Json& places = report["recognitions"];
  for (const Json& place : places) {
    if (table.rows.size() == kMostPlaces) break;
    const Json& hits = place["hits"];
    table.rows.push_back({text(place["sequence"]), range_text(place["query_range"]),
                          range_text(place["train_range"]), verdict_text(place),
                          text(hits["correct"]), text(hits["incorrect"])});
  }
  if (table.rows.empty()) return "";
  return render_table(table, TableFormat::text) +
         (places.size() > kMostPlaces
              ? fmt::format("... and {} more\n", places.size() - kMostPlaces)
              : "");
}

Table protocols_table(const std::vector<ProtocolReport>& reports) {
  std::vector<Table> rows;
  std::vector<std::string> names;
  for (const auto& [preset, report] : reports) {
    rows.push_back(report_table(report));
    names.emplace_back(preset->name);
  }
  Table table = stack_tables(rows, "protocol", names);
  table.title = evaluation_title(reports.front().report);
  return table;
}

std::string protocols_notes(const std::vector<ProtocolReport>& reports) {
  std::string notes;
  for (const ProtocolReport& one : reports)
    notes += one.report["protocol"]["ground_truth"].get<std::string>() + "\n";
  return notes;
}

}  // namespace vpr
