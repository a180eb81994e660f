// Evaluation reports as JSON: one description of the fields, by which they are written and read.
#include <charconv>

#include <fmt/format.h>

#include "base/error.h"
#include "base/json.h"
#include "base/json_fields.h"
#include "base/text.h"
#include "present/evaluation_report.h"

namespace vpr {
namespace {

constexpr uint64_t kMostFrames = uint64_t{1} << 32;

char letter_of(const QueryOutcome& query) {
  switch (query.verdict) {
    case Verdict::correct:
      return 'c';
    case Verdict::incorrect:
      return query.has_match ? 'w' : query.is_unreachable ? 'b' : 'n';
    case Verdict::ignored:
      return 'i';
    case Verdict::unreadable:
      return 'u';
  }
  return 'u';
}

void set_verdict(QueryOutcome& query, char letter, const Fields& fields) {
  constexpr std::string_view kLetters = "cwnbiu";
  if (kLetters.find(letter) == std::string_view::npos) fields.fail("an outcome is none");
  query.has_match = letter == 'c' || letter == 'w';
  query.is_unreachable = letter == 'b';
  query.verdict = letter == 'c'   ? Verdict::correct
                  : letter == 'i' ? Verdict::ignored
                  : letter == 'u' ? Verdict::unreadable
                                  : Verdict::incorrect;
}

constexpr std::string_view kFixLetters = ".rwi";  // by Fix

/// A number, or "-" for none, per query.
template <class Number>
std::string number_words(const Outcomes& outcomes, const Number& number_of) {
  std::string text;
  for (const QueryOutcome& query : outcomes.queries) {
    const auto number = number_of(query);
    text += text.empty() ? "" : " ";
    text += number ? fmt::format("{}", *number) : "-";
  }
  return text;
}

template <class T, class Set>
void read_number_words(const Fields& fields, const std::string& key, Outcomes& outcomes,
                       const Set& set) {
  const std::string text = fields.text(key);
  const auto words = split_words(text);
  if (words.size() != outcomes.queries.size()) fields.fail("its outcomes do not fit each other");
  for (size_t q = 0; q < words.size(); ++q) {
    if (words[q] == "-") continue;
    T number{};
    const char* end = words[q].data() + words[q].size();
    const auto [stop, error] = std::from_chars(words[q].data(), end, number);
    if (error != std::errc{} || stop != end)
      fields.fail(fmt::format("one of its {} is no number", key));
    set(outcomes.queries[q], number);
  }
}

/// A letter and some numbers per query window, and a letter per frame.
struct OutcomesForm {
  Outcomes& outcomes;
  std::vector<Fix>& fixes;

  void write(Json& json, const std::string& key) const {
    Json& part = json[key];
    part = {{"first_frame", outcomes.window_length - 1},
            {"scores_are", enum_name(outcomes.kind)},
            {"best", outcome_letters(outcomes)}};
    part["scores"] = number_words(outcomes, [&](const QueryOutcome& query) {
      return query.key == kNoScore ? std::nullopt
                                   : std::optional(score_of_key(query.key, outcomes.kind));
    });
    if (outcomes.has_margins)
      part["margins"] =
          number_words(outcomes, [](const QueryOutcome& query) { return query.margin; });
    if (outcomes.has_ranks)
      part["ranks"] = number_words(outcomes, [](const QueryOutcome& query) { return query.rank; });
    std::string letters;
    for (const Fix fix : fixes) letters += kFixLetters[static_cast<size_t>(fix)];
    part["fixes"] = letters;
  }

  void read(const Fields& fields, const std::string& key) {
    const Fields part = fields.object(key);
    const uint64_t first_frame = part.count("first_frame", kMostFrames);
    outcomes.window_length = first_frame + 1;
    fields_from_json(part["scores_are"], outcomes.kind, part, "scores_are");
    for (const char letter : part.text("best")) {
      QueryOutcome& query = outcomes.queries.emplace_back();
      query.frame = first_frame + outcomes.queries.size() - 1;
      set_verdict(query, letter, part);
    }
    outcomes.query_frames = first_frame + outcomes.queries.size();
    read_number_words<double>(part, "scores", outcomes, [&](QueryOutcome& query, double score) {
      query.key = score_key(score, outcomes.kind);
    });
    outcomes.has_margins = part.has("margins");
    if (outcomes.has_margins)
      read_number_words<double>(part, "margins", outcomes,
                                [](QueryOutcome& query, double margin) { query.margin = margin; });
    outcomes.has_ranks = part.has("ranks");
    if (outcomes.has_ranks)
      read_number_words<size_t>(part, "ranks", outcomes,
                                [](QueryOutcome& query, size_t rank) { query.rank = rank; });
    for (const char letter : part.text("fixes")) {
      const size_t fix = kFixLetters.find(letter);
      if (fix == std::string_view::npos) part.fail("its fixes do not fit its outcomes");
      fixes.push_back(static_cast<Fix>(fix));
    }
    if (fixes.size() != outcomes.query_frames) part.fail("its fixes do not fit its outcomes");
  }
};

/// Two integers, as a list.
struct RangeForm {
  std::array<size_t, 2>& range;

