#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "base/json.h"
#include "base/json_schema.h"
#include "base/text.h"
#include "evaluate/report.h"
#include "evaluate/report_fields.h"
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
bool read_number_words(const std::optional<std::string>& text, const char* key,
                       const Fields& fields, Outcomes& outcomes, const Set& set) {
  if (!text) return false;
  const auto words = text->empty() ? std::vector<std::string_view>() : split(*text, ' ');
  if (words.size() != outcomes.queries.size()) fields.fail("its outcomes do not fit each other");
  for (size_t q = 0; q < words.size(); ++q) {
    if (words[q] == "-") continue;
    const auto number = parse_number<T>(words[q]);
    if (!number) fields.fail(fmt::format("one of its {} is not a number", key));
    set(outcomes.queries[q], *number);
  }
  return true;
}

/// A letter and numbers per query window, and a letter per frame.
struct OutcomeTexts {
  ScoreOrder score_order = {};
  std::string best;
  std::optional<std::string> scores;
  std::optional<std::string> margins;
  std::optional<uint64_t> known_ranks;
  std::optional<std::string> ranks;
  std::string recognized;
};

template <class Visitor>
void visit_fields(OutcomeTexts& texts, Visitor&& visit) {
  visit("score_order", texts.score_order, "Direction of the scores.");
  visit("best", texts.best,
        "Verdict on the best match, one letter per frame: c correct, w incorrect, i ignored, u no "
        "answer; capital: without a match in the ground truth.",
        Matches{"^[cwiuWIU]*$"});
  visit("scores", IfSet{texts.scores}, "Score of the best match, - if none.");
  visit("margins", IfSet{texts.margins}, "Margin of the best match, - if none.");
  visit("known_ranks", IfSet{texts.known_ranks},
        "Largest K for which the K best references are known; absent: all.");
  visit("ranks", IfSet{texts.ranks}, "Rank of the first correct one, - if none.");
  visit("recognized", texts.recognized,
        "One letter per frame: its recognition is correct (r), incorrect (w), ignored (i) or "
        "missing (.).",
        Matches{"^[rwi.]*$"});
}

OutcomeTexts texts_of(const Outcomes& outcomes, const std::vector<Verdict>& verdicts) {
  OutcomeTexts texts{outcomes.kind, outcome_letters(outcomes), {}, {}, {}, {}, {}};
  if (outcomes.has_scores)
    texts.scores = number_words(outcomes, [&](const QueryOutcome& query) {
      return query.key == kNoScore ? std::nullopt
                                   : std::optional(score_of_key(query.key, outcomes.kind));
    });
  if (outcomes.has_margins)
    texts.margins = number_words(outcomes, [](const QueryOutcome& query) { return query.margin; });
  if (outcomes.known_ranks < kMostFrames) texts.known_ranks = outcomes.known_ranks;
  if (outcomes.has_ranks)
    texts.ranks = number_words(outcomes, [](const QueryOutcome& query) { return query.rank; });
  for (const Verdict verdict : verdicts)
    texts.recognized += kVerdictLetters[static_cast<size_t>(verdict)];
  return texts;
}

void read_outcomes(const Fields& fields, const OutcomeTexts& texts, Outcomes& outcomes,
                   std::vector<Verdict>& verdicts) {
  outcomes.kind = texts.score_order;
  for (const char letter : texts.best) {
    const auto found = std::ranges::find(kOutcomeLetters, letter, &OutcomeLetter::letter);
    if (found == kOutcomeLetters.end()) fields.fail("an outcome is invalid");
    QueryOutcome& query = outcomes.queries.emplace_back();
    query.frame = outcomes.queries.size() - 1;
    query.verdict = found->verdict;
    query.has_match = found->has_match;
  }
  outcomes.has_scores = read_number_words<double>(
      texts.scores, "scores", fields, outcomes,
      [&](QueryOutcome& query, double score) { query.key = score_key(score, outcomes.kind); });
  outcomes.known_ranks = texts.known_ranks.value_or(outcomes.known_ranks);
  outcomes.has_margins =
      read_number_words<double>(texts.margins, "margins", fields, outcomes,
                                [](QueryOutcome& query, double margin) { query.margin = margin; });
  outcomes.has_ranks =
      read_number_words<size_t>(texts.ranks, "ranks", fields, outcomes,
                                [](QueryOutcome& query, size_t rank) { query.rank = rank; });
  for (const char letter : texts.recognized) {
    const size_t verdict = kVerdictLetters.find(letter);
    if (verdict == std::string_view::npos) fields.fail("its verdicts do not fit its outcomes");
    verdicts.push_back(static_cast<Verdict>(verdict));
  }
  if (verdicts.size() != outcomes.queries.size())
    fields.fail("its verdicts do not fit its outcomes");
}

}  // namespace

VPR_FIELDS(KeyframeCounts, (correct, "All correct."), (incorrect, "All incorrect."),
           (mixed, "Some correct."), (ignored, "All ignored."))

