#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "base/json.h"
#include "base/text.h"
#include "evaluate/report.h"
#include "query/result_file.h"
#include "recordings/sequence_json.h"

namespace vpr {
namespace {

constexpr uint64_t kMostFrames = uint64_t{1} << 32;
constexpr std::string_view kVerdictLetters = "rwi.";  // by Verdict

/// A letter for each outcome: capital letters for frames without a match in the ground truth.
struct OutcomeLetter {
  char letter = 'u';
  Verdict verdict = Verdict::none;
  bool has_match = false;
};
constexpr std::array<OutcomeLetter, 7> kOutcomeLetters = {{{'c', Verdict::correct, true},
                                                           {'w', Verdict::incorrect, true},
                                                           {'i', Verdict::ignored, true},
                                                           {'u', Verdict::none, true},
                                                           {'W', Verdict::incorrect, false},
                                                           {'I', Verdict::ignored, false},
                                                           {'U', Verdict::none, false}}};

/// A number or "-" per query.
template <class Number>
std::string number_words(const Outcomes& outcomes, const Number& number_of) {
  std::vector<std::string> words;
  for (const QueryOutcome& query : outcomes.queries) {
    const auto number = number_of(query);
    words.push_back(number ? fmt::format("{}", *number) : "-");
  }
  return fmt::format("{}", fmt::join(words, " "));
}

template <class T, class Set>
void read_number_words(const Fields& fields, const std::string& key, Outcomes& outcomes,
                       const Set& set) {
  const std::string text = fields.text(key);
  const auto words = text.empty() ? std::vector<std::string_view>() : split(text, ' ');
  if (words.size() != outcomes.queries.size()) fields.fail("its outcomes do not fit each other");
  for (size_t q = 0; q < words.size(); ++q) {
    if (words[q] == "-") continue;
    const auto number = parse_number<T>(words[q]);
    if (!number) fields.fail(fmt::format("one of its {} is not a number", key));
    set(outcomes.queries[q], *number);
  }
}

/// A letter and numbers per query window, and a letter per frame.
struct OutcomesForm {
  Outcomes& outcomes;
  std::vector<Verdict>& verdicts;

  void write(Json& json, const std::string& key, const JsonForm&) const {
    Json& part = json[key];
    part = {{"score_order", enum_name(outcomes.kind)}, {"best", outcome_letters(outcomes)}};
    if (outcomes.has_scores)
      part["scores"] = number_words(outcomes, [&](const QueryOutcome& query) {
        return query.key == kNoScore ? std::nullopt
                                     : std::optional(score_of_key(query.key, outcomes.kind));
      });
    if (outcomes.has_margins)
      part["margins"] =
          number_words(outcomes, [](const QueryOutcome& query) { return query.margin; });
    if (outcomes.known_ranks < kMostFrames) part["known_ranks"] = outcomes.known_ranks;
    if (outcomes.has_ranks)
      part["ranks"] = number_words(outcomes, [](const QueryOutcome& query) { return query.rank; });
    std::string letters;
    for (const Verdict verdict : verdicts) letters += kVerdictLetters[static_cast<size_t>(verdict)];
    part["recognized"] = letters;
  }

