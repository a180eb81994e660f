#include "eval_inputs.h"

#include <algorithm>
#include <memory>

#include <fmt/format.h>

#include "base/error.h"
#include "base/json.h"
#include "decide/score_kind.h"
#include "evaluate/metrics.h"
#include "evaluate/score_sources.h"
#include "present/evaluation_report.h"
#include "present/result_file.h"
#include "sequence/sequence_source.h"
#include "store/sequence_database.h"

namespace vpr {
namespace {

[[noreturn]] void refuse_without_truth(const EvalInputs& inputs) {
  if (!inputs.dataset.empty())
    throw Error(ErrorKind::usage,
                fmt::format("{}: the query has no ground truth; name it there or in --ground-truth",
                            inputs.dataset));
  throw Error(ErrorKind::usage,
              "give the ground truth, as in --ground-truth pairs.csv or --ground-truth aligned; "
              "without one, --html and --plot show a result, and nothing else is written");
}

/// Whether all that is asked for can be had without a ground truth: pictures of a result.
bool only_looks(const Session& session, const EvalInputs& inputs) {
  return !inputs.result.empty() && wants_pictures(inputs.pictures) &&
         inputs.expect.expected.empty() && inputs.map.empty() && session.options.output.empty() &&
         !session.options.json && !inputs.csv.any() && inputs.fixes.empty();
}

/// What the flags or the data set name; poses of --poses, or the data set's.
JudgedBy judged_by(const Session& session, const EvalInputs& inputs,
                   const std::optional<std::string>& query_name, DatabaseFamily family) {
  JudgedBy by;
  by.confidence = inputs.confidence;
  by.poses = inputs.scores.poses;
  by.recall_at = recall_at_of(inputs.scores);
  by.stretch_frames = stretch_of(inputs.scores);
  if (!inputs.ground_truth.empty())
    by.ground_truth = ground_truth_argument(inputs.ground_truth, inputs.flags);
  if (!inputs.dataset.empty() &&
      (!by.ground_truth || (by.poses.empty() && !inputs.result.empty()))) {
    const Dataset dataset = read_dataset(inputs.dataset);
    const DatasetQuery& query = select_query(dataset, query_name);
    if (!by.ground_truth) by.ground_truth = ground_truth_of(query, family, inputs.flags);
    if (by.poses.empty() && !inputs.result.empty()) by.poses = query.sequence.poses;
  }
  if (!by.ground_truth && !only_looks(session, inputs)) refuse_without_truth(inputs);
  if (family == DatabaseFamily::sequences) add_names(by, inputs, query_name);
  return by;
}

/// The matrix of --scores alone, or of descriptors. Throws Error(usage) unless its kind is known.
ScoreMatrix open_scores(const ScoreInputs& inputs) {
  if (!inputs.query_npy.empty())
    return descriptor_scores(open_sequence(parse_sequence_argument(inputs.query_npy)),
                             open_sequence(parse_sequence_argument(inputs.reference_npy)),
                             inputs.metric);
  require_order(inputs.matrix);
  return {inputs.matrix.path, inputs.matrix.format()};
}

/// The matrix that was saved with a result; `missing` stands where it has no score.
ScoreMatrix open_saved_scores(const ScoreInputs& inputs, double missing) {
  return {inputs.matrix.path,
          {false, inputs.matrix.references_first, inputs.matrix.missing.value_or(missing)}};
}

/// The matrix of --scores beside a result; none without. Throws Error(data) if it is not the one
/// that was saved with the result.
std::optional<ScoreMatrix> open_matrix_of(const Session& session, const StoredResult& stored,
                                          const EvalInputs& inputs) {
  if (inputs.scores.matrix.path.empty()) return std::nullopt;
  if (stored.result.places)
    throw Error(ErrorKind::usage,
                "a FAB-MAP result takes no --scores; evaluate the matrix without the result");
  ScoreMatrix matrix = open_saved_scores(inputs.scores, stored.result.score().missing);
  if (!stored.matrix_checksum)
    warn(session.monitor,
         fmt::format("{}: names no matrix, as vpr-query --save-matrix makes it do; whether {} is "
                     "its own can't be known",
                     inputs.result, inputs.scores.matrix.path));
  else if (matrix.fingerprint(session.monitor) != *stored.matrix_checksum)
    throw Error(ErrorKind::data,
                fmt::format("{}: is not the matrix that {} was written with; run vpr-query again "
                            "with --save-matrix, or evaluate the matrix without the result",
                            inputs.scores.matrix.path, inputs.result));
  return matrix;
}

/// Of scores: as the data set or the sequence's folder has it.
std::string query_name(const EvalInputs& inputs) {
  if (!inputs.dataset.empty())
    return select_query(read_dataset(inputs.dataset), inputs.pictures.query).sequence.name;
  if (!inputs.pictures.query) return kUnnamedQuery;
  return sequence_names({parse_sequence_argument(*inputs.pictures.query)}).front();
}

// Where no sequence is given, names come from the query and the database of the run.
void add_recorded_names(JudgedBy& by, const StoredResult& stored) {
  const auto path_of = [&](const char* role) {
    const auto found = stored.paths.find(role);
    return found == stored.paths.end() ? std::string() : found->second;
  };
  if (const std::string query = path_of("query"); !by.query_names && !query.empty())
    by.query_names = [query] { return frame_names(parse_sequence_argument(query)); };
  const std::string database = path_of("database");
  if (!by.train_names.empty() || database.empty()) return;
  const auto trained = std::make_shared<std::vector<TrainSequence>>();  // read once, if at all
  for (size_t s = 0; s < stored.result.targets.size(); ++s)
    by.train_names.emplace_back([database, trained, s] {
      if (trained->empty()) *trained = read_sequence_database(database).sequences;
      return trained->at(s).sequence.frame_names;
    });
}

void evaluate_stored(Session& session, const EvalInputs& inputs, OpenedScores opened,
                     Evaluated& evaluated) {
  StoredResult& stored = *opened.stored;
  evaluated.by =
      judged_by(session, inputs, stored.result.query.name,
                stored.result.places ? DatabaseFamily::fabmap : DatabaseFamily::sequences);
  if (!stored.result.places) add_recorded_names(evaluated.by, stored);
  evaluated.evaluation = evaluate_result(std::move(stored.result), std::move(opened.matrix),
                                         evaluated.by, session.monitor);
  evaluated.evaluation.fingerprint = stored.fingerprint;
}

/// What a report says of --scores alone. `seed`: of a replay. Throws what replay throws.
ScoreSettings settings_of(const ScoreInputs& inputs, uint64_t seed) {
  const std::string name =
      inputs.name.empty() ? std::filesystem::path(inputs.source()).stem().string() : inputs.name;
  ScoreSettings settings{name, inputs.matrix.format(), inputs.window_length, inputs.threshold};
  if (!inputs.warp.empty())
    settings.query.selection = warped(inputs.warp, *inputs.query_frames, seed);
  return settings;
}

/// Warns where the scores find more places in the other order: --distance instead of --similarity.
void warn_reversed(const Monitor& monitor, const ScoreInputs& inputs, const Judgment& judgment) {
  const uint64_t queries = judged_queries(judgment.outcomes);
  const auto found = recall_at(judgment.outcomes, 1);
  if (!found || !judgment.all_pairs || inputs.matrix.is_distance == inputs.matrix.is_similarity)
    return;
  const double other =
      static_cast<double>(judgment.all_pairs->worst_correct) / static_cast<double>(queries);
  constexpr double kClear = 0.05;  // of the queries: more than chance
  if (other < 2 * *found || other < *found + kClear) return;
  warn(monitor,
       fmt::format("{}: R@1 is {:.1f} % with {} and {:.1f} % with {}", inputs.source(),
                   100 * *found, inputs.matrix.is_distance ? "--distance" : "--similarity",
                   100 * other, inputs.matrix.is_distance ? "--similarity" : "--distance"));
}

/// Warns where the best score of all may be what vpr-query writes where there is none.
void warn_negative(const Monitor& monitor, const ScoreInputs& inputs, const Judgment& judgment) {
  const auto& points = judgment.single_best.points;
  if (inputs.matrix.is_similarity || inputs.matrix.missing || inputs.matrix.path.empty() ||
      points.empty())
    return;
  const double best = judgment.single_best.threshold(points.front());
  const auto is_missing = [&](const ScoreKind& kind) { return best == kind.missing; };
  const auto kinds = score_kinds();
  if (std::none_of(kinds.begin(), kinds.end(), is_missing)) return;
  warn(monitor,
       fmt::format("{0}: has the distance {1}, the best there is; if it stands for a missing one, "
                   "as in a matrix of vpr-query, give --missing {1}",
                   inputs.source(), best));
}

void evaluate_matrix(Session& session, const EvalInputs& inputs, Evaluated& evaluated) {
  evaluated.by = judged_by(session, inputs, inputs.pictures.query, DatabaseFamily::sequences);
  OpenedScores opened = open_inputs(session, inputs);
  check_rows(inputs.scores, opened.matrix->queries(),
             inputs.scores.window_length > 1 ? query_frames(inputs) : std::nullopt);
  ScoreSettings settings = settings_of(inputs.scores, session.options.seed);
  settings.query.name = query_name(inputs);
  settings.format.is_similarity = opened.matrix->kind() == ScoreOrder::similarity;
  evaluated.evaluation =
      evaluate_scores(std::move(*opened.matrix), settings, evaluated.by, session.monitor);
  warn_reversed(session.monitor, inputs.scores, evaluated.evaluation.judgment);
  warn_negative(session.monitor, inputs.scores, evaluated.evaluation.judgment);
}

void require_inputs(const EvalInputs& inputs) {
  if (inputs.result.empty() && !inputs.scores.any())
    throw Error(ErrorKind::usage,
                "give a result of vpr-query, or --scores of any program; see vpr-eval --help");
}

}  // namespace

OpenedScores open_inputs(const Session& session, const EvalInputs& inputs) {
  require_inputs(inputs);
  OpenedScores opened;
  if (!inputs.result.empty()) {
    opened.stored = read_result(inputs.result, session.monitor);
    opened.matrix = open_matrix_of(session, *opened.stored, inputs);
  } else if (!inputs.scores.predictions.empty()) {
    opened.matrix.emplace(open_predictions(inputs));
  } else {
    opened.matrix.emplace(open_scores(inputs.scores));
  }
  return opened;
}

Evaluated evaluate(Session& session, const EvalInputs& inputs) {
  require_inputs(inputs);
  Evaluated evaluated;
  if (inputs.result.empty())
    evaluate_matrix(session, inputs, evaluated);
  else
    evaluate_stored(session, inputs, open_inputs(session, inputs), evaluated);
  if (!inputs.scores.name.empty()) evaluated.evaluation.name = inputs.scores.name;
  evaluated.report = report_of(evaluated.evaluation, session.run, session.monitor);
  return evaluated;
}

}  // namespace vpr