template <class Visitor>
void visit_fields(CountsByKeyframe& counts, Visitor&& visit) {
  visit("query_keyframes", counts.query_keyframes, "Query keyframes.");
  visit("train_keyframes", counts.train_keyframes, "Training keyframes.");
  visit("recognitions", counts.recognitions,
        "Pairs of a query keyframe and a training keyframe that have recognitions.");
  visit("best_match", NestedObject{[&](auto& inner) {
          visit_fields(counts.best_match, inner);
          inner("rate", counts.best_match_rate, "Mean share of correct ones.");
          inner("recall_at_100_precision", IfSet{counts.recall_at_full_precision},
                "Largest share of query keyframes at which no best match of a keyframe is "
                "incorrect.",
                at_least(0));
        }},
        "Query keyframes with frames that have a match.");
}

template <class Visitor>
void visit_fields(Estimate& estimate, Visitor&& visit) {
  visit("frames", estimate.frames, "Frames of the sample.", at_least(1));
  visit("rate", estimate.rate, "Share of correct best matches.", at_least(0));
  visit("low", estimate.interval.low, "Lower end of its 95 % interval (Wilson).", at_least(0));
  visit("high", estimate.interval.high, "Upper end.", at_least(0));
}

VPR_FIELDS(ReportedCluster, (sequence, "Name of the training sequence."),
           (query, "Query frame: the anchor of the mean of a place, or the middle of a path."),
           (query_range, "Query frames: the anchors of the first and last window."),
           (train, "Training frame: the anchor of the mean of a place, or the middle of a path."),
           (train_range, "Training frames: the anchors of the first and last window."),
           (label, "Label of the pair."), (recognitions, "Recognitions of the place."))

template <class T, class Visitor>
void visit_fields(ByAcceptance<T>& all, Visitor&& visit) {
  visit("single_best", all.single_best, "Metrics or curve of best matches.");
  visit("by_margin", IfSet{all.by_margin},
        "The same of best matches, accepted by margin; absent if confidence is margin.");
  visit("by_score", IfSet{all.by_score},
        "The same of best matches, accepted by score; only if confidence is margin.");
  visit("all_pairs", IfSet{all.all_pairs}, "The same of all pairs of a matrix.");
}

VPR_FIELDS(ReportedAchievement,
           (stretch_frames, "Nominal length of a stretch, in frames.", at_least(1)),
           (stretches, "Judged stretches."), (reached, "By target."))

template <class Visitor>
void visit_fields(ReportedMetrics& metrics, Visitor&& visit) {
  visit_fields(metrics.curves, visit);
  for (size_t m = 0; m < metrics.ranks.size(); ++m)
    if (!rank_metrics()[m].needs_all_ranks)
      visit(rank_metrics()[m].key, metrics.ranks[m], rank_metrics()[m].meaning);
  visit("recall_achievement", metrics.recall_achievement,
        "Share of stretches of the path whose recall@1 reaches a target.", kMayBeMissing);
  for (size_t m = 0; m < metrics.ranks.size(); ++m)
    if (rank_metrics()[m].needs_all_ranks)
      visit(rank_metrics()[m].key, Unless{metrics.ranks[m], RankValues{}},
            rank_metrics()[m].meaning);
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
  visit("result", IfSet{sources.result}, "Checksum of a result.", kIsChecksum);
  visit("scores", IfSet{sources.scores}, "Checksum of scores.", kIsChecksum);
  if (judge == JudgedBy::ground_truth)
    visit(
        "ground_truth", sources.ground_truth,
        "Checksum of the labels of all pairs, tolerance applied; only equal ones can be compared.",
        kIsChecksum, kMayBeMissing);
}

template <class Visitor>
void visit_fields(ScoreSettings& settings, Visitor&& visit) {
  visit("method", settings.method, "Matching method.");
  visit("scores",
        CustomField{[&](Json& json, const std::string& key) {
                      json[key] = enum_name(order_of(settings.format));
                    },
                    [&](const Fields& fields, const std::string& key) {
                      ScoreOrder order{};
                      fields.read(key, order);
                      settings.format.is_similarity = order == ScoreOrder::similarity;
                    }},
        "Direction of the scores.", kAs<ScoreOrder>);
  visit("train_first", settings.format.train_first, "Rows are references.");
  visit("missing", settings.format.missing, "Value of missing scores.");
  visit("window", settings.window_length, "Frames per window.", at_least(1));
  visit("threshold", settings.threshold,
        "Best matches with this score are recognitions; null: the threshold of recall at 100 % "
        "precision.");
}

