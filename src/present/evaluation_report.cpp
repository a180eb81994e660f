#include "present/evaluation_report.h"

#include <algorithm>
#include <charconv>
#include <limits>

#include <fmt/format.h>

#include "base/error.h"
#include "base/json.h"
#include "base/text.h"
#include "match/match.h"
#include "present/json_fields.h"
#include "truth/check.h"

namespace vpr {
namespace {

constexpr uint64_t kMostFrames = uint64_t{1} << 32;
constexpr size_t kMostPoints = 100;  // of a curve in a report

constexpr const char* kAnchorProtocol = "a window is judged at its last frame";
constexpr const char* kUnreachableProtocol =
    "neither is one whose anchor has matches only where no training window ends";

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

/// One number, or "-" for none, per query; absent where `is_known` is not set.
template <class T>
struct NumberWords {
  Outcomes& outcomes;
  bool& is_known;
  std::optional<T> (*get)(const QueryOutcome& query, ScoreOrder kind);
  void (*set)(QueryOutcome& query, T number, ScoreOrder kind);

  void write(Json& json, const std::string& key) const {
    if (!is_known) return;
    std::string text;
    for (const QueryOutcome& query : outcomes.queries) {
      const std::optional<T> number = get(query, outcomes.kind);
      if (!text.empty()) text += ' ';
      text += number ? fmt::format("{}", *number) : "-";
    }
    json[key] = text;
  }
  void read(const Fields& fields, const std::string& key) {
    is_known = fields.has(key);
    if (!is_known) return;
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
      set(outcomes.queries[q], number, outcomes.kind);
    }
  }
};

/// The last frame of the first window.
struct FirstFrame {
  Outcomes& outcomes;

  void write(Json& json, const std::string& key) const { json[key] = outcomes.window_length - 1; }
  void read(const Fields& fields, const std::string& key) {
    outcomes.window_length = fields.count(key, kMostFrames) + 1;
  }
};

/// A letter per query window.
struct VerdictLetters {
  Outcomes& outcomes;

  void write(Json& json, const std::string& key) const { json[key] = outcome_letters(outcomes); }
  void read(const Fields& fields, const std::string& key) {
    outcomes.query_frames = outcomes.window_length - 1;
    for (const char letter : fields.text(key)) {
      QueryOutcome& query = outcomes.queries.emplace_back();
      query.frame = outcomes.query_frames++;
      set_verdict(query, letter, fields);
    }
  }
};

/// A letter per query frame.
struct FixLetters {
  std::vector<Fix>& fixes;
  const Outcomes& outcomes;

  void write(Json& json, const std::string& key) const {
    std::string letters;
    for (const Fix fix : fixes) letters += kFixLetters[static_cast<size_t>(fix)];
    json[key] = letters;
  }
  void read(const Fields& fields, const std::string& key) {
    for (const char letter : fields.text(key)) {
      const size_t fix = kFixLetters.find(letter);
      if (fix == std::string_view::npos) fields.fail("its fixes do not fit its outcomes");
      fixes.push_back(static_cast<Fix>(fix));
    }
    if (fixes.size() != outcomes.query_frames) fields.fail("its fixes do not fit its outcomes");
  }
};

struct OutcomeFields {
  Outcomes& outcomes;
  std::vector<Fix>& fixes;
};

template <class Visitor>
void visit_fields(OutcomeFields& fields, Visitor&& visit) {
  Outcomes& outcomes = fields.outcomes;
  visit("first_frame", FirstFrame{outcomes});
  visit("scores_are", outcomes.kind);
  visit("best", VerdictLetters{outcomes});
  bool has_scores = true;
  visit("scores", NumberWords<double>{outcomes, has_scores,
                                      [](const QueryOutcome& query, ScoreOrder kind) {
                                        return query.key == kNoScore
                                                   ? std::nullopt
                                                   : std::optional(score_of_key(query.key, kind));
                                      },
                                      [](QueryOutcome& query, double score, ScoreOrder kind) {
                                        query.key = score_key(score, kind);
                                      }});
  visit("margins",
        NumberWords<double>{
            outcomes, outcomes.has_margins,
            [](const QueryOutcome& query, ScoreOrder) { return query.margin; },
            [](QueryOutcome& query, double margin, ScoreOrder) { query.margin = margin; }});
  visit("ranks", NumberWords<size_t>{
                     outcomes, outcomes.has_ranks,
                     [](const QueryOutcome& query, ScoreOrder) { return query.rank; },
                     [](QueryOutcome& query, size_t rank, ScoreOrder) { query.rank = rank; }});
  visit("fixes", FixLetters{fields.fixes, outcomes});
}

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
struct ReplayForm {
  std::optional<Replay>& replay;

