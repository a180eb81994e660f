#include "evaluate/evaluation.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>

#include "base/error.h"
#include "base/text.h"
#include "evaluate/place_answers.h"
#include "truth/positions.h"

namespace vpr {
namespace {

std::vector<double> traveled_by(const EvaluationSettings& by, const GroundTruthScope& scope) {
  if (by.poses.empty()) return {};
  return read_traveled(by.poses, scope.query);
}

std::vector<MatchedFrame> best_matches(const Evaluation& evaluation) {
  std::vector<MatchedFrame> all;
  for (const QueryOutcome& query : evaluation.judgment.outcomes.queries)
    if (query.best && query.has_match) all.push_back({query.frame, *query.best});
  return all;
}

size_t count_correct(const GroundTruth& truth, const std::vector<MatchedFrame>& all) {
  return static_cast<size_t>(std::ranges::count(
      all, PlaceLabel::same, [&](const MatchedFrame& one) { return label_of(truth, one); }));
}

// By how many frames the match is later than the nearest one of its place; nullopt: it has none.
std::optional<int64_t> offset_from_truth(const GroundTruth& truth, const MatchedFrame& one) {
  std::optional<int64_t> nearest;
  for (const GroundTruth::Pair& pair : truth.pairs_of(one.query, one.match.sequence)) {
    if (pair.label != PlaceLabel::same) continue;
    const int64_t middle = (int64_t{pair.first} + pair.last()) / 2;
    const int64_t offset = static_cast<int64_t>(one.match.reference) - middle;
    if (!nearest || std::abs(offset) < std::abs(*nearest)) nearest = offset;
  }
  return nearest;
}

// A warning about a ground truth that begins elsewhere, if a third of all matches are about equally
// far from it, or about aligned sequences that differ in length.
std::optional<std::string> alignment_warning(const Evaluation& evaluation,
                                             const EvaluationSettings& by,
                                             const std::vector<MatchedFrame>& matches) {
  constexpr double kSameLength = 0.1;
  constexpr int64_t kAround = 3;
  std::vector<int64_t> offsets;
  for (const MatchedFrame& one : matches)
    if (const auto offset = offset_from_truth(evaluation.truth, one)) offsets.push_back(*offset);
  std::ranges::sort(offsets);
  // The most frequent offset, with its surroundings.
  size_t around = 0;
  int64_t offset = 0;
  for (size_t first = 0, end = 0; first < offsets.size(); ++first) {
    while (end < offsets.size() && offsets[end] <= offsets[first] + 2 * kAround) ++end;
    if (end - first <= around) continue;
    around = end - first;
    offset = offsets[(first + end) / 2];
  }
  if (3 * around >= matches.size() && std::abs(offset) > kAround)
    return fmt::format(
        "{} of {} matches are about {} frames {} the ground truth says: does it begin at the first "
        "frame of both sequences? Otherwise select the parts that it describes",
        around, matches.size(), std::abs(offset), offset > 0 ? "later than" : "before what");
  if (by.ground_truth->format != "aligned" || by.ground_truth->options.train_step)
    return std::nullopt;
  const GroundTruthScope& scope = evaluation.judgment.layout.scope;
  const auto train =
      std::ranges::find_if(scope.sequences, [](const auto& one) { return one.searched; });
  const size_t frames = scope.query.recorded_frames();
  const size_t train_frames = train->sequence.recorded_frames();
  const double step = static_cast<double>(train_frames) / static_cast<double>(frames);
  if (std::abs(step - 1) <= kSameLength) return std::nullopt;
  return fmt::format("the query has {} and the training sequence {}: --train-step {:.3g}?",
                     counted(frames, "frame"), train_frames, step);
}

// Names the smallest larger tolerance at which at least 9 of 10 matches are correct, unless a large
// part of the training frames is within it. Nothing for selected training frames: a tolerance
// counts recorded ones.
std::optional<std::string> tolerance_warning(const GroundTruth& truth, int64_t train_frames,
                                             const std::vector<MatchedFrame>& matches,
                                             const std::string& noun) {
  constexpr int64_t kMostOff = 10;  // frames; a larger offset is not a matter of tolerance
  if (truth.applied_tolerance_frames) return std::nullopt;
  GroundTruth wider = truth;
  while (++wider.tolerance_frames <= truth.tolerance_frames + kMostOff &&
         4 * (2 * wider.tolerance_frames + 1) <= train_frames) {
    const size_t correct = count_correct(wider, matches);
    if (10 * correct < 9 * matches.size()) continue;
    const std::string share = correct == matches.size()
                                  ? fmt::format("all {}", correct)
                                  : fmt::format("{} of {}", correct, matches.size());
    return fmt::format(
        "{} {} are within {} of the truth. If that is the same place, use --tolerance {}", share,
        noun, counted(wider.tolerance_frames, "frame"), wider.tolerance_frames);
  }
  return std::nullopt;
}

// Warns if the ground truth, not the method, is the likely cause of incorrect recognitions.
void warn_of_truth(Evaluation& evaluation, const EvaluationSettings& by, const Monitor& monitor) {
  const GroundTruth& truth = evaluation.truth;
  if (!truth.is_known || !by.ground_truth) return;
  const auto warn_of = [&](std::string_view what) {
    evaluation.warned_of_ground_truth = true;
    warn(monitor, "{}{}", by.warned_as.empty() ? "" : by.warned_as + ": ", what);
  };
  if (const auto& radius = by.ground_truth->options.radius_m;
      radius && frames_with_match(evaluation.judgment.outcomes) == 0)
    return warn_of(fmt::format(
        "no training frame is within {} m of a query frame. Do both paths have one unit and "
        "origin?",
        *radius));
  std::vector<MatchedFrame> matches;
  if (evaluation.result) matches = recognized_frames(evaluation);
  std::string noun = matches.empty() ? "best matches" : "recognitions";
  if (matches.empty()) matches = best_matches(evaluation);
  const bool most_are_incorrect = 2 * count_correct(truth, matches) < matches.size();
  if (!most_are_incorrect) {
    std::erase_if(matches, [&](const MatchedFrame& one) {
      return label_of(truth, one) != PlaceLabel::different;
    });
    noun = "incorrect " + noun;
  }
  if (matches.size() < 2) return;
  const GroundTruthScope& scope = evaluation.judgment.layout.scope;
  int64_t train_frames = 0;
  for (const auto& one : scope.sequences)
    if (one.searched && !scope.has_places)
      train_frames += static_cast<int64_t>(one.sequence.recorded_frames());
  std::optional<std::string> warning = tolerance_warning(truth, train_frames, matches, noun);
  if (!warning && most_are_incorrect && truth.asked.empty())
    warning = alignment_warning(evaluation, by, matches);
  if (warning) warn_of(*warning);
}

// A caution about labels of frames that are not a sample, or that were made from these matches.
std::string label_caution(const GroundTruth& truth, const Outcomes& outcomes) {
  if (truth.asked.empty() || truth.is_sample) return "";
  bool is_own = true;
  for (const QueryOutcome& query : outcomes.queries)
    for (const GroundTruth::Pair& pair : truth.asked[query.frame])
      is_own = is_own && query.best == FrameMatch{pair.sequence, pair.first};
  return fmt::format("Caution: the labeled frames are not a sample of the query.{}",
                     is_own ? " Caution: the labels were made from this result." : "");
}

// Counts and verdicts by the answers in a file.
void judge_by_answers(Evaluation& evaluation, const std::filesystem::path& file,
                      std::span<const double> traveled_m) {
  EvaluatedResult& judged = *evaluation.result;
  const Result& result = *judged.result;
  const std::vector<PlacePart> parts = parts_of_places(result);
  const std::vector<PlaceLabel> labels = read_place_answers(file, result, parts);
  PlaceAnswers& answers = judged.answers.emplace();
  answers.of_recognition.resize(result.recognitions.size(), PlaceLabel::ignore);
  std::vector<std::optional<size_t>> away(judged.clusters.size());
  LabelCounts pairs;
  for (size_t p = 0; p < parts.size(); ++p) {
    for (const uint32_t r : parts[p].recognitions) answers.of_recognition[r] = labels[p];
    pairs.add(labels[p], parts[p].recognitions.size());
    if (labels[p] != PlaceLabel::ignore) {
      ++answers.answers;
      answers.most_frames = std::max(answers.most_frames, parts[p].frames);
    }
    // A place is judged by the part that is closest to its representative.
    const size_t place = parts[p].place;
    const size_t middle =
        anchor_of(result.clusters->all[place].query_window, result.window_length());
    const size_t query = parts[p].middle.query;
    const size_t distance = std::max(query, middle) - std::min(query, middle);
    if (away[place] && *away[place] <= distance) continue;
    away[place] = distance;
    judged.clusters[place].label = labels[p];
  }
  count_clusters(judged.counts, judged.clusters);
  judged.counts.recognitions_by_place = pairs;
  judge_by_places(evaluation.judgment, result, answers.of_recognition, traveled_m);
  evaluation.truth.protocol =
      fmt::format("{} to {}", counted(answers.answers, "answer"),
                  parts.size() == judged.clusters.size()
                      ? counted(parts.size(), "place")
                      : fmt::format("{} of {}", counted(parts.size(), "part"),
                                    counted(judged.clusters.size(), "place")));
}

void present_by(Judgment& judgment, const EvaluationSettings& by) {
  if (by.confidence) set_confidence(judgment, *by.confidence);
  if (!by.recall_at.empty()) {
    std::set<size_t> ks(by.recall_at.begin(), by.recall_at.end());
    ks.insert(1);
    judgment.recall_at.assign(ks.begin(), ks.end());
  }
  judgment.stretch_frames = by.stretch_frames;
}

Sequence query_of(const ScoreSettings& settings, size_t frames) {
  Sequence query = settings.query;
  query.frames = frames;
  const Selection& selection = query.selection;
  if (!selection.is_all() && selection.frames() != frames)
    throw Error(ErrorKind::data,
                "the scores have {}, but of {} the speed {} selects {}. Use the speed, its seed "
                "and the number of frames of the query of the scores.",
                counted(frames, "frame"), counted(selection.recorded_frames, "frame"),
                selection.speed, selection.frames());
  return query;
}

GroundTruth truth_of(const EvaluationSettings& by, GroundTruthScope scope, const Monitor& monitor) {
  if (!by.ground_truth) return unknown_ground_truth(scope);
  scope.query_names = by.query_names;
  for (size_t s = 0; s < std::min(by.train_names.size(), scope.sequences.size()); ++s)
    scope.sequences[s].names = by.train_names[s];
  return read_ground_truth(*by.ground_truth, scope, monitor);
}

// In a loop query, frames within the gap and later ones are not searched: their pairs with the
// query, which is the last training sequence, are ignored.
void ignore_unsearched(GroundTruth& truth, const Result& result) {
  if (!is_loop(result.settings) || !truth.is_known) return;
  const auto own = static_cast<int64_t>(first_own_place(result));
  for (size_t query = 0; query < truth.pairs.size(); ++query) {
    const int64_t searched = result.past[query];
    // A searched frame may be the same place by a pair that is the tolerance farther.
    const int64_t last = searched - 1 + (searched == own ? 0 : truth.tolerance_frames);
    std::vector<GroundTruth::Pair> kept;
    for (GroundTruth::Pair pair : truth.pairs[query]) {
      const bool is_own = pair.sequence + 1 == result.sequences.size();
      if (is_own && pair.label == PlaceLabel::same && pair.last() > last) {
        if (pair.first <= last) {
          const auto further = static_cast<uint32_t>(last - pair.first);
          kept.push_back({pair.sequence, pair.first, pair.label, further});
          pair = {pair.sequence, pair.first + further + 1, pair.label, pair.further - further - 1};
        }
        pair.label = PlaceLabel::ignore;
      }
      kept.push_back(pair);
    }
    truth.pairs[query] = std::move(kept);
  }
}

// Adds readers of the names of frames, for sides that have none.
void add_recorded_names(EvaluationSettings& by, const ResultContext& context, size_t sequences) {
  if (const std::string query = context.run.path("query"); !by.query_names && !query.empty())
    by.query_names = name_reader(parse_sequence_argument(query));
  const std::string database = context.run.path("database");
  if (!by.train_names.empty()) return;
  if (database.empty() && !context.train) {  // loops of the query
    by.train_names.assign(sequences, by.query_names);
    return;
  }
  using Trained = std::shared_ptr<const std::vector<TrainSequence>>;
  const auto trained = std::make_shared<Trained>(context.train);  // read at most once
  for (size_t s = 0; s < sequences; ++s)
    by.train_names.emplace_back([database, trained, s] {
      if (!*trained)
        *trained = std::make_shared<const std::vector<TrainSequence>>(
            read_sequence_database(database).sequences);
      return (*trained)->at(s).sequence.frame_names;
    });
}

}  // namespace

void require_all_pairs(const GroundTruth& truth, const EvaluationSettings& by) {
  if (!truth.asked.empty())
    throw Error(
        ErrorKind::usage,
        "{}: labels of single pairs judge results, but cannot choose settings, because most "
        "mistakes of other settings are not labeled. Use anchors or another ground truth",
        by.ground_truth->path.string());
}

GroundTruth whole_truth_of(const EvaluationSettings& by, GroundTruthScope scope,
                           const Monitor& monitor) {
  GroundTruth truth = truth_of(by, std::move(scope), monitor);
  require_all_pairs(truth, by);
  return truth;
}

void check_evaluation(const EvaluationSettings& by) {
  constexpr double kMostFrames = 1e7;
  for (const size_t k : by.recall_at)
    require_range("recall_at", static_cast<double>(k), 1, kMostFrames);
  require_range("stretch", static_cast<double>(by.stretch_frames), 1, kMostFrames);
}

Evaluation evaluate_result(std::shared_ptr<const Result> result, std::optional<ScoreMatrix> matrix,
                           const EvaluationSettings& by, const Monitor& monitor) {
  Evaluation evaluation;
  const GroundTruthScope scope = scope_of(*result);
  evaluation.truth = truth_of(by, scope, monitor);
  ignore_unsearched(evaluation.truth, *result);
  const GroundTruth& truth = evaluation.truth;
  const std::vector<double> traveled_m = traveled_by(by, scope);
  evaluation.judgment = matrix ? judge(*result, *matrix, truth, traveled_m, monitor)
                               : judge(*result, truth, traveled_m, monitor);
  present_by(evaluation.judgment, by);
  EvaluatedResult& judged = evaluation.result.emplace();
  judged.counts = count_recognitions(*result, truth, monitor);
  judged.counts.best_match = best_match_counts(evaluation.judgment.outcomes);
  if (truth.is_known)
    judged.by_keyframe = count_by_keyframe(*result, truth, evaluation.judgment.outcomes, monitor);
  judged.clusters = judge_clusters(*result, truth, monitor);
  judged.result = std::move(result);
  if (!by.places.empty()) judge_by_answers(evaluation, by.places, traveled_m);
  evaluation.matrix = std::move(matrix);
  evaluation.caution = label_caution(truth, evaluation.judgment.outcomes);
  warn_of_truth(evaluation, by, monitor);
  return evaluation;
}

Evaluation evaluate_stored(const std::shared_ptr<const StoredResult>& stored,
                           std::optional<ScoreMatrix> matrix, EvaluationSettings by,
                           const Monitor& monitor) {
  const std::shared_ptr<const Result> result(stored, &stored->result);
  if (!result->places) add_recorded_names(by, stored->context, result->sequences.size());
  Evaluation evaluation = evaluate_result(result, std::move(matrix), by, monitor);
  evaluation.fingerprint =
      stored->fingerprint.empty() ? fingerprint_of(*stored) : stored->fingerprint;
  return evaluation;
}

Evaluation evaluate_scores(ScoreMatrix matrix, const ScoreSettings& settings,
                           const EvaluationSettings& by, const Monitor& monitor) {
  Evaluation evaluation;
  evaluation.scores = settings;
  ScoreLayout layout = layout_of(matrix, settings.window_length);
  layout.scope.query = query_of(settings, layout.scope.query.frames);
  evaluation.truth = truth_of(by, layout.scope, monitor);
  const std::vector<double> traveled_m = traveled_by(by, layout.scope);
  evaluation.judgment =
      judge(matrix, layout, evaluation.truth, settings.threshold, traveled_m, monitor);
  present_by(evaluation.judgment, by);
  evaluation.fingerprint = matrix.fingerprint(monitor);
  evaluation.matrix = std::move(matrix);
  evaluation.caution = label_caution(evaluation.truth, evaluation.judgment.outcomes);
  warn_of_truth(evaluation, by, monitor);
  return evaluation;
}

std::optional<PlaceLabel> answer_to(const Evaluation& evaluation, const QueryOutcome& query) {
  if (!query.best) return std::nullopt;
  const GroundTruthScope& scope = evaluation.judgment.layout.scope;
  const size_t frame = scope.query.selection.source_of(query.frame);
  const size_t reference =
      scope.sequences[query.best->sequence].sequence.selection.source_of(query.best->reference);
  for (const PersonLabel& label : evaluation.truth.person_labels) {
    if (label.query != frame || label.sequence != query.best->sequence || !label.reference)
      continue;
    const size_t away =
        std::max(reference, *label.reference) - std::min(reference, *label.reference);
    if (away <= label.tolerance) return label.is_same ? PlaceLabel::same : PlaceLabel::different;
  }
  return std::nullopt;
}

std::optional<Estimate> estimated_recall(const Evaluation& evaluation) {
  const BestMatchCounts counts = best_match_counts(evaluation.judgment.outcomes);
  if (!evaluation.truth.is_sample || counts.frames == 0 || counts.ignored > 0) return std::nullopt;
  // The copies of a frame are not independent.
  const Selection& selection = evaluation.judgment.layout.scope.query.selection;
  if (std::ranges::adjacent_find(selection.sources, std::greater_equal()) !=
      selection.sources.end())
    return std::nullopt;
  return estimate_share(counts.correct, counts.frames);
}

std::optional<LabeledThreshold> labeled_threshold(const Evaluation& evaluation) {
  const Outcomes& outcomes = evaluation.judgment.outcomes;
  if (!evaluation.truth.is_sample || !outcomes.has_scores) return std::nullopt;
  LabeledThreshold found;
  uint64_t first = kNoScore;  // incorrect
  for (const QueryOutcome& query : outcomes.queries) {
    const std::optional<PlaceLabel> answer = answer_to(evaluation, query);
    found.labels += answer.has_value();
    if (answer == PlaceLabel::different)
      first = std::min(first, confidence_key(query, outcomes.confidence));
  }
  if (first != kNoScore) found.threshold = score_of_key(first, confidence_order(outcomes));
  found.accepted =
      static_cast<size_t>(std::ranges::count_if(outcomes.queries, [&](const QueryOutcome& query) {
        return query.best && confidence_key(query, outcomes.confidence) < first;
      }));
  return found;
}

std::vector<MatchedFrame> recognized_frames(const Evaluation& evaluation) {
  if (!evaluation.result) return evaluation.judgment.recognized;
  std::vector<MatchedFrame> found;
  const Result& result = *evaluation.result->result;
  for (const Match* recognition : recognitions_by_frame(result))
    if (recognition != nullptr) found.push_back(anchors_of(*recognition, result.window_length()));
  return found;
}

void warn_of_scores(const Judgment& judgment, const ScoreInput& scores, const std::string& source,
                    const Monitor& monitor) {
  constexpr double kClear = 0.05;  // of the queries: more than chance
  const auto found = recall_at(judgment.outcomes, 1);
  if (found && judgment.all_pairs && scores.is_distance != scores.is_similarity) {
    const double other = static_cast<double>(judgment.all_pairs->worst_correct) /
                         static_cast<double>(frames_with_match(judgment.outcomes));
    if (other >= 2 * *found && other >= *found + kClear)
      warn(monitor, "{}: R@1 is {:.1f} % with {} and {:.1f} % with {}", source, 100 * *found,
           scores.is_distance ? "--distance" : "--similarity", 100 * other,
           scores.is_distance ? "--similarity" : "--distance");
  }
  const auto& queries = judgment.outcomes.queries;
  const size_t rows = window_count(queries.size(), judgment.layout.window_length);
  if (const size_t unscored = judgment.outcomes.unscored; unscored > 0)
    warn(monitor, "{}: {} of {} have no score, so they are not recognized", source, unscored,
         counted(rows, "query", "queries"));
  const auto& points = judgment.single_best.points;
  if (scores.is_similarity || scores.missing || points.empty()) return;
  const double best = judgment.single_best.threshold(points.front());
  if (std::ranges::count(score_kinds(), best, &ScoreKind::missing) > 0)
    warn(monitor,
         "{0}: the smallest distance is {1}. If it stands for a missing score, as in a matrix of "
         "vpr-query, add --missing {1}",
         source, best);
}

}  // namespace vpr
