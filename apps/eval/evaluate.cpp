#include <algorithm>

#include <fmt/format.h>

#include "base/error.h"
#include "eval.h"
#include "evaluate/metrics.h"
#include "evaluate/prediction_lists.h"
#include "recordings/sequence_source.h"

namespace vpr {
namespace {

// The training sequences of --train, or those of the data set: with these names, or all.
std::vector<SequenceArgument> train_arguments(const EvalFlags& flags,
                                              const std::vector<std::string>& searched = {}) {
  std::vector<SequenceArgument> arguments;
  for (const std::string& text : flags.train) arguments.push_back(parse_sequence_argument(text));
  if (!arguments.empty() || flags.truth.dataset.empty()) return arguments;
  const std::vector<NamedSequence> train = read_dataset(flags.truth.dataset).train;
  if (searched.empty())
    for (const NamedSequence& sequence : train) arguments.push_back(sequence.sequence);
  for (const std::string& name : searched) {
    const auto found = std::ranges::find(train, name, &NamedSequence::name);
    if (found == train.end()) return {};  // of another data set, or FAB-MAP's places
    arguments.push_back(found->sequence);
  }
  return arguments;
}

// The number of query frames; unset if it is unknown.
std::optional<size_t> query_frames(const EvalFlags& flags) {
  const auto query = query_argument(flags, flags.query);
  return query && flags.scores.speed.empty() ? known_frames(*query) : std::nullopt;
}

// The number of columns of a matrix; 0 if it is unknown.
size_t train_columns(const EvalFlags& flags) {
  const size_t length = flags.scores.window_length;
  const std::vector<SequenceArgument> train = train_arguments(flags);
  if (length > 1 && train.size() > 1)
    throw Error(ErrorKind::usage,
                "--rows-are-windows-of: the columns of the scores are windows of one sequence, but "
                "there are {}. Evaluate a matrix of vpr-query with its result: vpr-eval RESULT "
                "--matrix SCORES",
                train.size());
  const size_t stated = window_count(flags.scores.train_frames.value_or(0), length);
  size_t columns = 0;
  for (const SequenceArgument& argument : train) {
    const auto frames = known_frames(argument);
    if (!frames) return stated;
    columns += window_count(*frames, length);
  }
  return columns > 0 ? columns : stated;
}

// Readers of frame names, for ground truths that need them.
void add_names(EvaluationSettings& by, const EvalFlags& flags,
               const std::optional<std::string>& query_name,
               const std::vector<std::string>& searched) {
  if (!flags.truth.dataset.empty() || flags.query)
    by.query_names = [flags, query_name] { return query_names(flags, query_name); };
  const std::vector<SequenceArgument> train = train_arguments(flags, searched);
  if (!flags.scores.source().empty() && train.size() > 1)
    by.train_names.emplace_back([flags] { return joined(train_names(flags)); });
  else
    for (const SequenceArgument& argument : train) by.train_names.push_back(name_reader(argument));
}

EvaluationSettings evaluation_settings(const EvalFlags& flags, const EvalRow& row,
                                       const StoredResult* stored) {
  const bool has_places = stored != nullptr && stored->result.places;
  const auto query_name =
      stored != nullptr ? std::optional(stored->result.query.name) : flags.query;
  EvaluationSettings by = flags.by;
  if (!flags.truth.path.empty())
    by.ground_truth = ground_truth_argument(flags.truth.path, flags.truth.flags);
  // Images of arrays are also for pages and names.
  if (by.ground_truth && !flags.scores.query_array.empty() &&
      !uses_option(*by.ground_truth, "images"))
    for (TruthSide* side : {&by.ground_truth->options.query, &by.ground_truth->options.train})
      side->images.clear();
  if (!flags.truth.dataset.empty() &&
      (!by.ground_truth || (by.poses.empty() && !row.result.empty()))) {
    const Dataset dataset = read_dataset(flags.truth.dataset);
    const DatasetQuery& query = select_query(dataset, query_name);
    if (!by.ground_truth && by.places.empty())
      by.ground_truth =
          ground_truth_of(query, has_places ? DatabaseFamily::fabmap : DatabaseFamily::sequences,
                          flags.truth.flags);
    if (by.poses.empty() && !row.result.empty()) by.poses = query.sequence.poses.string();
  }
  const GroundTruthFlags& truth = flags.truth.flags;
  const GroundTruthOptions& options = truth.options;
  const bool has_flags = truth.tolerance_frames || !truth.format.empty() ||
                         !options.reference.empty() || options.radius_m || options.angle_deg ||
                         options.ignore_radius_m || options.train_step;
  if (!by.ground_truth && (row.needs_truth || has_flags))
    throw Error(
        ErrorKind::usage,
        flags.truth.dataset.empty()
            ? "there is no ground truth. Add one, as in --ground-truth pairs.csv or --ground-truth "
              "aligned"
            : fmt::format("{}: the query has no ground truth. Add it there, or with --ground-truth",
                          flags.truth.dataset));
  std::vector<std::string> searched;
  if (stored != nullptr)
    for (const ComparedSequence& one : stored->result.sequences)
      searched.push_back(one.sequence.name);
  if (!has_places) add_names(by, flags, query_name, searched);
  return by;
}

}  // namespace

std::optional<size_t> known_frames(const SequenceArgument& argument) {
  if (const auto names = known_frame_names(argument)) return names->size();
  const SequenceSource source = open_sequence(argument);
  if (source.kind == SequenceKind::descriptors) return ArrayRows(source).count();
  return std::nullopt;
}

void compare_arrays(EvalFlags& flags) {
  ScoreInputs& scores = flags.scores;
  if (!scores.path.empty()) return;
  const std::string& dataset = flags.truth.dataset;
  std::optional<SequenceArgument> query;
  std::error_code error;
  if (flags.query) query = parse_sequence_argument(*flags.query);
  const bool is_named =
      !dataset.empty() && (!query || !std::filesystem::exists(query->path, error));
  if (is_named) query = query_argument(flags, flags.query);
  const std::vector<SequenceArgument> train = train_arguments(flags);
  if (!query || train.empty())
    throw Error(
        ErrorKind::usage,
        "scores are missing. Pass SCORES, or descriptors, as in --query tuesday.npy --train "
        "monday.npy");
  if (train.size() > 1)
    throw Error(ErrorKind::usage,
                "the query is compared with one array, but there are {} training sequences. Join "
                "their arrays, as with numpy.concatenate",
                train.size());
  scores.query_array = argument_text(*query);
  scores.train_array = argument_text(train.front());
  const GroundTruthOptions& images = flags.truth.flags.options;
  if (!is_named) flags.query.reset();
  if (!is_named && !images.query.images.empty()) flags.query = images.query.images.string();
  flags.train.clear();
  if (!images.train.images.empty()) flags.train = {images.train.images.string()};
}

namespace {

ScoreMatrix open_scores(const EvalFlags& flags, const Monitor& monitor) {
  if (is_database_folder(flags.scores.path))
    throw Error(ErrorKind::data,
                "{} is a database. Pass scores, as saved by vpr-query --save-matrix",
                flags.scores.path);
  const ScoreInputs& scores = flags.scores;
  if (!scores.query_array.empty())
    return descriptor_scores(open_sequence(parse_sequence_argument(scores.query_array)),
                             open_sequence(parse_sequence_argument(scores.train_array)),
                             scores.metric, monitor);
  if (!scores.is_list()) {
    const size_t columns = train_columns(flags);
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
  std::optional<ScoreOrder> kind;
  if (scores.matrix.has_order()) kind = scores.matrix.order();
  return prediction_scores(scores.path, FrameNames(query_names(flags)),
                           FrameNames(joined(train_names(flags))), kind,
                           {scores.query_frames, scores.train_frames}, monitor);
}

std::optional<ScoreMatrix> open_saved_matrix(const Session& session, const StoredResult& stored,
                                             const EvalRow& row) {
  const std::string& path = row.matrix;
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
         row.result, path);
  else if (matrix.fingerprint(session.monitor) != saved->second.checksum)
    throw Error(ErrorKind::data,
                "{}: is not the matrix that {} was written with. Run vpr-query again with "
                "--save-matrix, or use vpr-eval matrix",
                path, row.result);
  return matrix;
}

ScoreSettings score_settings(const EvalFlags& flags, const EvalRow& row, const ScoreMatrix& matrix,
                             uint64_t seed) {
  const ScoreInputs& scores = flags.scores;
  ScoreSettings settings{row.name, scores.matrix.format(), scores.window_length, scores.threshold};
  settings.format.is_similarity = matrix.kind == ScoreOrder::similarity;
  if (!scores.speed.empty())
    settings.query.selection = at_speed(scores.speed, *scores.query_frames, seed);
  if (!flags.query_name.empty())
    settings.query.name = flags.query_name;
  else if (!flags.truth.dataset.empty())
    settings.query.name =
        select_query(read_dataset(flags.truth.dataset), flags.query).sequence.name;
  else if (flags.query)
    settings.query.name = sequence_names({parse_sequence_argument(*flags.query)}).front();
  else if (!scores.query_array.empty())
    settings.query.name = parse_sequence_argument(scores.query_array).path.stem().string();
  else
    settings.query.name = kUnnamedQuery;
  return settings;
}

// Warns if rows may belong to the images in another order.
void warn_of_order(const Session& session, const EvalFlags& flags, const ScoreMatrix& matrix) {
  if (matrix.has_names || session.options.process.order != FrameOrder::automatic) return;
  std::vector<SequenceArgument> sides = train_arguments(flags);
  if (const auto query = query_argument(flags, flags.query)) sides.push_back(*query);
  const GroundTruthOptions& truth = flags.truth.flags.options;
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

std::optional<SequenceArgument> query_argument(const EvalFlags& flags,
                                               const std::optional<std::string>& name) {
  if (flags.truth.dataset.empty())
    return flags.query ? std::optional(parse_sequence_argument(*flags.query)) : std::nullopt;
  const Dataset dataset = read_dataset(flags.truth.dataset);
  const bool is_named =
      name && std::ranges::any_of(dataset.queries, [&](const DatasetQuery& query) {
        return query.sequence.name == *name;
      });
  return select_query(dataset, is_named ? name : flags.query).sequence.sequence;
}

std::vector<std::string> query_names(const EvalFlags& flags,
                                     const std::optional<std::string>& query) {
  const auto argument = query_argument(flags, query);
  return argument ? frame_names(*argument) : std::vector<std::string>{};
}

std::vector<std::vector<std::string>> train_names(const EvalFlags& flags,
                                                  const std::vector<std::string>& searched) {
  std::vector<std::vector<std::string>> names;
  for (const SequenceArgument& argument : train_arguments(flags, searched))
    names.push_back(frame_names(argument));
  return names;
}

std::vector<std::string> joined(const std::vector<std::vector<std::string>>& names) {
  std::vector<std::string> all;
  for (const auto& one : names) all.insert(all.end(), one.begin(), one.end());
  return all;
}

OpenedScores open_inputs(const Session& session, const EvalFlags& flags, const EvalRow& row) {
  OpenedScores opened;
  if (!row.result.empty()) {
    opened.stored = std::make_shared<const StoredResult>(read_result(row.result, session.monitor));
    opened.matrix = open_saved_matrix(session, *opened.stored, row);
  } else if (!flags.scores.source().empty()) {
    opened.matrix.emplace(open_scores(flags, session.monitor));
  } else {
    throw Error(ErrorKind::usage,
                "the result of vpr-query is missing, as in vpr-eval result.json. For scores, use "
                "vpr-eval matrix SCORES");
  }
  return opened;
}

Evaluated evaluate(Session& session, const EvalFlags& flags, const EvalRow& row) {
  auto [stored, matrix] = open_inputs(session, flags, row);
  Evaluated evaluated;
  Evaluation& evaluation = evaluated.evaluation;
  evaluated.by = evaluation_settings(flags, row, stored.get());
  if (stored) {
    evaluated.stored = stored;
    evaluation = evaluate_stored(stored, std::move(matrix), evaluated.by, session.monitor);
  } else {
    warn_of_order(session, flags, *matrix);
    check_rows(flags.scores, matrix->queries, query_frames(flags));
    const ScoreSettings settings =
        score_settings(flags, row, *matrix, session.options.process.seed);
    evaluation = evaluate_scores(std::move(*matrix), settings, evaluated.by, session.monitor);
    warn_of_scores(evaluation.judgment, flags.scores.matrix, flags.scores.source(),
                   session.monitor);
  }
  if (row.is_named) evaluation.name = row.name;
  if (!flags.data_set.empty()) evaluation.data_set = flags.data_set;
  evaluated.report = report_of(evaluation, session.run, session.monitor);
  evaluated.report.row_name = row.name;
  return evaluated;
}

}  // namespace vpr
