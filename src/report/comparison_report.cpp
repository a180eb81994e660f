#include "report/comparison_report.h"

#include <algorithm>
#include <charconv>
#include <map>
#include <string_view>

#include <fmt/format.h>

#include "base/counted.h"
#include "base/error.h"
#include "base/json.h"
#include "base/text.h"
#include "recognition/score_kind.h"
#include "report/json_fields.h"
#include "report/scores_report.h"

namespace vpr {
namespace {

constexpr uint64_t kMostFrames = uint64_t{1} << 32;

template <class T>
std::optional<T> number(std::string_view word) {
  T value{};
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc{} || end != word.data() + word.size()) return std::nullopt;
  return value;
}

void set_verdict(QueryOutcome& query, char letter, const Fields& fields) {
  query.has_match = letter == 'c' || letter == 'w';
  switch (letter) {
    case 'c':
      query.verdict = Verdict::correct;
      return;
    case 'b':
      query.is_unreachable = true;
      [[fallthrough]];
    case 'w':
    case 'n':
      query.verdict = Verdict::incorrect;
      return;
    case 'i':
      query.verdict = Verdict::ignored;
      return;
    case 'u':
      query.verdict = Verdict::unreadable;
      return;
    default:
      fields.fail("an outcome is none");
  }
}

Outcomes read_outcomes(const Fields& fields) {
  const Fields part = fields.object("outcomes");
  Outcomes outcomes;
  const auto kind = enum_value<ScoreOrder>(part.text("scores_are"));
  if (!kind) fields.fail("its scores are neither distances nor similarities");
  outcomes.kind = *kind;
  const uint64_t first = part.count("first_frame", kMostFrames);
  outcomes.window_length = first + 1;
  const std::string letters = part.text("best");
  const std::string scores_text = part.text("scores");
  const auto scores = split_words(scores_text);
  outcomes.has_ranks = part.has("ranks");
  const std::string ranks_text = outcomes.has_ranks ? part.text("ranks") : "";
  const auto ranks = split_words(ranks_text);
  if (scores.size() != letters.size() || (outcomes.has_ranks && ranks.size() != letters.size()))
    fields.fail("its outcomes do not fit each other");
  for (size_t q = 0; q < letters.size(); ++q) {
    QueryOutcome& query = outcomes.queries.emplace_back();
    query.frame = first + q;
    set_verdict(query, letters[q], fields);
    if (scores[q] != "-") {
      const auto score = number<double>(scores[q]);
      if (!score) fields.fail("a score is no number");
      query.key = score_key(*score, outcomes.kind);
    }
    if (outcomes.has_ranks && ranks[q] != "-") {
      query.rank = number<size_t>(ranks[q]);
      if (!query.rank) fields.fail("a rank is no number");
    }
  }
  outcomes.query_frames = first + letters.size();
  return outcomes;
}

bool is_of_places(const Json& settings) {
  return settings.is_object() &&
         settings.contains(std::string(probability_kind().threshold_symbol));
}

Json or_null(const auto& value) { return value ? Json(*value) : Json(); }

std::string signed_number(const Json& value) {
  return value.is_null() ? "-" : fmt::format("{:+.4f}", value.get<double>());
}

// Whether the interval leaves chance out.
std::string judgement_of(const Json& row) {
  if (row["low"].is_null()) return "";
  if (row["low"].get<double>() > 0) return "better";
  return row["high"].get<double>() < 0 ? "worse" : "";
}

}  // namespace

StoredReport read_report(const std::filesystem::path& path) {
  const std::string where = path.string();
  const Json json = read_json(path, ErrorKind::data);
  require_schema(json, "report", where, ErrorKind::data);
  const Fields fields(json, where);
  if (!fields.has("outcomes"))
    throw Error(ErrorKind::data, fmt::format("{}: has no outcomes of single queries; make it again "
                                             "with vpr-eval",
                                             where));
  StoredReport report;
  report.method = fields.text("method");
  report.query = fields.text("query");
  report.ground_truth = fields.object("protocol").text("ground_truth");
  const Fields provenance = fields.object("provenance");
  if (provenance.has("ground_truth"))
    report.ground_truth_fingerprint = provenance.text("ground_truth");
  if (fields.has("name")) report.name = fields.text("name");
  report.has_places = fields.has("settings") && is_of_places(json["settings"]);
  report.fingerprint = provenance.text(provenance.has("result") ? "result" : "scores");
  report.outcomes = read_outcomes(fields);
  return report;
}

GroundTruths compare_ground_truths(const std::vector<StoredReport>& reports) {
  bool is_known = true;
  std::map<bool, std::string> of_kind;  // places or frames
  for (const StoredReport& report : reports) {
    const auto& fingerprint = report.ground_truth_fingerprint;
    is_known = is_known && fingerprint;
    if (!fingerprint) continue;
    const auto found = of_kind.emplace(report.has_places, *fingerprint).first;
    if (found->second != *fingerprint) return GroundTruths::different;
  }
  const bool agree = of_kind.size() < 2 || of_kind[true] == of_kind[false];
  if (!agree) return GroundTruths::of_places_and_frames;
  return is_known ? GroundTruths::same : GroundTruths::unknown;
}