  void write(Json& json, const std::string&) const {
    if (replay) add_replay(json, *replay);
  }
  void read(const Fields& fields, const std::string&) {
    constexpr uint64_t kMost = std::numeric_limits<uint64_t>::max();
    if (fields.has("thinned")) {
      const Fields thinned = fields.object("thinned");
      replay.emplace().fps = read_fps(thinned);
      replay->recorded_frames = thinned.count("frames", kMostFrames);
    }
    if (!fields.has("warp")) return;
    if (!replay) replay.emplace();
    const Fields warp = fields.object("warp");
    replay->warp = warp.text("name");
    replay->seed = warp.count("seed", kMost);
    replay->recorded_frames = warp.count("frames", kMostFrames);
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
  decltype(ReportedMetrics::recall_achievement)& shares;
};

template <class Visitor>
void visit_fields(AchievementTargets& targets, Visitor&& visit) {
  for (size_t t = 0; t < kRecallTargets.size(); ++t)
    visit(fmt::format("{:g}", kRecallTargets[t]), targets.shares[t]);
}

struct AchievementFields {
  ReportedMetrics& metrics;
};

template <class Visitor>
void visit_fields(AchievementFields& fields, Visitor&& visit) {
  visit("stretch_frames", fields.metrics.stretch_frames);
  visit("stretches", fields.metrics.stretches);
  visit("targets", AchievementTargets{fields.metrics.recall_achievement});
}

struct PathFields {
  Localisation& path;
  size_t& frames_with_match;
};

template <class Visitor>
void visit_fields(PathFields& fields, Visitor&& visit) {
  Localisation& path = fields.path;
  visit("frames", path.frames);
  visit("frames_with_match", fields.frames_with_match);
  visit("right", path.right);
  visit("wrong", path.wrong);
  visit("share", Derived{path.share()});
  visit("longest_gap_frames", path.longest_gap_frames);
  visit("longest_gap_m", path.longest_gap_m);
  visit("first_fix_frames", path.first_fix_frames);
  visit("first_fix_m", path.first_fix_m);
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
  visit("hits", counts.hits);
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
  visit("hits", counts.hits);
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
  visit("hits", place.judged.hits);
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
void visit_fields(ReportedMetrics& metrics, Visitor&& visit) {
  visit_fields(metrics.curves, visit);
  visit("recall_at", metrics.recall_at);
  visit("recall_achievement", AchievementFields{metrics});
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
  visit("", ReplayForm{report.replay});
  visit("settings", SettingsForm{report});
  if (report.query_settings() != nullptr) visit("counts", report.counts);
  visit("best_match", report.counts.best_match);
  visit("by_view", IfSet{report.by_view});
  visit("recognitions", IfSet{report.recognitions});
  visit("metrics", report.metrics);
  visit("localisation", PathFields{report.localisation, report.frames_with_match});
  visit("confidence", Unless{report.outcomes.confidence, Confidence::score});
  visit("oracle", Unless{report.is_oracle, false});
  visit("curves", report.curves);
  visit("outcomes", OutcomeFields{report.outcomes, report.fixes});
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

/// Every place with what its hits are: the place is judged at its mean, whatever they say.
std::vector<ReportedPlace> places_of(const JudgedResult& judged) {
  std::vector<ReportedPlace> places;
  const Result& result = judged.result;
  const auto anchor = [&](size_t window) { return anchor_of(window, result.window_length()); };
  for (size_t c = 0; c < judged.clusters.size(); ++c) {
    const Cluster& cluster = result.clusters->all[c];
    places.push_back({result.targets[cluster.target].name,
                      anchor(cluster.query_window),
                      {anchor(cluster.query_first), anchor(cluster.query_last)},
                      anchor(cluster.train_window),
                      {anchor(cluster.train_first), anchor(cluster.train_last)},
                      judged.clusters[c]});
  }
  return places;
}

using Definitions = std::vector<std::pair<std::string, std::string>>;

void define_windows(Definitions& define, const Result& result) {
  const auto& settings = std::get<SequenceQuerySettings>(result.settings);
  const std::string_view measure =
      has_paths(settings.method) ? "path score" : score_kind(settings.score).measure;
  define.insert(
      define.end(),
      {{"anchor", kAnchorProtocol},
       {"hits", fmt::format(fmt::runtime(decision_kind(settings.decision).hits), measure)},
       {"places", result.path ? "confirmed tracks, judged at their middle frame"
                              : "clusters of hits, judged at their mean"},
       {"mixed_places", "correct places of whose hits some are incorrect"},
       {"distinct", "correct places"},
       {"best_match", fmt::format("the window with the lowest {}, ties to the first; rate = "
                                  "correct / (queries - ignored)",
                                  measure)},
       {"without_match",
        "a query window whose anchor has no match in the ground truth is not among the queries"},
       {"unreachable", kUnreachableProtocol}});
}

void define_places(Definitions& define) {
  define.insert(
      define.end(),
      {{"hits", "pairs of a frame and a place of which a view is above t_p for c_w frames"},
       {"distinct", "places recognised correctly at least once"},
       {"best_match",
        "the place of the likeliest view, the new place left out, ties to the first; a frame "
        "without words is wrong; rate = correct / (queries - ignored)"},
       {"without_match", "a frame without a match in the ground truth is not among the queries"}});
}

void define_scores(Definitions& define, size_t window_length) {
  const bool has_windows = window_length > 1;
  if (has_windows) define.emplace_back("anchor", kAnchorProtocol);
  define.emplace_back(
      "best_match",
      "the reference with the best score, ties to the first; rate = correct / (queries - ignored)");
  define.emplace_back(
      "without_match",
      "a query without a match in the ground truth is not among the queries of rate and recall");
  if (has_windows) define.emplace_back("unreachable", kUnreachableProtocol);
  define.emplace_back("unreadable", "a query without any score");
}

constexpr const char* kViewProtocol =
    "frames in a row that look alike are one view; a pair of views with hits, and a query view "
    "with best matches, counts once: correct or incorrect if all of its windows are, else mixed; "
    "rate = "
    "mean over query views of the share of their windows that is right";

/// In words, what the metrics count.
void define_metrics(Definitions& define, const Judgement& judgement, bool is_result) {
  const bool has_ranks = judgement.outcomes.has_ranks;
  define.emplace_back(
      "single_best",
      fmt::format("a {}; recall is over queries with a match; the best match of a query without "
                  "one is incorrect; {}",
                  judgement.outcomes.confidence == Confidence::margin
                      ? "margin accepts best matches that have at least this margin"
                      : "threshold accepts best matches that score at least as good",
                  has_ranks ? "references labelled ignore are passed over"
                            : "a query whose best match is labelled ignore is left out"));
  if (judgement.outcomes.has_margins)
    define.emplace_back(
        "margin",
        "how much better the best match is than the best one elsewhere, in score a frame; a best "
        "match without one is never accepted by its margin");
  if (judgement.all_pairs)
    define.emplace_back(
        "all_pairs",
        "a threshold accepts pairs that score at least as good; recall is over all pairs of the "
        "same place; pairs labelled ignore, and queries without any score, are left out");
  if (has_ranks)
    define.emplace_back(
        "precision_at",
        "right references among the K best, of K; mAP@K: mean over queries of the precision at "
        "each right one among the K best, of as many right ones as K can hold");
  define.emplace_back(
      "recall_achievement",
      "the path is cut into stretches of about as many frames; share of those with a query to "
      "find whose recall@1 reaches the target");
  define.emplace_back(
      "ties", "equal scores are accepted together; the best match, and ranks, take the first");
  define.emplace_back(
      "localisation",
      is_result
          ? "a frame's fix is its closest recognition"
          : fmt::format("a frame's fix is its best match where it scores at least as good as "
                        "{}{}",
                        judgement.threshold ? fmt::format("{:.6g}", *judgement.threshold)
                                            : "any correct one before the first mistake",
                        judgement.is_oracle ? ", a threshold chosen from the ground truth" : ""));
}

ReportedCurve reported(const Curve& curve) {
  ReportedCurve found{curve.points.size(), {}};
  for (const CurvePoint& point : thinned(curve, kMostPoints))
    found.points.push_back({curve.threshold(point), point.correct, point.incorrect});
  return found;
}

/// The same function of each curve.
template <class T>
ByAcceptance<T> by_acceptance(const Judgement& judgement, T (*function)(const Curve&)) {
  ByAcceptance<T> all{function(judgement.single_best), {}, {}, {}};
  const bool is_by_score = judgement.outcomes.confidence == Confidence::score;
  if (judgement.other_best)
    (is_by_score ? all.by_margin : all.by_score) = function(*judgement.other_best);
  if (judgement.all_pairs) all.all_pairs = function(judgement.all_pairs->curve);
  return all;
}

ReportedMetrics metrics_of(const Judgement& judgement) {
  const Outcomes& outcomes = judgement.outcomes;
  ReportedMetrics found;
  found.curves = by_acceptance(judgement, numbers_of);
  if (outcomes.has_ranks) found.curves.single_best.tied_queries = tied_queries(outcomes);
  if (judgement.all_pairs) {
    found.curves.all_pairs->same_without_score = judgement.all_pairs->same_without_score;
    found.curves.all_pairs->ignored = judgement.all_pairs->ignored;
  }
  if (outcomes.has_ranks) {
    found.precision_at.emplace();
    found.map_at.emplace();
  }
  for (const size_t k : judgement.recall_at) {
    if (k == 1 || outcomes.has_ranks) found.recall_at[k] = recall_at(outcomes, k);
    if (!outcomes.has_ranks || k > kMostRanked) continue;
    found.precision_at->emplace(k, precision_at(outcomes, k));
    found.map_at->emplace(k, mean_average_precision_at(outcomes, k));
  }
  const auto recalls = local_recalls(outcomes, judgement.stretch_frames);
  found.stretch_frames = judgement.stretch_frames;
  found.stretches = static_cast<size_t>(
      std::ranges::count_if(recalls, [](const auto& recall) { return recall.has_value(); }));
  for (size_t t = 0; t < kRecallTargets.size(); ++t)
    found.recall_achievement[t] = recall_achievement(recalls, kRecallTargets[t]);
  return found;
}

/// What is a result's, and not a matrix's.
void add_result(Report& report, const JudgedResult& judged) {
  const Result& result = judged.result;
  report.method = method_of(result.settings);
  report.replay = result.replay;
  report.settings = result.settings;
  report.counts = judged.counts;
  report.by_view = judged.by_view;
  if (result.clusters) report.recognitions = places_of(judged);
  Definitions& define = report.protocol.definitions;
  if (result.places)
    define_places(define);
  else
    define_windows(define, result);
  if (judged.by_view) define.emplace_back("by_view", kViewProtocol);
}

void add_run(Json& json, const RunInfo& run, double seconds) {
  json["machine"] = machine_json(run);
  json["timing"] = timing_json({{"evaluate", seconds}});
}

}  // namespace

std::string Protocol::definition(const std::string& key) const {
  for (const auto& [name, words] : definitions)
    if (name == key) return words;
  return "";
}

Json Report::settings_json() const {
  const QuerySettings* of_query = query_settings();
  return of_query != nullptr ? settings_in_force(*of_query)
                             : fields_to_json(std::get<ScoreSettings>(settings));
}

bool Report::has_places() const {
  const QuerySettings* of_query = query_settings();
  return of_query != nullptr && std::holds_alternative<FabmapQuerySettings>(*of_query);
}

std::string Report::walk() const {
  if (!replay) return "";
  std::string words;
  if (replay->fps > 0) words = fmt::format("{} frames a second", replay->fps);
  if (replay->warp.empty()) return words;
  return words + fmt::format("{}replayed: {}, seed {}", words.empty() ? "" : ", ", replay->warp,
                             replay->seed);
}

Report report_of(const Evaluation& evaluation, const RunInfo& run, const Monitor& monitor) {
  const Judgement& judgement = evaluation.judgement;
  const GroundTruth& truth = evaluation.truth;
  Report report;
  report.query = evaluation.query_name;
  report.name = evaluation.name;
  report.protocol = {truth.protocol, truth.tolerance_frames, {}};
  report.provenance.made_by = provenance_of(run);
  report.provenance.ground_truth = ground_truth_fingerprint(truth, judgement.layout.scope, monitor);
  if (evaluation.result) {
    add_result(report, *evaluation.result);
    report.provenance.result = evaluation.fingerprint;
  } else {
    report.method = evaluation.scores.method;
    report.replay = evaluation.scores.replay;
    report.settings = evaluation.scores;
    report.counts.best_match = best_match_counts(judgement.outcomes);
    define_scores(report.protocol.definitions, evaluation.scores.window_length);
    report.provenance.scores = evaluation.fingerprint;
  }
  define_metrics(report.protocol.definitions, judgement, evaluation.result.has_value());
  report.metrics = metrics_of(judgement);
  report.localisation = judgement.localisation;
  report.frames_with_match = judgement.frames_with_match;
  report.is_oracle = judgement.is_oracle;
  report.curves = by_acceptance(judgement, reported);
  report.outcomes = judgement.outcomes;
  report.fixes = judgement.fixes;
  return report;
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

CurveNumbers numbers_of(const Curve& curve) {
  CurveNumbers numbers;
  numbers.to_find = curve.to_find;
  for (size_t m = 0; m < numbers.values.size(); ++m)
    numbers.values[m] = curve_metrics()[m].of_curve(curve);
  return numbers;
}

Json curve_numbers_json(const CurveNumbers& numbers) { return fields_to_json(numbers); }

Json curve_json(const Curve& curve) { return fields_to_json(reported(curve)); }

std::vector<CurvePoint> thinned(const Curve& curve, size_t most) {
  const size_t count = curve.points.size();
  if (count <= most) return curve.points;
  std::vector<CurvePoint> points;
  for (size_t i = 0; i < most; ++i) points.push_back(curve.points[i * (count - 1) / (most - 1)]);
  return points;
}

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
