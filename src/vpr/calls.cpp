#include "vpr/calls.h"

#include <array>
#include <chrono>
#include <span>
#include <string_view>

#include "base/error.h"
#include "base/stopwatch.h"
#include "database/archive.h"
#include "database/imported.h"
#include "evaluate/prediction_lists.h"
#include "fabmap/place_query.h"
#include "fabmap/word_training.h"
#include "present/summary.h"
#include "query/prepare.h"
#include "query/train_sequences.h"
#include "truth/frame_times.h"

namespace vpr::calls {
namespace {

std::unique_lock<std::timed_mutex> wait_for_turn(const Monitor& monitor) {
  constexpr std::chrono::milliseconds kPeriod(50);
  static std::timed_mutex turn;
  std::unique_lock lock(turn, std::defer_lock);
  while (!lock.try_lock_for(kPeriod)) check_stop(monitor);
  return lock;
}

/// A query by a sequence method.
struct SequenceQuery {
  QueryInputs inputs;
  SelectionSettings selection;
  QueryResources resources;
  SequenceQuerySettings settings;

  SequenceQuery(Keywords& keywords, QueryCommand command, QueryInputs given)
      : inputs(std::move(given)) {
    SequenceKeys keys;
    NestedObject own{[&](auto&& visit) {
      visit("max_memory", resources.memory_limit);
      if (command == QueryCommand::query) visit_fields(selection, visit);
      if (command == QueryCommand::loops) visit("frame_times", inputs.frame_times);
    }};
    keywords.read(own, keys);
    resources.seed = keywords.process.seed;
    std::vector<std::string> names;
    for (const auto& item : keywords.values.items()) names.push_back(item.key());
    settings = choose_query(keys, names, command);
    if (!inputs.frame_times.empty() &&
        !(settings.past && std::holds_alternative<double>(settings.past->gap)))
      throw Error(ErrorKind::usage, "frame_times needs a gap in seconds, loop_gap_s");
  }