std::vector<std::string> report_names(const std::vector<StoredReport>& reports,
                                      const std::vector<std::string>& paths) {
  // What each may be called, the best first; the last tells every report apart.
  std::vector<std::vector<std::string>> choices;
  for (size_t r = 0; r < reports.size(); ++r) {
    const std::string stem = std::filesystem::path(paths[r]).stem().string();
    if (reports[r].name)
      choices.push_back(
          {*reports[r].name, *reports[r].name, fmt::format("{} ({})", *reports[r].name, r + 1)});
    else
      choices.push_back({reports[r].method, stem, fmt::format("{} ({})", stem, r + 1)});
  }
  std::vector<size_t> chosen(reports.size(), 0);
  const auto clashes = [&](size_t r) {
    for (size_t other = 0; other < reports.size(); ++other)
      if (other != r && choices[other][chosen[other]] == choices[r][chosen[r]] &&
          (reports[other].name || !reports[r].name))  // a user's name makes way for another only
        return true;
    return false;
  };
  for (size_t level = 0; level < 2; ++level) {
    std::vector<size_t> next = chosen;
    for (size_t r = 0; r < reports.size(); ++r)
      if (chosen[r] == level && clashes(r)) next[r] = level + 1;
    chosen = next;
  }
  std::vector<std::string> names;
  for (size_t r = 0; r < reports.size(); ++r) names.push_back(choices[r][chosen[r]]);
  return names;
}

Json comparison_json(const Comparison& comparison, const std::vector<StoredReport>& reports,
                     const std::vector<std::string>& names, size_t resamples, const RunInfo& run) {
  const auto named = std::find_if(reports.begin(), reports.end(), [](const StoredReport& report) {
    return report.query != kUnnamedQuery;
  });
  Json json = {{"schema", "vpr.comparison/1"},
               {"query", named == reports.end() ? kUnnamedQuery : named->query}};
  json["reports"] = Json::array();
  for (size_t m = 0; m < reports.size(); ++m) {
    json["reports"].push_back({{"name", names[m]},
                               {"method", reports[m].method},
                               {"ground_truth", reports[m].ground_truth},
                               {"queries", comparison.own[m]},
                               {"fingerprint", reports[m].fingerprint}});
    if (reports[m].ground_truth_fingerprint)
      json["reports"].back()["ground_truth_fingerprint"] = *reports[m].ground_truth_fingerprint;
  }
  json["ground_truths"] = enum_name(compare_ground_truths(reports));
  json["queries"] = {{"common", comparison.common},
                     {"with_match", comparison.judged},
                     {"disputed", comparison.disputed}};
  json["bootstrap"] = {{"block", comparison.block}, {"resamples", resamples}, {"confidence", 0.95}};
  json["metrics"] = Json::array();
  for (const ComparedValue& value : comparison.values)
    json["metrics"].push_back({{"metric", value.metric},
                               {"report", names[value.method]},
                               {"value", or_null(value.value)},
                               {"difference", or_null(value.difference)},
                               {"low", value.interval ? Json(value.interval->low) : Json()},
                               {"high", value.interval ? Json(value.interval->high) : Json()}});
  json["paired"] = Json::array();
  for (size_t m = 1; m < reports.size(); ++m)
    json["paired"].push_back({{"report", names[m]},
                              {"both_right", comparison.paired[m].both_right},
                              {"only_this", comparison.paired[m].only_this},
                              {"only_first", comparison.paired[m].only_first},
                              {"neither", comparison.paired[m].neither}});
  json["protocol"] = {
      {"queries",
       "query frames that all reports judge (neither unreadable nor ignored, and within reach of "
       "every report's windows)"},
      {"disputed", "query frames left out, of which only some ground truths have a match"},
      {"metrics", "of best matches; those of queries without a match are incorrect where accepted"},
      {"interval",
       "central 95 % of the difference to the first report under the circular block bootstrap, "
       "the same blocks of neighbouring queries for all reports"}};
  json["provenance"] = provenance_json(run);
  return json;
}

Table comparison_table(const Json& comparison) {
  Table table;
  table.title = fmt::format(
      "{}: differences to {} over {} ({} with a match), 95 % by blocks of {}",
      comparison["query"].get<std::string>(), comparison["reports"][0]["name"].get<std::string>(),
      counted(comparison["queries"]["common"].get<uint64_t>(), "common query", "common queries"),
      comparison["queries"]["with_match"].dump(), comparison["bootstrap"]["block"].dump());
  const std::string ground_truths = comparison["ground_truths"].get<std::string>();
  if (ground_truths != "same") table.title += fmt::format("; ground truths: {}", ground_truths);
  table.columns = {"metric", "of", "value", "difference", "from", "to", "", "ground truths"};
  for (const Json& row : comparison["metrics"])
    table.rows.push_back(
        {row["metric"].get<std::string>(), row["report"].get<std::string>(),
         row["value"].is_null() ? "-" : fmt::format("{:.4f}", row["value"].get<double>()),
         signed_number(row["difference"]), signed_number(row["low"]), signed_number(row["high"]),
         judgement_of(row), ground_truths});
  if (ground_truths == "same") {
    table.columns.pop_back();
    for (auto& row : table.rows) row.pop_back();
  }
  return table;
}

Table paired_table(const Json& comparison) {
  Table table;
  table.title = fmt::format("Best matches beside those of {}",
                            comparison["reports"][0]["name"].get<std::string>());
  table.columns = {"of", "both right", "only this", "only the first", "neither"};
  for (const Json& row : comparison["paired"])
    table.rows.push_back({row["report"].get<std::string>(), row["both_right"].dump(),
                          row["only_this"].dump(), row["only_first"].dump(),
                          row["neither"].dump()});
  return table;
}

}  // namespace vpr