  void read(const Fields& fields, const std::string& key) {
    const Fields part = fields.object(key);
    part.read("score_order", outcomes.kind);
    for (const char letter : part.text("best")) {
      const auto found = std::ranges::find(kOutcomeLetters, letter, &OutcomeLetter::letter);
      if (found == kOutcomeLetters.end()) part.fail("an outcome is invalid");
      QueryOutcome& query = outcomes.queries.emplace_back();
      query.frame = outcomes.queries.size() - 1;
      query.verdict = found->verdict;
      query.has_match = found->has_match;
    }
    outcomes.has_scores = part.has("scores");
    if (outcomes.has_scores)
      read_number_words<double>(part, "scores", outcomes, [&](QueryOutcome& query, double score) {
        query.key = score_key(score, outcomes.kind);
      });
    if (part.has("known_ranks")) outcomes.known_ranks = part.count("known_ranks", kMostFrames);
    outcomes.has_margins = part.has("margins");
    if (outcomes.has_margins)
      read_number_words<double>(part, "margins", outcomes,
                                [](QueryOutcome& query, double margin) { query.margin = margin; });
    outcomes.has_ranks = part.has("ranks");
    if (outcomes.has_ranks)
      read_number_words<size_t>(part, "ranks", outcomes,
                                [](QueryOutcome& query, size_t rank) { query.rank = rank; });
    for (const char letter : part.text("recognized")) {
      const size_t verdict = kVerdictLetters.find(letter);
      if (verdict == std::string_view::npos) part.fail("its verdicts do not fit its outcomes");
      verdicts.push_back(static_cast<Verdict>(verdict));
    }
    if (verdicts.size() != outcomes.queries.size())
      part.fail("its verdicts do not fit its outcomes");
  }
};

}  // namespace

VPR_FIELDS(LabelCounts, correct, incorrect, ignored)

/// The rows of the table of metrics that a struct has, if the source of verdicts determines them.
template <class S, class Visitor>
void visit_metrics(S& from, std::optional<ValueOf<S>> Metric::*of, JudgedBy judge,
                   Visitor&& visit) {
  for (const Metric& metric : metrics()) {
    if (!(metric.*of) || judge > metric.needs) continue;
    const std::string_view key = metric.key.substr(metric.key.find('.') + 1);
    const auto visit_member = [&](auto member) {
      if constexpr (std::is_member_function_pointer_v<decltype(member)>)
        visit(key, Derived{(from.*member)()});
      else if constexpr (std::is_same_v<S, Counts> &&
                         detail::kIsOptional<std::remove_cvref_t<decltype(from.*member)>>)
        visit(key, IfSet{from.*member});  // a result without places
      else
        visit(key, from.*member);
    };
    std::visit(visit_member, *(metric.*of));
  }
}
template <class Visitor>
void visit_fields(Counts& counts, Visitor&& visit) {
  visit_metrics(counts, &Metric::of_counts, JudgedBy::ground_truth, visit);
}
template <class Visitor>
void visit_fields(BestMatchCounts& counts, Visitor&& visit) {
  visit_metrics(counts, &Metric::of_best_match, JudgedBy::ground_truth, visit);
}

VPR_FIELDS(KeyframeCounts, correct, incorrect, mixed, ignored)

template <class Visitor>
void visit_fields(CountsByKeyframe& counts, Visitor&& visit) {
  visit("query_keyframes", counts.query_keyframes);
  visit("train_keyframes", counts.train_keyframes);
  visit("recognitions", counts.recognitions);
  visit("best_match", NestedObject{[&](auto& inner) {
          visit_fields(counts.best_match, inner);
          inner("rate", counts.best_match_rate);
          inner("recall_at_100_precision", IfSet{counts.recall_at_full_precision});
        }});
}

template <class Visitor>
void visit_fields(Estimate& estimate, Visitor&& visit) {
  visit("frames", estimate.frames);
  visit("rate", estimate.rate);
  visit("low", estimate.interval.low);
  visit("high", estimate.interval.high);
}

VPR_FIELDS(ReportedCluster, sequence, query, query_range, train, train_range, label, recognitions)

template <class Visitor>
void visit_fields(CurveNumbers& numbers, Visitor&& visit) {
  visit("positives", numbers.positives);
  for (size_t m = 0; m < numbers.values.size(); ++m)
    visit(curve_metrics()[m].key, numbers.values[m].value);
  visit("thresholds", NestedObject{[&](auto& inner) {
          for (size_t m = 0; m < numbers.values.size(); ++m)
            inner(curve_metrics()[m].key, IfSet{numbers.values[m].threshold});
        }});
  visit("tied_queries", IfSet{numbers.tied_queries});
  visit("same_without_score", IfSet{numbers.same_without_score});
  visit("ignored", IfSet{numbers.ignored});
}

VPR_FIELDS(ReportedPoint, threshold, correct, incorrect)

VPR_FIELDS(ReportedCurve, thresholds, points)

template <class T, class Visitor>
void visit_fields(ByAcceptance<T>& all, Visitor&& visit) {
  visit("single_best", all.single_best);
  visit("by_margin", IfSet{all.by_margin});
  visit("by_score", IfSet{all.by_score});
  visit("all_pairs", IfSet{all.all_pairs});
}

VPR_FIELDS(ReportedAchievement, stretch_frames, stretches, reached)

template <class Visitor>
void visit_fields(ReportedMetrics& metrics, Visitor&& visit) {
  visit_fields(metrics.curves, visit);
  for (size_t m = 0; m < metrics.ranks.size(); ++m)
    if (!rank_metrics()[m].needs_all_ranks) visit(rank_metrics()[m].key, metrics.ranks[m]);
  visit("recall_achievement", metrics.recall_achievement);
  for (size_t m = 0; m < metrics.ranks.size(); ++m)
    if (rank_metrics()[m].needs_all_ranks)
      visit(rank_metrics()[m].key, Unless{metrics.ranks[m], RankValues{}});
}

template <class Visitor>
void visit_protocol(Protocol& protocol, JudgedBy judge, Visitor&& visit) {
  visit("ground_truth", protocol.ground_truth);
  if (judge == JudgedBy::ground_truth) visit("tolerance_frames", protocol.tolerance_frames);
  visit("", CustomField{[&](Json& json, const std::string&) {
                          for (const auto& [key, words] : protocol.definitions) json[key] = words;
                        },
                        [&](const Fields& fields, const std::string&) {
                          for (const auto& item : fields.json().items())
                            if (item.key() != "ground_truth" && item.key() != "tolerance_frames")
                              protocol.definitions.emplace_back(item.key(),
                                                                fields.text(item.key()));
                        }});
}

template <class Visitor>
void visit_sources(ReportSources& sources, JudgedBy judge, Visitor&& visit) {
  visit_fields(sources.made_by, visit);
  visit("result", IfSet{sources.result});
  visit("scores", IfSet{sources.scores});
  if (judge == JudgedBy::ground_truth) visit("ground_truth", sources.ground_truth);
}

template <class Visitor>
void visit_fields(ScoreSettings& settings, Visitor&& visit) {
  visit("method", settings.method);
  visit("scores", CustomField{[&](Json& json, const std::string& key) {
                                json[key] = enum_name(order_of(settings.format));
                              },
                              [&](const Fields& fields, const std::string& key) {
                                ScoreOrder order{};
                                fields.read(key, order);
                                settings.format.is_similarity = order == ScoreOrder::similarity;
                              }});
  visit("train_first", settings.format.train_first);
  visit("missing", settings.format.missing);
  visit("window", settings.window_length);
  visit("threshold", settings.threshold);
}

template <class Visitor>
void visit_fields(Report& report, Visitor&& visit) {
  visit("schema", Derived{schema_name("report")});
  visit("method", report.method);
  visit("query", report.query);
  visit_fields(report.selection, visit);
  visit("settings", CustomField{[&](Json& json, const std::string& key) {
                                  const QuerySettings* of_query = report.query_settings();
                                  json[key] =
                                      of_query != nullptr
                                          ? settings_in_force(*of_query)
                                          : value_to_json(std::get<ScoreSettings>(report.settings),
                                                          kDataForm);
                                },
                                [&](const Fields& fields, const std::string& key) {
                                  if (fields.object(key).has("scores"))
                                    fields.read(key, report.settings.emplace<ScoreSettings>());
                                  else
                                    report.settings = read_query_settings(fields);
                                }});
  if (report.query_settings() != nullptr)
    visit("counts", NestedObject{[&](auto&& inner) {
            visit_metrics(report.counts, &Metric::of_counts, report.frames.by, inner);
          }});
  const bool has_truth = report.frames.by == JudgedBy::ground_truth;
  if (has_truth) visit("best_match", report.counts.best_match);
  visit("estimate", IfSet{report.estimate});
  visit("by_keyframe", IfSet{report.by_keyframe});
  visit("clusters", IfSet{report.recognitions});
  if (has_truth) visit("metrics", report.metrics);
  visit("localization", NestedObject{[&](auto&& inner) {
          visit_metrics(report.frames.localization, &Metric::of_path, report.frames.by, inner);
        }});
  if (has_truth) visit("confidence", Unless{report.frames.outcomes.confidence, Confidence::score});
  visit("oracle", Unless{report.frames.is_oracle, false});
  if (has_truth) visit("curves", report.curves);
  visit("outcomes", OutcomesForm{report.frames.outcomes, report.frames.verdicts});
  visit("protocol", NestedObject{[&](auto&& inner) {
          visit_protocol(report.protocol, report.frames.by, inner);
        }});
  visit("provenance", NestedObject{[&](auto&& inner) {
          visit_sources(report.provenance, report.frames.by, inner);
        }});
  visit("name", IfSet{report.name});
  visit("data_set", IfSet{report.data_set});
  visit("judged", Unless{report.frames.by, JudgedBy::ground_truth});
}

Json report_json(const Report& report) { return value_to_json(report, kDataForm); }

Json report_json(const Report& report, const RunInfo& run, double seconds) {
  Json json = report_json(report);
  add_run(json, run, {{"evaluate", seconds}});
  return json;
}

Report parse_report(const Json& json, const std::string& where) {
  require_schema(json, "report", where, ErrorKind::data);
  if (json.contains("judged"))
    throw Error(ErrorKind::usage,
                "{}: is a report without ground truth, which has no metrics to compare. Evaluate "
                "its result again with --ground-truth",
                where);
  const Fields fields(json, where);
  Report report;
  value_from_json(json, report, fields.source(), "report");
  Outcomes& outcomes = report.frames.outcomes;
  const QuerySettings* of_query = report.query_settings();
  outcomes.window_length = of_query != nullptr
                               ? window_length_of(*of_query)
                               : std::get<ScoreSettings>(report.settings).window_length;
  if (report.selection.recorded_frames > kMostFrames ||
      !std::isfinite(report.selection.selected_fps))
    fields.fail("its selection is out of range");
  if (outcomes.confidence == Confidence::margin && !outcomes.has_margins)
    fields.fail("its outcomes do not fit each other");
  if (!report.provenance.result && !report.provenance.scores) fields.fail("\"scores\" is missing");
  return report;
}

std::string outcome_letters(const Outcomes& outcomes) {
  std::string letters;
  for (const QueryOutcome& query : outcomes.queries)
    letters += std::ranges::find_if(kOutcomeLetters, [&](const OutcomeLetter& one) {
                 return one.verdict == query.verdict &&
                        (one.has_match == query.has_match || one.verdict == Verdict::correct);
               })->letter;
  return letters;
}

Json curve_numbers_json(const Curve& curve) { return value_to_json(numbers_of(curve), kDataForm); }

Json curve_json(const Curve& curve) { return value_to_json(reported_curve(curve), kDataForm); }

Json counts_json(const Counts& counts) { return value_to_json(counts, kDataForm); }

Json reports_json(std::span<const Report> reports, const RunInfo& run, double seconds) {
  Json json = {{"schema", schema_name("reports")}, {"reports", Json::array()}};
  for (const Report& report : reports)
    json["reports"].push_back({{"name", report.row_name}, {"report", report_json(report)}});
  add_run(json, run, {{"evaluate", seconds}});
  return json;
}

}  // namespace vpr
