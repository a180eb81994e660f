#include "eval_inputs.h"

#include <algorithm>
#include <memory>

#include <fmt/format.h>

#include "base/error.h"
#include "base/json.h"
#include "present/evaluation_report.h"
#include "present/result_file.h"
#include "sequence/sequence.h"
#include "sequence/sequence_argument.h"
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
      return trained->at(s).frame_names;
    });
}

void evaluate_stored(Session& session, const EvalInputs& inputs, OpenedScores opened,
                     Evaluated& evaluated) {
  StoredResult& stored = *opened.stored;
  evaluated.by =
      judged_by(session, inputs, stored.result.query_name,
                stored.result.places ? DatabaseFamily::fabmap : DatabaseFamily::sequences);
  if (!stored.result.places) add_recorded_names(evaluated.by, stored);
  evaluated.evaluation = evaluate_result(std::move(stored.result), std::move(opened.matrix),
                                         evaluated.by, session.monitor);
  evaluated.evaluation.fingerprint = stored.fingerprint;
}

void evaluate_matrix(Session& session, const EvalInputs& inputs, Evaluated& evaluated) {
  evaluated.by = judged_by(session, inputs, inputs.pictures.query, DatabaseFamily::sequences);
  OpenedScores opened = open_inputs(session, inputs);
  check_rows(inputs.scores, opened.matrix->queries(),
             inputs.scores.window_length > 1 ? query_frames(inputs) : std::nullopt);
  ScoreSettings settings = settings_of(inputs.scores, session.options.seed);
  settings.format.is_similarity = opened.matrix->kind() == ScoreOrder::similarity;
  evaluated.evaluation = evaluate_scores(std::move(*opened.matrix), settings, query_name(inputs),
                                         evaluated.by, session.monitor);
  warn_reversed(session.monitor, inputs.scores, evaluated.evaluation.judgement);
  warn_negative(session.monitor, inputs.scores, evaluated.evaluation.judgement);
}

void require_inputs(const EvalInputs& inputs) {
  if (inputs.result.empty() && !inputs.scores.any())
    throw Error(ErrorKind::usage,
                "give a result of vpr-query, or --scores of any program; see vpr-eval --help");
}

}  // namespace

EvalInputs inputs_of(const EvalInputs& inputs, size_t i) {
  const auto& paths = inputs.results.empty() ? std::vector{inputs.scores.source()} : inputs.results;
  EvalInputs one = inputs;
  one.row_name = row_names(inputs.names, paths)[i];
  if (!inputs.results.empty()) one.result = inputs.results[i];
  if (!inputs.names.empty()) one.scores.name = inputs.names[i];
  return one;
}

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

std::vector<std::string> row_names(const std::vector<std::string>& given,
                                   const std::vector<std::string>& paths) {
  if (!given.empty()) return given;
  std::vector<std::string> stems;
  for (const std::string& path : paths)
    stems.push_back(std::filesystem::path(path).stem().string());
  std::vector<std::string> names = stems;
  for (size_t i = 0; i < names.size(); ++i)
    if (std::count(stems.begin(), stems.end(), stems[i]) > 1)
      names[i] = fmt::format("{} ({})", stems[i], i + 1);
  return names;
}

}  // namespace vpr