  void write(Json& json, const std::string& key) const { json[key] = range; }
  void read(const Fields& fields, const std::string& key) {
    std::vector<size_t> ends;
    fields_from_json(fields[key], ends, fields, key);
    if (ends.size() != 2) fields.fail(fmt::format("\"{}\" is no range", key));
    range = {ends[0], ends[1]};
  }
};

/// "warp" and "thinned".
struct SelectionForm {
  Selection& selection;

  void write(Json& json, const std::string&) const { add_selection(json, selection); }
  void read(const Fields& fields, const std::string&) {
    selection = read_selection(fields, [](const Selection&) { return kMostFrames; });
  }
};

struct SettingsForm {
  Report& report;

  void write(Json& json, const std::string& key) const { json[key] = report.settings_json(); }
  void read(const Fields& fields, const std::string& key);
};

struct DefinitionsForm {
  Protocol& protocol;

  void write(Json& json, const std::string&) const {
    for (const auto& [key, words] : protocol.definitions) json[key] = words;
  }
  void read(const Fields& fields, const std::string&) {
    for (const auto& item : fields.json().items())
      if (item.key() != "ground_truth" && item.key() != "tolerance_frames")
        protocol.definitions.emplace_back(item.key(), fields.text(item.key()));
  }
};

struct CurveThresholds {
  std::vector<MetricValue>& values;
};

template <class Visitor>
void visit_fields(CurveThresholds& thresholds, Visitor&& visit) {
  for (size_t m = 0; m < curve_metrics().size(); ++m)
    visit(curve_metrics()[m].key, IfSet{thresholds.values[m].threshold});
}

struct AchievementTargets {
  ReportedAchievement& achievement;
};

template <class Visitor>
void visit_fields(AchievementTargets& targets, Visitor&& visit) {
  for (size_t t = 0; t < kRecallTargets.size(); ++t)
    visit(fmt::format("{:g}", kRecallTargets[t]), targets.achievement.shares[t]);
}

struct ViewBestMatch {
  CountsByView& counts;
};

template <class Visitor>
void visit_fields(ViewBestMatch& fields, Visitor&& visit) {
  visit_fields(fields.counts.best_match, visit);
  visit("rate", fields.counts.best_match_rate);
}

/// Whether large scores are good, as the name of an order.
struct OrderForm {
  bool& is_similarity;

