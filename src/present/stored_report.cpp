#include "present/stored_report.h"

#include <array>
#include <charconv>
#include <limits>
#include <map>
#include <string_view>

#include <fmt/format.h>

#include "base/error.h"
#include "base/json.h"
#include "base/text.h"
#include "decide/score_kind.h"
#include "present/json_fields.h"

namespace vpr {
namespace {

constexpr uint64_t kMostFrames = uint64_t{1} << 32;

/// One number, or "-" for none, per query. `damage`: the message for anything else.
template <class T>
std::vector<std::optional<T>> read_numbers(const Fields& part, const std::string& key,
                                           size_t queries, const char* damage) {
  const std::string text = part.text(key);
  const auto words = split_words(text);
  if (words.size() != queries) part.fail("its outcomes do not fit each other");
  std::vector<std::optional<T>> numbers;
  for (const std::string_view word : words) {
    std::optional<T>& number = numbers.emplace_back();
    if (word == "-") continue;
    const char* end = word.data() + word.size();
    const auto [stop, error] = std::from_chars(word.data(), end, number.emplace());
    if (error != std::errc{} || stop != end) part.fail(damage);
  }
  return numbers;
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
  const auto scores = read_numbers<double>(part, "scores", letters.size(), "a score is no number");
  std::vector<std::optional<size_t>> ranks(letters.size());
  outcomes.has_ranks = part.has("ranks");
  if (outcomes.has_ranks)
    ranks = read_numbers<size_t>(part, "ranks", letters.size(), "a rank is no number");
  std::vector<std::optional<double>> margins(letters.size());
  outcomes.has_margins = part.has("margins");
  if (outcomes.has_margins)
    margins = read_numbers<double>(part, "margins", letters.size(), "a margin is not a number");
  if (fields.has("confidence")) outcomes.confidence = Confidence::margin;
  if (outcomes.confidence == Confidence::margin && !outcomes.has_margins)
    fields.fail("its outcomes do not fit each other");
  for (size_t q = 0; q < letters.size(); ++q) {
    QueryOutcome& query = outcomes.queries.emplace_back();
    query.frame = first + q;
    set_verdict(query, letters[q], fields);
    if (scores[q]) query.key = score_key(*scores[q], outcomes.kind);
    query.rank = ranks[q];
    query.margin = margins[q];
  }
  outcomes.query_frames = first + letters.size();
  return outcomes;
}

// What replayed queries add to the words of a ground truth, with their walk behind it.
constexpr std::array<std::string_view, 2> kReplayed = {", query replayed ", ", query thinned "};

std::string words_of_recording(const StoredReport& report) {
  std::string words = report.ground_truth;
  if (report.walk.empty()) return words;
  for (const std::string_view replayed : kReplayed) words = words.substr(0, words.find(replayed));
  return words;
}

void read_walk(StoredReport& report, const Fields& fields) {
  if (fields.has("thinned"))
    report.walk = fmt::format("{} frames a second", read_fps(fields.object("thinned")));
  if (!fields.has("warp")) return;
  if (!report.walk.empty()) report.walk += ", ";
  const Fields warp = fields.object("warp");
  report.walk += fmt::format("replayed: {}, seed {}", warp.text("name"),
                             warp.count("seed", std::numeric_limits<uint64_t>::max()));
}

void read_path(StoredReport& report, const Fields& fields) {
  const Fields path = fields.object("localisation");
  if (path["share"].is_number()) report.share = path["share"].get<double>();
  report.wrong = path.count("wrong", kMostFrames);
  report.longest_gap = path.count("longest_gap_frames", kMostFrames);
  report.is_oracle = fields.has("oracle");
  report.fixes = fields.object("outcomes").text("fixes");
  if (report.fixes.size() != report.outcomes.query_frames ||
      report.fixes.find_first_not_of("rwi.") != std::string::npos)
    fields.fail("its fixes do not fit its outcomes");
}

}  // namespace

StoredReport read_report(const std::filesystem::path& path) {
  const Json json = read_json(path, ErrorKind::data);
  if (json.is_object() && json.value("schema", Json()).is_string() &&
      json["schema"].get<std::string>().starts_with("vpr.result/"))
    throw Error(ErrorKind::usage,
                fmt::format("{0}: is a result, and reports are compared. Make one first: vpr-eval "
                            "{0} --ground-truth ... -o report.json",
                            path.string()));
  return stored_report(json, path.string());
}

StoredReport stored_report(const Json& json, const std::string& where) {
  require_schema(json, "report", where, ErrorKind::data);
  const Fields fields(json, where);
  StoredReport report;
  report.method = fields.text("method");
  report.query = fields.text("query");
  report.ground_truth = fields.object("protocol").text("ground_truth");
  const Fields provenance = fields.object("provenance");
  report.ground_truth_fingerprint = provenance.text("ground_truth");
  if (fields.has("name")) report.name = fields.text("name");
  report.has_places =
      fields.object("settings").has(std::string(probability_kind().threshold_symbol));
  report.fingerprint = provenance.text(provenance.has("result") ? "result" : "scores");
  report.outcomes = read_outcomes(fields);
  read_walk(report, fields);
  read_path(report, fields);
  return report;
}

bool is_same_walk(const StoredReport& a, const StoredReport& b) { return a.walk == b.walk; }

GroundTruths compare_ground_truths(const std::vector<StoredReport>& reports) {
  std::map<bool, std::string> of_kind;  // places or frames
  for (const StoredReport& report : reports) {
    if (!is_same_walk(report, reports.front())) {
      // Labels of other frames have another fingerprint: only the words can be compared.
      if (words_of_recording(report) != words_of_recording(reports.front()))
        return GroundTruths::different;
      continue;
    }
    const std::string& fingerprint = report.ground_truth_fingerprint;
    if (of_kind.emplace(report.has_places, fingerprint).first->second != fingerprint)
      return GroundTruths::different;
  }
  const bool agree = of_kind.size() < 2 || of_kind[true] == of_kind[false];
  return agree ? GroundTruths::same : GroundTruths::of_places_and_frames;
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

}  // namespace vpr
