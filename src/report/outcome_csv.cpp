#include "report/outcome_csv.h"

#include <fmt/format.h>

#include "base/csv.h"
#include "pipeline/evaluate.h"

namespace vpr {
namespace {

std::string_view word_of(Verdict verdict) {
  switch (verdict) {
    case Verdict::correct:
      return "right";
    case Verdict::incorrect:
      return "wrong";
    case Verdict::ignored:
      return "ignored";
    case Verdict::unreadable:
      return "unreadable";
  }
  return "";
}

std::string_view word_of(PlaceLabel label) {
  return label == PlaceLabel::same ? "right" : label == PlaceLabel::different ? "wrong" : "ignored";
}

std::string_view word_of(Fix fix) {
  switch (fix) {
    case Fix::none:
      return "none";
    case Fix::right:
      return "right";
    case Fix::wrong:
      return "wrong";
    case Fix::unjudged:
      return "ignored";
  }
  return "";
}

std::string_view match_word(const QueryOutcome& query) {
  return query.has_match ? "yes" : query.is_unreachable ? "unreachable" : "no";
}

std::string prefix(const std::string& name, const std::string& query) {
  return csv_field(name) + "," + csv_field(query) + ",";
}

}  // namespace

std::string outcomes_csv_header() {
  return "name,query,first_frame,frame,sequence,train_frame,score,outcome,has_match,fix,rank,"
         "margin\n";
}

std::string recognitions_csv_header() {
  return "name,query,sequence,first_frame,frame,last_frame,train_first_frame,train_frame,"
         "train_last_frame,hits,hits_right,hits_wrong,score,outcome\n";
}

std::string outcomes_csv(const Judgement& judgement, const std::string& name,
                         const std::string& query_name) {
  const std::string start = prefix(name, query_name);
  const Outcomes& outcomes = judgement.outcomes;
  std::string text;
  for (const QueryOutcome& query : outcomes.queries) {
    const std::string best =
        query.best
            ? fmt::format("{},{},{}",
                          csv_field(judgement.layout.scope.sequences[query.best->sequence].name),
                          query.best->reference, score_of_key(query.key, outcomes.kind))
            : ",,";
    text += fmt::format(
        "{}{},{},{},{},{},{},{},{}\n", start, query.frame + 1 - outcomes.window_length, query.frame,
        best, word_of(query.verdict), match_word(query), word_of(judgement.fixes[query.frame]),
        query.rank ? std::to_string(*query.rank) : "",
        query.margin ? fmt::format("{}", *query.margin) : "");
  }
  return text;
}

std::string recognitions_csv(const JudgedResult& judged, const std::string& name) {
  const Result& result = judged.result;
  const std::string start = prefix(name, result.query_name);
  const size_t length = result.window_length();
  const Clusters clusters = clusters_of(result);
  std::string text;
  for (size_t c = 0; c < judged.clusters.size(); ++c) {
    const Cluster& cluster = clusters.all[c];
    const JudgedCluster& one = judged.clusters[c];
    const std::string& target = result.places ? result.places->names[cluster.train_window]
                                              : result.targets[cluster.target].name;
    text += fmt::format(
        "{}{},{},{},{},{},{},{},{},{},{},{},{}\n", start, csv_field(target), cluster.query_first,
        anchor_of(cluster.query_window, length), anchor_of(cluster.query_last, length),
        cluster.train_first, anchor_of(cluster.train_window, length),
        anchor_of(cluster.train_last, length), cluster.hits, one.hits.correct, one.hits.incorrect,
        cluster.best_score, one.is_mixed() ? "mixed" : word_of(one.label));
  }
  return text;
}

}  // namespace vpr