  /// Adds what the settings need.
  void prepare(const DatabasePointer& database, const Monitor& monitor) {
    inputs.database = {database, &database->sequences()};
    ensure_statistics(*inputs.database, settings, monitor);
  }
};

QueryRun query_places(Keywords& keywords, bool is_loop, const Database& database,
                      NamedArgument query, ResultContext& context, const Monitor& monitor) {
  SelectionSettings selection;
  FabmapQuerySettings settings;
  is_loop ? keywords.read(settings) : keywords.read(settings, selection);
  if (settings.method != enum_name(DatabaseFamily::fabmap))
    throw Error(ErrorKind::data, "the database is a {}, which {} cannot use",
                family_text(DatabaseFamily::fabmap), settings.method);
  for (const char* key : {"loop", "loop_gap"})
    if (!is_loop && keywords.values.contains(key))
      throw Error(ErrorKind::usage, "{} has no effect on a query. Use loops", key);
  settings.loop = is_loop;
  const uint64_t seed = keywords.process.seed;
  const auto& places = std::get<FabmapDatabase>(database.content);
  query.sequence = selected(query.sequence, selection, {}, seed, monitor);
  set_query_path(context.run, query.sequence);
  const SequenceWords words =
      describe_words(open_sequence(query.sequence), places, settings.skip_unreadable, monitor);
  context.database_fingerprint = places.fingerprint;
  context.query_fingerprint = words_fingerprint(words);
  return query_fabmap(
      places, words, query.name, settings, seed, [](auto, auto) {}, monitor);
}

QueryRun query_windows(Keywords& keywords, QueryCommand command, const DatabasePointer& database,
                       QueryInputs inputs, ResultContext& context, const Monitor& monitor) {
  SequenceQuery by(keywords, command, std::move(inputs));
  if (database) {
    SequenceArgument& sequence = by.inputs.query.sequence;
    sequence = selected(sequence, by.selection, {}, keywords.process.seed, monitor);
    by.prepare(database, monitor);
    context.train =
        std::make_shared<const std::vector<TrainSequence>>(by.inputs.database->sequences);
  }
  const QueryData data = open_query(by.inputs, by.settings, context, monitor);
  return run_query(data, by.settings, by.resources, {}, context, monitor);
}

// The scores or, with the number of training frames, the ranks of indices, which are distances.
ScoreMatrix open_scores(ScoreInput& input, size_t train_frames, const Monitor& monitor) {
  if (train_frames == 0) {
    require_order(input);
    ScoreFile file = input.open();
    warn_of_indices(file, monitor);
    return ScoreMatrix(std::move(file));
  }
  const auto array = input.array ? input.array : std::make_shared<const NpyArray>(input.path);
  if (!is_index_array(*array, train_frames))
    throw Error(ErrorKind::usage,
                "train_frames is for integers, the indices of the best references of each query: a "
                "row per query, with fewer columns than training frames, as in indices[:, :100]");
  input.is_similarity = false;
  return index_scores(input.open(), train_frames);
}

}  // namespace

Keywords::Keywords(std::string name, Json given)
    : function(std::move(name)), values(std::move(given)) {
  Json own = Json::object();
  const Json known = value_to_json(process);
  for (const auto& [key, value] : values.items())
    if (known.contains(key)) own[key] = value;
  value_from_json(own, process, function, "the settings");
}

ProcessTurn::ProcessTurn(const ProcessSettings& settings, const Monitor& monitor)
    : lock_(wait_for_turn(monitor)), scope_(settings) {}

SequenceDatabase& Database::sequences() {
  if (auto* found = std::get_if<SequenceDatabase>(&content)) return *found;
  throw Error(ErrorKind::data, "the database is for fabmap, which has no frame descriptors");
}

std::vector<std::string> Database::names() const {
  return std::visit([](const auto& database) { return names_of(database); }, content);
}

std::vector<NamedArgument> named_arguments(const std::vector<Frames>& frames,
                                           const std::string& array_name) {
  std::vector<SequenceArgument> arguments;
  for (const auto& [given, source] : frames) {
    if (const auto* path = std::get_if<std::filesystem::path>(&source)) {
      arguments.push_back(parse_sequence_argument(path->string()));
      continue;
    }
    const std::string number = frames.size() > 1 ? std::to_string(arguments.size()) : "";
    const std::string name = given.empty() ? array_name + number : given;
    arguments.push_back({.path = name, .range = {}, .array = std::get<ArrayView>(source)(name)});
  }
  const std::vector<std::string> names = sequence_names(arguments);
  std::vector<NamedArgument> named;
  for (size_t i = 0; i < arguments.size(); ++i)
    named.push_back({frames[i].name.empty() ? names[i] : frames[i].name, arguments[i]});
  return named;
}

DatabasePointer train(Keywords& keywords, std::vector<NamedArgument> sequences,
                      const std::vector<SequenceArgument>& pretrain, const Monitor& monitor) {
  constexpr std::array kOfImages = {"descriptor", "illumination_invariant"};
  constexpr std::array kOfArrays = {"metric", "value_bits"};
  SelectionSettings selection;
  ImportSettings import;
  SequenceTrainSettings settings;
  FabmapTrainSettings words;
  pretrain.empty() ? keywords.read(selection, import, settings) : keywords.read(words);
  for (NamedArgument& one : sequences)
    one.sequence = selected(one.sequence, selection, {}, keywords.process.seed, monitor);
  const SequenceSource first = open_sequence(sequences.front().sequence);
  const bool has_arrays = first.kind == SequenceKind::descriptors;
  const auto refuse = [&](std::span<const char* const> keys, std::string_view what) {
    for (const char* key : keys)
      if (keywords.values.contains(key))
        throw Error(ErrorKind::usage, "{} has no effect on {}. Omit it", key, what);
  };
  if (has_arrays) refuse(kOfImages, "descriptors");
  if (!has_arrays) refuse(kOfArrays, "images");
  if (has_arrays && ArrayRows(first).type().starts_with('|'))
    refuse(kOfArrays, "bits, which uint8 and bool are");
  if (has_arrays) settings.descriptor_kind = imported_kind(first, import, monitor);
  const auto made = std::make_shared<Database>();
  if (pretrain.empty())
    made->content = train_sequences(sequences, settings, monitor);
  else
    made->content = train_fabmap(pretrain, sequences, words, keywords.process.seed, monitor);
  std::visit([](auto& content) { content.fingerprint = database_fingerprint(content); },
             made->content);
  return made;
}

DatabasePointer read_database(const std::filesystem::path& path) {
  return std::make_shared<Database>(Database{vpr::read_database(path), path.string()});
}

ResultPointer query(Keywords& keywords, QueryCommand command, const DatabasePointer& database,
                    QueryInputs inputs, const Monitor& monitor) {
  const Stopwatch watch;
  const bool is_loop = command == QueryCommand::loops;
  const bool has_places = database && std::holds_alternative<FabmapDatabase>(database->content);
  if (database && is_loop && !has_places)
    throw Error(ErrorKind::data, "loops of windows have no database. Omit it");
  const auto made = std::make_shared<StoredResult>();
  ResultContext& context = made->context;
  context.run = run_of("vpr-query", {keywords.function}, keywords.process.seed);
  if (database && !database->path.empty()) context.run.paths["database"] = database->path;
  QueryRun run =
      has_places
          ? query_places(keywords, is_loop, *database, std::move(inputs.query), context, monitor)
          : query_windows(keywords, command, database, std::move(inputs), context, monitor);
  made->result = std::move(run.result);
  context.seconds = std::move(run.seconds);
  context.seconds["total"] = watch.elapsed_s();
  return made;
}

Live::Live(Keywords& keywords, const DatabasePointer& database, const Monitor& monitor)
    : function_(keywords.function) {
  SequenceQuery by(keywords, QueryCommand::live, {});
  by.prepare(database, monitor);
  sequences_ = by.inputs.database;
  lines_.emplace(*sequences_, "live", by.settings, by.resources, monitor);
}

bool Live::has_arrays() const { return sequences_->descriptors.kind->is_imported; }

std::optional<LiveAnswer> Live::take(const LiveFrame& frame, const Monitor& monitor) {
  if (is_finished_)
    throw Error(ErrorKind::usage, "the query is finished. Make another {}", function_);
  return lines_->take(frame, monitor);
}

std::optional<LiveAnswer> Live::finish() {
  is_finished_ = true;
  return lines_->finish();
}

std::string Judged::summary() const { return summary_sentence(evaluation, std::nullopt); }

std::shared_ptr<Judged> evaluate(Keywords& keywords,
                                 const std::shared_ptr<const StoredResult>& result,
                                 ScoreInput scores, const std::optional<GroundTruthArgument>& truth,
                                 const std::string& truth_text, const Monitor& monitor) {
  const Stopwatch watch;
  EvaluationSettings by;
  ScoreSettings settings;
  std::string name;
  size_t train_frames = 0;  // of an array of indices
  GroundTruthArgument argument = truth.value_or(GroundTruthArgument{});
  NestedObject own{[&](auto&& visit) {
    visit("name", name);
    visit("format", argument.format);
    visit("tolerance", argument.tolerance_frames);
    visit_fields(argument.options, visit);
    if (result) return;
    visit_fields(scores, visit);
    visit("train_frames", train_frames);
    visit("rows_are_windows_of", settings.window_length);
    visit("threshold", settings.threshold);
  }};
  keywords.read(by, own);
  if (train_frames == 0 && keywords.values.contains("train_frames"))
    throw Error(ErrorKind::usage, "train_frames must be at least 1, found 0");
  check_evaluation(by);
  if (!result && !by.places.empty())
    throw Error(ErrorKind::usage, "places has no effect on scores. Omit it");
  const auto refuse_given = [&](std::string_view key) {
    if (!truth && keywords.values.contains(key))
      throw Error(ErrorKind::usage, "{} has no effect without a ground truth", key);
  };
  for (const std::string_view key : {"format", "tolerance"}) refuse_given(key);
  visit_fields(argument.options, [&](std::string_view key, auto&&...) { refuse_given(key); });
  if (truth) by.ground_truth = argument;
  const auto evaluate_input = [&] {
    settings.query.name = kUnnamedQuery;
    settings.method = name.empty() ? std::filesystem::path(scores.path).stem().string() : name;
    ScoreMatrix matrix = open_scores(scores, train_frames, monitor);
    settings.format = scores.format();
    require_range("rows_are_windows_of", static_cast<double>(settings.window_length), 1,
                  static_cast<double>(matrix.queries));
    Evaluation evaluation = evaluate_scores(std::move(matrix), settings, by, monitor);
    warn_of_scores(evaluation.judgment, scores, scores.path, monitor);
    return evaluation;
  };
  const auto made = std::make_shared<Judged>();
  made->evaluation = result ? evaluate_stored(result, std::nullopt, by, monitor) : evaluate_input();
  if (!name.empty()) made->evaluation.name = name;
  made->stored = result;
  made->run = run_of("vpr-eval", {keywords.function}, keywords.process.seed);
  if (truth && !truth_text.empty()) made->run.paths["ground_truth"] = truth_text;
  made->report = report_of(made->evaluation, made->run, monitor);
  made->seconds = watch.elapsed_s();
  return made;
}

void save(bool replace, const RunInfo& run, const std::function<void(Outputs& outputs)>& write) {
  Outputs outputs(replace ? Existing::replace : Existing::refuse);
  for (const auto& [role, path] : run.paths) outputs.protect(parse_sequence_argument(path).path);
  write(outputs);
  outputs.commit();
}

void save(const Database& database, const std::filesystem::path& path, bool replace) {
  save(replace, {}, [&](Outputs& outputs) {
    outputs.claim_folder(path, is_database_folder);
    write_database(path, database.content, outputs);
  });
}

void save(const StoredResult& result, const std::filesystem::path& path, bool replace) {
  if (!result.fingerprint.empty())
    throw Error(ErrorKind::usage, "the result was read from a file. Copy its files instead");
  save(replace, result.context.run, [&](Outputs& outputs) {
    claim_result(path, outputs);
    write_result(path, result.result, result.context, outputs);
  });
}

}  // namespace vpr::calls