  void write(Json& json, const std::string& key) const {
    json[key] = enum_name(is_similarity ? ScoreOrder::similarity : ScoreOrder::distance);
  }
  void read(const Fields& fields, const std::string& key) {
    ScoreOrder order{};
    fields_from_json(fields[key], order, fields, key);
    is_similarity = order == ScoreOrder::similarity;
  }
};

}  // namespace

template <class Visitor>
void visit_fields(LabelCounts& counts, Visitor&& visit) {
  visit("correct", counts.correct);
  visit("incorrect", counts.incorrect);
  visit("ignored", counts.ignored);
}

template <class Visitor>
void visit_fields(Counts& counts, Visitor&& visit) {
  visit("recognitions", counts.recognitions);
  visit("places", IfSet{counts.clusters});
  if (counts.clusters) visit("mixed_places", counts.mixed_clusters);
  visit("distinct", counts.distinct);
}

template <class Visitor>
void visit_fields(BestMatchCounts& counts, Visitor&& visit) {
  visit("queries", counts.queries);
  visit("correct", counts.correct);
  visit("ignored", counts.ignored);
  visit("without_match", counts.without_match);
  visit("unreachable", counts.unreachable);
  visit("unreadable", counts.unreadable);
  visit("rate", Derived{counts.rate()});
}

template <class Visitor>
void visit_fields(ViewCounts& counts, Visitor&& visit) {
  visit("correct", counts.correct);
  visit("incorrect", counts.incorrect);
  visit("mixed", counts.mixed);
  visit("ignored", counts.ignored);
}

template <class Visitor>
void visit_fields(CountsByView& counts, Visitor&& visit) {
  visit("query_views", counts.query_views);
  visit("train_views", counts.train_views);
  visit("recognitions", counts.recognitions);
  visit("best_match", ViewBestMatch{counts});
}

template <class Visitor>
void visit_fields(ReportedPlace& place, Visitor&& visit) {
  visit("sequence", place.sequence);
  visit("query", place.query);
  visit("query_range", RangeForm{place.query_range});
  visit("train", place.train);
  visit("train_range", RangeForm{place.train_range});
  visit("label", place.judged.label);
  visit("recognitions", place.judged.recognitions);
}

template <class Visitor>
void visit_fields(CurveNumbers& numbers, Visitor&& visit) {
  visit("to_find", numbers.to_find);
  for (size_t m = 0; m < numbers.values.size(); ++m)
    visit(curve_metrics()[m].key, numbers.values[m].value);
  visit("thresholds", CurveThresholds{numbers.values});
  visit("tied_queries", IfSet{numbers.tied_queries});
  visit("same_without_score", IfSet{numbers.same_without_score});
  visit("ignored", IfSet{numbers.ignored});
}

template <class Visitor>
void visit_fields(ReportedPoint& point, Visitor&& visit) {
  visit("threshold", point.threshold);
  visit("correct", point.correct);
  visit("incorrect", point.incorrect);
}

template <class Visitor>
void visit_fields(ReportedCurve& curve, Visitor&& visit) {
  visit("thresholds", curve.thresholds);
  visit("points", curve.points);
}

template <class T, class Visitor>
void visit_fields(ByAcceptance<T>& all, Visitor&& visit) {
  visit("single_best", all.single_best);
  visit("by_margin", IfSet{all.by_margin});
  visit("by_score", IfSet{all.by_score});
  visit("all_pairs", IfSet{all.all_pairs});
}

template <class Visitor>
void visit_fields(ReportedAchievement& achievement, Visitor&& visit) {
  visit("stretch_frames", achievement.stretch_frames);
  visit("stretches", achievement.stretches);
  visit("targets", AchievementTargets{achievement});
}

template <class Visitor>
void visit_fields(Localization& path, Visitor&& visit) {
  visit("frames", path.frames);
  visit("frames_with_match", path.frames_with_match);
  visit("right", path.right);
  visit("wrong", path.wrong);
  visit("share", Derived{path.share()});
  visit("longest_gap_frames", path.longest_gap_frames);
  visit("longest_gap_m", path.longest_gap_m);
  visit("first_fix_frames", path.first_fix_frames);
  visit("first_fix_m", path.first_fix_m);
}

template <class Visitor>
void visit_fields(ReportedMetrics& metrics, Visitor&& visit) {
  visit_fields(metrics.curves, visit);
  visit("recall_at", metrics.recall_at);
  visit("recall_achievement", metrics.recall_achievement);
  visit("precision_at", IfSet{metrics.precision_at});
  visit("map_at", IfSet{metrics.map_at});
}

template <class Visitor>
void visit_fields(Protocol& protocol, Visitor&& visit) {
  visit("ground_truth", protocol.ground_truth);
  visit("tolerance_frames", protocol.tolerance_frames);
  visit("", DefinitionsForm{protocol});
}

template <class Visitor>
void visit_fields(ReportSources& sources, Visitor&& visit) {
  visit_fields(sources.made_by, visit);
  visit("result", IfSet{sources.result});
  visit("scores", IfSet{sources.scores});
  visit("ground_truth", sources.ground_truth);
}

template <class Visitor>
void visit_fields(ScoreSettings& settings, Visitor&& visit) {
  visit("method", settings.method);
  visit("scores", OrderForm{settings.format.is_similarity});
  visit("references_first", settings.format.references_first);
  visit("missing", settings.format.missing);
  visit("window", settings.window_length);
  visit("threshold", settings.threshold);
}

template <class Visitor>
void visit_fields(Report& report, Visitor&& visit) {
  visit("schema", Derived{std::string("vpr.report/1")});
  visit("method", report.method);
  visit("query", report.query);
  visit("", SelectionForm{report.selection});
  visit("settings", SettingsForm{report});
  if (report.query_settings() != nullptr) visit("counts", report.counts);
  visit("best_match", report.counts.best_match);
  visit("by_view", IfSet{report.by_view});
  visit("recognitions", IfSet{report.recognitions});
  visit("metrics", report.metrics);
  visit("localization", report.localization);
  visit("confidence", Unless{report.outcomes.confidence, Confidence::score});
  visit("oracle", Unless{report.is_oracle, false});
  visit("curves", report.curves);
  visit("outcomes", OutcomesForm{report.outcomes, report.fixes});
  visit("protocol", report.protocol);
  visit("provenance", report.provenance);
  visit("name", IfSet{report.name});
}

namespace {

void SettingsForm::read(const Fields& fields, const std::string& key) {
  const Fields settings = fields.object(key);
  const auto read = [&](auto kind) {
    stored_settings_from_json(fields.json(), kind, fields.where());
    report.settings = QuerySettings(std::move(kind));
  };
  if (settings.has("scores"))
    fields_from_json(settings.json(), report.settings.emplace<ScoreSettings>(), settings, key);
  else if (report.method == FabmapQuerySettings{}.method)
    read(FabmapQuerySettings{});
  else
    read(SequenceQuerySettings{});
}

void add_run(Json& json, const RunInfo& run, double seconds) {
  json["machine"] = machine_json(run);
  json["timing"] = timing_json({{"evaluate", seconds}});
}

}  // namespace

Json Report::settings_json() const {
  const QuerySettings* of_query = query_settings();
  return of_query != nullptr ? settings_in_force(*of_query)
                             : fields_to_json(std::get<ScoreSettings>(settings));
}

Json report_json(const Report& report) { return fields_to_json(report); }

Json report_json(const Report& report, const RunInfo& run, double seconds) {
  Json json = report_json(report);
  add_run(json, run, seconds);
  return json;
}

Report read_report(const std::filesystem::path& path) {
  const Json json = read_json(path, ErrorKind::data);
  if (json.is_object() && json.value("schema", Json()).is_string() &&
      json["schema"].get<std::string>().starts_with("vpr.result/"))
    throw Error(ErrorKind::usage,
                fmt::format("{0}: is a result, and reports are compared. Make one first: vpr-eval "
                            "{0} --ground-truth ... -o report.json",
                            path.string()));
  return parse_report(json, path.string());
}

Report parse_report(const Json& json, const std::string& where) {
  require_schema(json, "report", where, ErrorKind::data);
  const Fields fields(json, where);
  Report report;
  fields_from_json(json, report, fields, "report");
  const Outcomes& outcomes = report.outcomes;
  if (outcomes.confidence == Confidence::margin && !outcomes.has_margins)
    fields.fail("its outcomes do not fit each other");
  if (!report.provenance.result && !report.provenance.scores) fields.fail("\"scores\" is missing");
  return report;
}

std::string outcome_letters(const Outcomes& outcomes) {
  std::string letters;
  for (const QueryOutcome& query : outcomes.queries) letters += letter_of(query);
  return letters;
}

Json curve_numbers_json(const CurveNumbers& numbers) { return fields_to_json(numbers); }

Json curve_json(const ReportedCurve& curve) { return fields_to_json(curve); }

Json counts_json(const Counts& counts) { return fields_to_json(counts); }

Json reports_json(std::span<const Report> reports, const std::vector<std::string>& names,
                  const RunInfo& run, double seconds) {
  Json json = {{"schema", "vpr.reports/1"}, {"reports", Json::array()}};
  for (size_t i = 0; i < reports.size(); ++i)
    json["reports"].push_back({{"name", names[i]}, {"report", report_json(reports[i])}});
  add_run(json, run, seconds);
  return json;
}

Json protocols_json(const std::vector<ProtocolReport>& reports, const RunInfo& run,
                    double seconds) {
  Json json = {{"schema", "vpr.protocols/1"}, {"protocols", Json::array()}};
  for (const auto& [preset, report] : reports)
    json["protocols"].push_back(
        {{"name", preset->name}, {"source", preset->source}, {"report", report_json(report)}});
  add_run(json, run, seconds);
  return json;
}

}  // namespace vpr
