#include "report/outcome_csv.h"

#include <fmt/format.h>

#include "base/csv.h"
#include "evaluation/judgement.h"
#include "recognition/fabmap_result.h"

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
  return "name,query,first_frame,frame,sequence,train_frame,score,outcome,has_match,fix,rank\n";
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
    text += fmt::format("{}{},{},{},{},{},{},{}\n", start, query.frame + 1 - outcomes.window_length,
                        query.frame, best, word_of(query.verdict), match_word(query),
                        word_of(judgement.fixes[query.frame]),
                        query.rank ? std::to_string(*query.rank) : "");
  }
  return text;
}

std::string recognitions_csv(const SequenceResult& result, const GroundTruth& truth,
                             const std::string& name, const Monitor& monitor) {
  const std::string start = prefix(name, result.query_name);
  std::string text;
  const std::vector<JudgedPlace> judged = judge_places(result, truth, monitor);
  for (size_t p = 0; p < judged.size(); ++p) {
    const Recognition& place = result.places[p];
    const LabelCounts& hits = judged[p].hits;
    const bool is_mixed = judged[p].label == PlaceLabel::same && hits.incorrect > 0;
    const size_t frame = result.anchor(place.query_window);
    const size_t train = result.anchor(place.train_window);
    text += fmt::format("{}{},{},{},{},{},{},{},{},{},{},{},{}\n", start,
                        csv_field(result.sequences[place.sequence].name), place.query_first, frame,
                        result.anchor(place.query_last), place.train_first, train,
                        result.anchor(place.train_last), place.hits, hits.correct, hits.incorrect,
                        int64_t{place.best_distance} - result.score_offset(),
                        is_mixed ? "mixed" : word_of(judged[p].label));
  }
  return text;
}

std::string recognitions_csv(const FabmapResult& result, const GroundTruth& truth,
                             const std::string& name, const Monitor& monitor) {
  const std::string start = prefix(name, result.query_name);
  std::string text;
  for (const PlaceMatch& hit : result.hits) {
    check_stop(monitor);
    const PlaceLabel label = truth.label(hit.frame, 0, hit.place);
    text += fmt::format("{0}{1},{2},{2},{2},{3},{3},{3},1,{4},{5},{6},{7}\n", start,
                        csv_field(result.places[hit.place]), hit.frame, hit.place,
                        label == PlaceLabel::same ? 1 : 0, label == PlaceLabel::different ? 1 : 0,
                        hit.probability, word_of(label));
  }
  return text;
}

}  // namespace vpr