template <class Visitor>
void visit_subject(Report& report, Visitor&& visit) {
  visit("schema", Derived{schema_name("report")});
  visit("method", report.method, "Judged method, or name of the score matrix.");
  visit("query", report.query, "Name of the query.");
  visit_fields(report.selection, visit);
  visit("settings",
        CustomField{[&](Json& json, const std::string& key) {
                      const QuerySettings* of_query = report.query_settings();
                      json[key] =
                          of_query != nullptr
                              ? settings_in_force(*of_query)
                              : value_to_json(std::get<ScoreSettings>(report.settings), kDataForm);
                    },
                    [&](const Fields& fields, const std::string& key) {
                      if (fields.object(key).has("scores"))
                        fields.read(key, report.settings.emplace<ScoreSettings>());
                      else
                        report.settings = read_query_settings(fields);
                    }},
        "Settings that can change the numbers; keys are the names of flags.",
        kAs<InForce<SequenceKeys>, InForce<FabmapQuerySettings>, ScoreSettings>);
}

template <class Visitor>
void visit_fields(Report& report, Visitor&& visit) {
  visit_subject(report, visit);
  if (report.query_settings() != nullptr)
    visit("counts", NestedObject{[&](auto&& inner) {
            visit_metrics(report.counts, &Metric::of_counts, report.frames.by, inner);
          }},
          "Counts of matches and places by ground truth.", kMayBeMissing);
  const bool has_truth = report.frames.by == JudgedBy::ground_truth;
  if (has_truth)
    visit("best_match", report.counts.best_match,
          "Query frames by the verdict on their best match, whatever its score.", kMayBeMissing);
  visit("estimate", IfSet{report.estimate},
        "Share of correct best matches, by labels of a sample of the query's frames.");
  visit("by_keyframe", IfSet{report.by_keyframe},
        "Counts by keyframe: consecutive similar frames count once, so that a stop is one "
        "observation. Absent for FAB-MAP and for results without keyframes.");
  visit("clusters", IfSet{report.recognitions},
        "Places of a sequence result, in its order, with their recognitions.");
  if (has_truth)
    visit("metrics", report.metrics, "Metrics, as in docs/reference/metrics.md.", kMayBeMissing);
  visit("localization", NestedObject{[&](auto&& inner) {
          visit_metrics(report.frames.localization, &Metric::of_path, report.frames.by, inner);
        }},
        "Query frames by their best accepted match, and gaps.");
  if (has_truth)
    visit("confidence", Unless{report.frames.outcomes.confidence, Confidence::score},
          "Acceptance of best matches, if not by score.");
  visit("oracle", Unless{report.frames.is_oracle, false},
        "The threshold of recognitions was chosen from the ground truth (scores without "
        "--threshold).");
  if (has_truth)
    visit("curves", report.curves, "Precision-recall curves, of up to 100 points.", kMayBeMissing);
  Outcomes& outcomes = report.frames.outcomes;
  std::vector<Verdict>& verdicts = report.frames.verdicts;
  visit("outcomes",
        CustomField{[&](Json& json, const std::string& key) {
                      json[key] = value_to_json(texts_of(outcomes, verdicts), kDataForm);
                    },
                    [&](const Fields& fields, const std::string& key) {
                      OutcomeTexts texts;
                      fields.read(key, texts);
                      read_outcomes(fields, texts, outcomes, verdicts);
                    }},
        "One letter, score and rank per query frame; - where there is none.", kAs<OutcomeTexts>);
  visit("protocol", NestedObject{[&](auto&& inner) {
          visit_protocol(report.protocol, report.frames.by, inner);
        }},
        "Definition of the counts, in words.", kAs<Json>);
  visit("provenance", NestedObject{[&](auto&& inner) {
          visit_sources(report.provenance, report.frames.by, inner);
        }},
        kProvenanceText);
  visit("name", IfSet{report.name}, "Name of the result (--name).");
  visit("data_set", IfSet{report.data_set}, "Name of the data set (--data-set).");
  visit("judged", Unless{report.frames.by, JudgedBy::ground_truth},
        "Source of verdicts, if not a ground truth: answers to places, or nothing. Numbers that it "
        "does not determine are absent.");
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

namespace {

/// A report in a file of several.
struct NamedReport {
  std::string name;
  Json report;
};
VPR_FIELDS(NamedReport, (name, "Name of the result (--name)."),
           (report, "Report without machine and timing.", kAs<Report>))

struct ReportsFile {
  std::vector<NamedReport> reports;
};
VPR_FILE(ReportsFile, "reports", (reports, "In the order in which the results were given."))

}  // namespace

Json report_schema() {
  Json schema = with_run(schema_of<Report>());
  schema["oneOf"] = {{{"required", {"judged"}}},
                     {{"required", {"best_match", "metrics", "curves"}}}};
  schema["properties"]["provenance"]["oneOf"] = {{{"required", {"result"}}},
                                                 {{"required", {"scores"}}}};
  return schema;
}

Json reports_schema() { return with_run(schema_of<ReportsFile>()); }

Json reports_json(std::span<const Report> reports, const RunInfo& run, double seconds) {
  ReportsFile file;
  for (const Report& report : reports)
    file.reports.push_back({report.row_name, report_json(report)});
  Json json = value_to_json(file, kDataForm);
  add_run(json, run, {{"evaluate", seconds}});
  return json;
}

}  // namespace vpr
