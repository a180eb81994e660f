#include <algorithm>

#include <fmt/format.h>

#include "base/error.h"
#include "eval.h"
#include "evaluate/metrics.h"
#include "evaluate/prediction_lists.h"
#include "sequence/sequence_source.h"

namespace vpr {
namespace {

// The data set's query of this name, or the sequence that --query names.
std::optional<SequenceArgument> query_argument(const EvalInputs& inputs,
                                               const std::optional<std::string>& query) {
  if (!inputs.truth.dataset.empty())
    return select_query(read_dataset(inputs.truth.dataset), query).sequence.sequence;
  return query ? std::optional(parse_sequence_argument(*query)) : std::nullopt;
}

std::vector<SequenceArgument> train_arguments(const EvalInputs& inputs) {
  std::vector<SequenceArgument> arguments;
  for (const std::string& text : inputs.train) arguments.push_back(parse_sequence_argument(text));
  if (arguments.empty() && !inputs.truth.dataset.empty())
    for (const NamedSequence& sequence : read_dataset(inputs.truth.dataset).train)
      arguments.push_back(sequence.sequence);
  return arguments;
}

// The number of query frames; unset if it is unknown, as of a video.
std::optional<size_t> query_frames(const EvalInputs& inputs) {
  const auto query = query_argument(inputs, inputs.query);
  const auto names = query ? known_frame_names(*query) : std::nullopt;
  return names && inputs.scores.speed.empty() ? std::optional(names->size()) : std::nullopt;
}

// The number of columns of a matrix; 0 if it is unknown, as of a video.
size_t train_columns(const EvalInputs& inputs) {
  const size_t length = inputs.scores.window_length;
  const size_t stated = window_count(inputs.scores.train_frames.value_or(0), length);
  size_t columns = 0;
  for (const SequenceArgument& argument : train_arguments(inputs)) {
    const auto names = known_frame_names(argument);
    if (!names) return stated;
    columns += window_count(names->size(), length);
  }
  return columns > 0 ? columns : stated;
}

// Readers of frame names, for ground truths that need them.
void add_names(EvaluationSettings& by, const EvalInputs& inputs,
               const std::optional<std::string>& query_name) {
  const auto& query = inputs.truth.dataset.empty() ? inputs.query : query_name;
  if (!inputs.truth.dataset.empty() || query)
    by.query_names = [inputs, query] { return frame_names(*query_argument(inputs, query)); };
  for (const SequenceArgument& argument : train_arguments(inputs))
    by.train_names.emplace_back([argument] { return frame_names(argument); });
}

EvaluationSettings evaluation_settings(const EvalInputs& inputs,
                                       const std::optional<std::string>& query_name,
                                       DatabaseFamily family) {
  EvaluationSettings by = inputs.by;
  if (!inputs.truth.path.empty())
    by.ground_truth = ground_truth_argument(inputs.truth.path, inputs.truth.flags);
  if (!inputs.truth.dataset.empty() &&
      (!by.ground_truth || (by.poses.empty() && !inputs.result.empty()))) {
    const Dataset dataset = read_dataset(inputs.truth.dataset);
    const DatasetQuery& query = select_query(dataset, query_name);
    if (!by.ground_truth && by.places.empty())
      by.ground_truth = ground_truth_of(query, family, inputs.truth.flags);
    if (by.poses.empty() && !inputs.result.empty()) by.poses = query.sequence.poses.string();
  }
  const GroundTruthFlags& flags = inputs.truth.flags;
  const bool has_flags =
      flags.tolerance_frames || !flags.format.empty() || !flags.options.reference.empty();
  if (!by.ground_truth && (inputs.needs_truth || has_flags))
    throw Error(
        ErrorKind::usage,
        inputs.truth.dataset.empty()
            ? "there is no ground truth. Add one, as in --ground-truth pairs.csv or --ground-truth "
              "aligned"
            : fmt::format("{}: the query has no ground truth. Add it there, or with --ground-truth",
                          inputs.truth.dataset));
  if (family == DatabaseFamily::sequences) add_names(by, inputs, query_name);
  return by;
}

ScoreMatrix open_scores(const EvalInputs& inputs, const Monitor& monitor) {
  const ScoreInputs& scores = inputs.scores;
  if (!scores.query_npy.empty())
    return descriptor_scores(open_sequence(parse_sequence_argument(scores.query_npy)),
                             open_sequence(parse_sequence_argument(scores.train_npy)),
                             scores.metric, monitor);
  if (!scores.is_list()) {
    const size_t columns = train_columns(inputs);
    if (!scores.matrix.train_first && is_index_array(NpyArray(scores.path), columns)) {
      refuse(scores.matrix.has_order() || scores.matrix.missing.has_value(), scores.path,
             "has integers in fewer columns than there are training frames, as indices of "
             "references are; omit the flags of scores or, for scores, save one column per frame");
      return index_scores(ScoreFile(scores.path, {}), columns);
    }
    ScoreFile file(scores.path, scores.matrix.format());
    require_order(scores.matrix);
    warn_of_indices(file, monitor);
    ScoreMatrix matrix(std::move(file));
    if (columns > 0 && matrix.references != columns)
      throw Error(ErrorKind::data,
                  "{}: has {} columns, but the training frames need {}. Pass the sequences that "
                  "were compared, or save one column per training frame",
                  scores.path, matrix.references, columns);
    return matrix;
  }
  std::vector<std::string> references;
  for (const auto& names : train_names(inputs))
    references.insert(references.end(), names.begin(), names.end());
  std::optional<ScoreOrder> kind;
  if (scores.matrix.has_order()) kind = scores.matrix.order();
  return prediction_scores(scores.path, FrameNames(query_names(inputs)), FrameNames(references),
                           kind, {scores.query_frames, scores.train_frames}, monitor);
}

std::optional<ScoreMatrix> open_saved_matrix(const Session& session, const StoredResult& stored,
                                             const EvalInputs& inputs) {
  const std::string& path = inputs.matrix;
  if (path.empty()) return std::nullopt;
  if (stored.result.places || stored.result.path)
    throw Error(ErrorKind::usage,
                "a result of {} has no matrix of its best matches. Use vpr-eval matrix SCORES",
                stored.result.places ? "FAB-MAP" : "the filter");
  ScoreMatrix matrix(path, {false, false, stored.result.score().missing});
  const auto saved = stored.context.files.find("matrix");
  if (saved == stored.context.files.end())
    warn(session.monitor,
         "{}: no matrix was saved with this result (vpr-query --save-matrix); {} may belong to "
         "another one",
         inputs.result, path);
  else if (matrix.fingerprint(session.monitor) != saved->second.checksum)
    throw Error(ErrorKind::data,
                "{}: is not the matrix that {} was written with. Run vpr-query again with "
                "--save-matrix, or use vpr-eval matrix",
                path, inputs.result);
  return matrix;
}

ScoreSettings score_settings(const EvalInputs& inputs, const ScoreMatrix& matrix, uint64_t seed) {
  const ScoreInputs& scores = inputs.scores;
  ScoreSettings settings{
      inputs.name.empty() ? std::filesystem::path(scores.source()).stem().string() : inputs.name,
      scores.matrix.format(), scores.window_length, scores.threshold};
  settings.format.is_similarity = matrix.kind == ScoreOrder::similarity;
  if (!scores.speed.empty())
    settings.query.selection = at_speed(scores.speed, *scores.query_frames, seed);
  if (!inputs.truth.dataset.empty())
    settings.query.name =
        select_query(read_dataset(inputs.truth.dataset), inputs.query).sequence.name;
  else if (inputs.query)
    settings.query.name = sequence_names({parse_sequence_argument(*inputs.query)}).front();
  else
    settings.query.name = kUnnamedQuery;
  return settings;
}

// Warns if rows may belong to the images in another order.
void warn_of_order(const Session& session, const EvalInputs& inputs, const ScoreMatrix& matrix) {
  if (matrix.has_names || session.options.process.order != FrameOrder::automatic) return;
  std::vector<SequenceArgument> sides = train_arguments(inputs);
  if (const auto query = query_argument(inputs, inputs.query)) sides.push_back(*query);
  const GroundTruthOptions& truth = inputs.truth.flags.options;
  for (const auto& images : {truth.query.images, truth.train.images})
    if (!images.empty()) sides.push_back(parse_sequence_argument(images.string()));
  for (const SequenceArgument& side : sides) {
    const auto names = known_frame_names(side);
    if (!names || std::ranges::is_sorted(*names)) continue;
    const auto later = std::ranges::is_sorted_until(*names);
    return warn(session.monitor,
                "rows belong to images in natural order ({} before {}). If the program that wrote "
                "them sorted names as text, add --order name",
                *(later - 1), *later);
  }
}

}  // namespace

std::vector<std::string> query_names(const EvalInputs& inputs) {
  const auto query = query_argument(inputs, inputs.query);
  return query ? frame_names(*query) : std::vector<std::string>{};
}

std::vector<std::vector<std::string>> train_names(const EvalInputs& inputs) {
  std::vector<std::vector<std::string>> names;
  for (const SequenceArgument& argument : train_arguments(inputs))
    names.push_back(frame_names(argument));
  return names;
}

OpenedScores open_inputs(const Session& session, const EvalInputs& inputs) {
  OpenedScores opened;
  if (!inputs.result.empty()) {
    opened.stored =
        std::make_shared<const StoredResult>(read_result(inputs.result, session.monitor));
    opened.matrix = open_saved_matrix(session, *opened.stored, inputs);
  } else if (!inputs.scores.source().empty()) {
    opened.matrix.emplace(open_scores(inputs, session.monitor));
  } else {
    throw Error(ErrorKind::usage,
                "the result of vpr-query is missing, as in vpr-eval result.json. For scores, use "
                "vpr-eval matrix SCORES");
  }
  return opened;
}

Evaluated evaluate(Session& session, const EvalInputs& inputs) {
  auto [stored, matrix] = open_inputs(session, inputs);
  const bool has_places = stored && stored->result.places;
  Evaluated evaluated;
  Evaluation& evaluation = evaluated.evaluation;
  evaluated.by =
      evaluation_settings(inputs, stored ? std::optional(stored->result.query.name) : inputs.query,
                          has_places ? DatabaseFamily::fabmap : DatabaseFamily::sequences);
  if (stored) {
    evaluated.stored = stored;
    evaluation = evaluate_stored(stored, std::move(matrix), evaluated.by, session.monitor);
  } else {
    warn_of_order(session, inputs, *matrix);
    check_rows(inputs.scores, matrix->queries, query_frames(inputs));
    const ScoreSettings settings = score_settings(inputs, *matrix, session.options.process.seed);
    evaluation = evaluate_scores(std::move(*matrix), settings, evaluated.by, session.monitor);
    warn_of_scores(evaluation.judgment, inputs.scores.matrix, inputs.scores.source(),
                   session.monitor);
  }
  if (!inputs.name.empty()) evaluation.name = inputs.name;
  evaluated.report = report_of(evaluation, session.run, session.monitor);
  evaluated.report.row_name = inputs.row_name;
  return evaluated;
}

}  // namespace vpr
