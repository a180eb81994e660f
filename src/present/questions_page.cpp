// Pages that ask a person whether images show the same place.
#include <algorithm>
#include <array>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "base/error.h"
#include "base/json.h"
#include "base/text.h"
#include "evaluate/place_answers.h"
#include "html_parts.h"  // the files of src/present/html, by the build
#include "present/evaluation_page.h"
#include "present/html_page.h"
#include "present/report_tables.h"

namespace vpr {
namespace {

constexpr size_t kManyQuestions = 100;
constexpr int kImageSide = 640;  // pixels
constexpr int kSmallSide = 320;  // of many questions, so that a browser can open the page
constexpr size_t kMostFrames = 200;
constexpr size_t kSpreadFrames = 50;
constexpr size_t kTolerance = 5;  // frames; the page may set another one
constexpr size_t kPlaceCandidates = 60;
constexpr size_t kPlaceTolerance = 10;   // query frames; the page may set another one
constexpr size_t kMostPathFrames = 400;  // of the query, to choose from

/// A query frame and a frame of a training sequence.
using FramePair = std::array<size_t, 2>;

/// Images of a query frame and of its match that are shown together.
struct Question {
  std::string row;  ///< of the saved file, without the answer
  std::string name = {};
  std::string about = {};
  uint32_t sequence = 0;
  std::vector<FramePair> pairs;
  std::string answer = {};
  std::string end = {};                ///< of the row, after the answer
  std::vector<std::string> also = {};  ///< further rows that are saved with an answer
};

VPR_FIELDS(Question, (row), (name), (about), (sequence), (pairs), (answer), (end), (also))

/// The first recognition of a part of a place, its middle and the last one; equal ones once.
std::vector<FramePair> pairs_of(const Result& result, const PlacePart& part) {
  const auto pair_of = [&](uint32_t recognition) {
    const MatchedFrame at = anchors_of(result.recognitions[recognition], result.window_length());
    return FramePair{at.query, at.match.reference};
  };
  std::vector<FramePair> pairs;
  for (const FramePair& pair : {pair_of(part.recognitions.front()),
                                FramePair{part.middle.query, part.middle.match.reference},
                                pair_of(part.recognitions.back())})
    if (std::ranges::find(pairs, pair) == pairs.end()) pairs.push_back(pair);
  return pairs;
}

/// As images_json, also of the query frames `path`.
Json images_of(const std::vector<Question>& questions, const std::vector<size_t>& path,
               const GroundTruthScope& scope, const FrameSources& sources, const Monitor& monitor) {
  ShownFrames shown;
  shown.query.insert(path.begin(), path.end());
  shown.references.resize(scope.sequences.size());
  for (const Question& one : questions)
    for (const auto& [query_frame, train_frame] : one.pairs) {
      shown.query.insert(query_frame);
      shown.references[one.sequence].insert(train_frame);
    }
  const int side =
      std::max(questions.size(), path.size()) > kManyQuestions ? kSmallSide : kImageSide;
  return images_json(read_images(shown, scope, sources, {side}, monitor));
}

/// `data`: the words of the page. `path`: query frames to choose from.
std::string page_of(Json data, const std::vector<Question>& questions,
                    const std::vector<size_t>& path, const Evaluation& evaluation,
                    const Report& report, const FrameSources& sources, const Monitor& monitor) {
  data["key"] =
      fmt::format("vpr-eval {} {}", data["noun"].get<std::string>(), evaluation.fingerprint);
  data["images"] = images_of(questions, path, evaluation.judgment.layout.scope, sources, monitor);
  data["questions"] = value_to_json(questions);
  return fill_page(html::kQuestionsPage, {{"title", html_escaped(title_with_settings(report))},
                                          {"style", palette_css() + std::string(html::kStyle)},
                                          {"data", script_json(data)}});
}

/// `count` of `all`, evenly spaced. Every prefix of the answer is also spread: positions are in the
/// order of their reversed bits (van der Corput 1935).
std::vector<size_t> spread_over(const std::vector<size_t>& all, size_t count) {
  size_t bits = 0;
  while ((size_t{1} << bits) < count) ++bits;
  std::vector<size_t> found;
  for (size_t i = 0; i < size_t{1} << bits; ++i) {
    size_t reversed = 0;
    for (size_t bit = 0; bit < bits; ++bit) reversed |= (i >> bit & 1) << (bits - 1 - bit);
    if (reversed < count) found.push_back(all[(2 * reversed + 1) * all.size() / (2 * count)]);
  }
  return found;
}

/// Indices of outcomes.
struct AskedFrames {
  std::vector<size_t> spread;   ///< in the sample; also those without a best match
  std::vector<size_t> near;     ///< the decision
  std::set<size_t> is_sampled;  ///< query frames of the recording: `spread`, labeled or not
};

/// The frames whose best matches are asked. The sample does not depend on labels, so that it stays
/// one when a page is continued: of a sample that another result began, the frames that lack a
/// label of this result; otherwise frames spread over those that are not in it yet. Then the frames
/// nearest to the decision.
AskedFrames frames_to_ask(const Evaluation& evaluation) {
  const Judgment& judgment = evaluation.judgment;
  const auto& queries = judgment.outcomes.queries;
  const auto recorded = [&](size_t q) {
    return judgment.layout.scope.query.selection.source_of(queries[q].frame);
  };
  const auto is_open = [&](size_t q) {
    return queries[q].best && !answer_to(evaluation, queries[q]);
  };
  AskedFrames asked;
  for (const PersonLabel& label : evaluation.truth.person_labels)
    if (label.is_spread) asked.is_sampled.insert(label.query);
  std::vector<size_t> others;  // in the order of the path
  for (size_t q = 0; q < queries.size(); ++q) {
    if (!asked.is_sampled.contains(recorded(q)))
      others.push_back(q);
    else if (is_open(q))
      asked.spread.push_back(q);
  }
  if (asked.spread.empty())
    asked.spread = spread_over(others, std::min(kSpreadFrames, others.size()));
  for (const size_t q : asked.spread) asked.is_sampled.insert(recorded(q));
  std::erase_if(asked.spread,
                [&](size_t q) { return answer_to(evaluation, queries[q]).has_value(); });
  std::vector<size_t>& near = asked.near;
  for (const size_t q : others)
    if (!asked.is_sampled.contains(recorded(q)) && is_open(q)) near.push_back(q);
  const auto key = [&](size_t q) {
    return confidence_key(queries[q], judgment.outcomes.confidence);
  };
  const auto unrecognized = std::stable_partition(
      near.begin(), near.end(), [&](size_t q) { return is_recognized(judgment, queries[q]); });
  std::stable_sort(near.begin(), unrecognized, [&](size_t a, size_t b) { return key(a) > key(b); });
  std::stable_sort(unrecognized, near.end(), [&](size_t a, size_t b) { return key(a) < key(b); });
  near.resize(std::min(near.size(), kMostFrames - std::min(kMostFrames, asked.spread.size())));
  return asked;
}

void require_frames(const Report& report, std::string_view flag) {
  if (report.has_places())
    throw Error(ErrorKind::usage,
                "{} is for results of frames, and the places of FAB-MAP have no images. "
                "Use --ground-truth",
                flag);
}

/// The first columns of a row of labels.
std::string label_row(const GroundTruthScope& scope, size_t query, size_t sequence,
                      size_t reference) {
  return fmt::format(
      "{},{}{}", query,
      scope.sequences.size() == 1 ? "" : csv_field(scope.sequences[sequence].sequence.name) + ",",
      reference);
}

/// The row of a sampled frame without a best match.
std::string row_without_match(const GroundTruthScope& scope, size_t query) {
  return fmt::format("{},{},,0,{}", query, scope.sequences.size() == 1 ? "" : ",", kAskedSpread);
}

/// The rows of earlier labels. Those of frames that are now in the sample count for it.
std::vector<std::string> known_rows(const Evaluation& evaluation, const AskedFrames& asked) {
  std::vector<std::string> rows;
  const GroundTruthScope& scope = evaluation.judgment.layout.scope;
  for (const PersonLabel& label : evaluation.truth.person_labels)
    rows.push_back(
        label.reference
            ? fmt::format("{},{},{},{}",
                          label_row(scope, label.query, label.sequence, *label.reference),
                          label.is_same ? "same" : "different", label.tolerance,
                          asked.is_sampled.contains(label.query) ? kAskedSpread : kAskedNear)
            : row_without_match(scope, label.query));
  return rows;
}

/// Evenly spaced frames of the searched training sequences, about kPlaceCandidates, at least one of
/// each.
std::vector<FrameMatch> place_candidates(const GroundTruthScope& scope) {
  size_t all = 0;
  for (const auto& train : scope.sequences) all += train.searched ? train.sequence.frames : 0;
  std::vector<FrameMatch> candidates;
  for (uint32_t s = 0; s < scope.sequences.size(); ++s) {
    const size_t frames = scope.sequences[s].sequence.frames;
    if (!scope.sequences[s].searched || frames == 0) continue;
    const size_t share = (kPlaceCandidates * frames + all / 2) / all;
    const size_t count = std::min(frames, std::max<size_t>(1, share));
    for (size_t i = 0; i < count; ++i)
      candidates.push_back({s, (2 * i + 1) * frames / (2 * count)});
  }
  return candidates;
}

/// The index in `path` of the query frame whose best match is nearest to a training frame, and the
/// distance in frames; nullopt if no best match is in its sequence.
std::optional<std::pair<size_t, size_t>> nearest_visit(const Evaluation& evaluation,
                                                       const std::vector<size_t>& path,
                                                       const FrameMatch& train) {
  const QueryOutcome* nearest = nullptr;
  const auto distance = [&](const QueryOutcome& query) {
    return std::max(query.best->reference, train.reference) -
           std::min(query.best->reference, train.reference);
  };
  for (const QueryOutcome& query : evaluation.judgment.outcomes.queries)
    if (query.best && query.best->sequence == train.sequence &&
        (nearest == nullptr || distance(query) < distance(*nearest)))
      nearest = &query;
  if (nearest == nullptr) return std::nullopt;
  const auto at = std::ranges::lower_bound(path, nearest->frame);
  const auto index = static_cast<size_t>(at - path.begin());
  return std::pair(std::min(index, path.size() - 1), distance(*nearest));
}

/// The tolerance of the latest label, or the usual one.
size_t tolerance_of(const GroundTruth& truth) {
  const auto& labels = truth.person_labels;
  const auto last = std::find_if(labels.rbegin(), labels.rend(),
                                 [](const PersonLabel& label) { return label.is_same; });
  return last == labels.rend() ? kTolerance : last->tolerance;
}

}  // namespace

std::string place_questions_page(const Evaluation& evaluation, const Report& report,
                                 const FrameSources& sources, const Monitor& monitor) {
  const EvaluatedResult& judged = *evaluation.result;
  const Result& result = *judged.result;
  require_places(result);
  const std::vector<PlacePart> parts = parts_of_places(result);
  std::vector<Question> questions;
  for (const PlacePart& part : parts) {
    const uint32_t sequence = result.clusters->all[part.place].sequence;
    Question& one = questions.emplace_back(
        Question{answer_row(result, part), result.sequences[sequence].sequence.name,
                 counted(part.frames, "frame"), sequence, pairs_of(result, part)});
    if (!judged.answers) continue;
    const PlaceLabel label = judged.answers->of_recognition[part.recognitions.front()];
    if (label != PlaceLabel::ignore) one.answer = label == PlaceLabel::same ? "yes" : "no";
  }
  const Json words = {
      {"noun", "place"},
      {"file", "places.csv"},
      {"columns", kAnswerColumns},
      {"words", {{"yes", "yes"}, {"no", "no"}}},
      {"note", fmt::format("An answer judges all frames from the first to the last pair, at "
                           "most {}; the middle pair decides.",
                           kPartFrames)},
      {"next", "vpr-eval RESULT --places places.csv"}};
  return page_of(words, questions, {}, evaluation, report, sources, monitor);
}

std::string frame_questions_page(const Evaluation& evaluation, const Report& report,
                                 const FrameSources& sources, const Monitor& monitor) {
  const Judgment& judgment = evaluation.judgment;
  const GroundTruthScope& scope = judgment.layout.scope;
  require_frames(report, "--ask-frames");
  const AskedFrames asked = frames_to_ask(evaluation);
  std::vector<Question> questions;
  std::vector<std::string> without_match;  // rows of frames since the last question
  const auto ask = [&](const std::vector<size_t>& frames, std::string_view why) {
    for (const size_t q : frames) {
      const QueryOutcome& query = judgment.outcomes.queries[q];
      if (!query.best) {
        without_match.push_back(
            row_without_match(scope, scope.query.selection.source_of(query.frame)));
        continue;
      }
      const auto [s, reference] = *query.best;
      const Sequence& train = scope.sequences[s].sequence;
      questions.push_back({.row = label_row(scope, scope.query.selection.source_of(query.frame), s,
                                            train.selection.source_of(reference)),
                           .name = train.name,
                           .sequence = s,
                           .pairs = {{query.frame, reference}},
                           .end = std::string(why),
                           .also = std::exchange(without_match, {})});
    }
  };
  ask(asked.spread, kAskedSpread);
  const size_t in_sample = questions.size();
  if (in_sample > 0) {
    std::vector<std::string>& last = questions.back().also;
    last.insert(last.end(), without_match.begin(), without_match.end());
    without_match.clear();
  }
  ask(asked.near, kAskedNear);
  const std::vector<std::string> known = known_rows(evaluation, asked);
  const Json words = {
      {"noun", "frame"},
      {"file", "labels.csv"},
      {"columns", fmt::format("query,{}reference,label,tolerance,asked",
                              scope.sequences.size() == 1 ? "" : "sequence,")},
      {"words", {{"yes", "same"}, {"no", "different"}}},
      {"tolerance", tolerance_of(evaluation.truth)},
      {"known", known},
      {"note",
       fmt::format("The first {} of {} questions are spread along the query and make the estimate; "
                   "the others are near the decision and set the threshold.{}{}",
                   in_sample, questions.size(),
                   in_sample == asked.spread.size()
                       ? ""
                       : fmt::format(" The sample also has {} without a best match.",
                                     counted(asked.spread.size() - in_sample, "frame")),
                   known.empty() ? ""
                                 : fmt::format(" {} from before are saved with your answers.",
                                               counted(known.size(), "label")))},
      {"next", "vpr-eval ANY_RESULT --ground-truth labels.csv"}};
  return page_of(words, questions, {}, evaluation, report, sources, monitor);
}

std::string fabmap_questions_page(const Evaluation& evaluation, const Report& report,
                                  const FrameSources& sources, const Monitor& monitor) {
  require_frames(report, "--ask-fabmap");
  const GroundTruthScope& scope = evaluation.judgment.layout.scope;
  const size_t query_frames = scope.query.frames;
  const size_t count = std::min(query_frames, kMostPathFrames);
  std::vector<size_t> path;
  Json recorded = Json::array();
  for (size_t i = 0; i < count; ++i) {
    path.push_back(i * query_frames / count);
    recorded.push_back({path.back(), scope.query.selection.source_of(path.back())});
  }
  std::vector<Question> questions;
  for (const FrameMatch& candidate : place_candidates(scope)) {
    const auto [s, reference] = candidate;
    const Sequence& train = scope.sequences[s].sequence;
    const auto visit = nearest_visit(evaluation, path, candidate);
    questions.push_back(
        {.row = fmt::format("{},{}", csv_field(train.name), train.selection.source_of(reference)),
         .name = train.name,
         .about = visit ? fmt::format("suggested is query {}, whose best match is {} away",
                                      path[visit->first], counted(visit->second, "frame"))
                        : "no best match suggests a query frame",
         .sequence = s,
         .pairs = {{path[visit ? visit->first : 0], reference}}});
  }
  const Json words = {
      {"noun", "training frame"},
      {"question", "A place of FAB-MAP?"},
      {"answers", {{"yes", "Yes, here"}, {"no", "Yes, not on the path"}, {"unsure", "No place"}}},
      {"file", "fabmap-places.csv"},
      {"columns", "sequence,train,query,tolerance"},
      {"tolerance", kPlaceTolerance},
      {"path", recorded},
      {"note",
       "Yes: the training image is one of FAB-MAP's places; choose the query frame that shows it, "
       "if "
       "any. Query frames beyond the tolerance, up to twice as far, are ignored."},
      {"next",
       "vpr-train fabmap --marked-places fabmap-places.csv, and vpr-eval --ground-truth "
       "fabmap-places.csv"}};
  return page_of(words, questions, path, evaluation, report, sources, monitor);
}

}  // namespace vpr
