#include "loops/sequence_query.h"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>

#include "base/checksum.h"
#include "base/error.h"
#include "base/text.h"
#include "describe/imported.h"
#include "match/components.h"
#include "run/advice.h"
#include "run/open.h"
#include "truth/times.h"

namespace vpr {
namespace {

void append_frames(SequenceDatabase& database, const PrecomputedDistances& matrix,
                   const NamedArgument& argument) {
  const FrameRange& range = argument.sequence.range;
  const uint64_t last = range.last.value_or(matrix.references());
  if (range.first >= last || last > matrix.references())
    throw Error(ErrorKind::usage,
                "the training sequence {} has the range {}, and the matrix has {}", argument.name,
                range_text(range), counted(matrix.references(), "reference"));
  for (const TrainSequence& before : database.sequences)
    if (before.sequence.name == argument.name)
      throw Error(ErrorKind::usage, "duplicate name of training sequences: {}", argument.name);
  Sequence& sequence = database.sequences.emplace_back().sequence;
  sequence.name = argument.name;
  const std::vector<size_t>& empty = matrix.empty_references();
  for (uint64_t number = range.first; number < last; number += range.step) {
    if (std::binary_search(empty.begin(), empty.end(), number))
      sequence.unreadable.push_back(sequence.frames);
    sequence.frame_names.push_back(fmt::format("#{}", number));
    ++sequence.frames;
    append_frame_numbers(database.descriptors.owned, number, 1);
  }
}

// The variance of the distances of the first readable query frame.
double first_variance(const QueryData& made) {
  const std::vector<DescribedFrames> train = descriptor_spans(*made.database);
  const std::vector<FrameStretch> queries = readable_runs(made.query.span());
  const FrameDistances distances = frame_distances(train, made.query.span());
  if (queries.empty() || distances.readable_frames == 0) return 0;
  const size_t query = queries.front().first;
  const double mean = row_mean(distances, query);
  std::vector<uint16_t> row;
  compute_row(distances, query, row);
  double squares = 0;
  for (const FrameStretch& run : distances.train_runs)
    for (size_t i = run.first; i < run.first + run.count; ++i)
      squares += (row[i] - mean) * (row[i] - mean);
  return squares / static_cast<double>(distances.readable_frames);
}

std::string fingerprint_of(const DescriptorSet& query) {
  return checksum(std::as_bytes(query.rows().bytes));
}

// Integer seconds in steps of one are possibly numbers of frames.
bool may_be_numbers(const std::vector<int64_t>& times) {
  for (size_t f = 1; f < times.size(); ++f)
    if (times[f] - times[f - 1] != kSecond) return false;
  return times.size() > 1 && times.front() % kSecond == 0;
}

// Times from the names of the frames, which were not made for this purpose: an error is one of
// usage.
std::vector<int64_t> times_of_names(const SequenceSource& source, const std::string& query,
                                    const Monitor& monitor) {
  try {
    if (source.is_one_array())
      throw Error(ErrorKind::data, "{}: the rows have no times", source.argument.path.string());
    const std::vector<int64_t> times = read_frame_times(query, monitor);
    if (may_be_numbers(times))
      warn(monitor,
           "{}: the names of its frames, {} to {}, are interpreted as seconds; if they count "
           "frames, use --frame-times, or a gap in frames",
           query, time_text(times.front()), time_text(times.back()));
    return times;
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::data) throw;
    throw Error(ErrorKind::usage,
                "{}; a gap in seconds needs times. Use --frame-times FILE with one per line, or a "
                "gap in frames, as in --gap 300.",
                error.what());
  }
}

DescriptorSet describe_own(const SequenceSource& sequence, const SequenceQuerySettings& settings,
                           const Monitor& monitor) {
  const bool is_imported = sequence.kind == SequenceKind::descriptors;
  const std::string usual(is_imported ? imported_kind(sequence, {}, monitor) : "ldb");
  const std::string& name = settings.descriptor.empty() ? usual : settings.descriptor;
  SequenceDatabase described;
  described.descriptors.kind = &descriptor_kind(name);
  if (described.descriptors.kind->shape.element == ElementType::points16)
    described.descriptors.unit = coordinate_unit(name, {&sequence, 1}, monitor);
  return describe_frames(sequence, described, settings.skip_unreadable, monitor);
}

QueryData describe_for(const QueryInputs& inputs, const ResolvedSettings& settings,
                       ResultContext& context, const Monitor& monitor) {
  QueryData data{inputs.query.name, inputs.database};
  data.query = describe_query(inputs.query.sequence, *data.database, settings, monitor);
  context.database_fingerprint = data.database->fingerprint;
  context.query_fingerprint = fingerprint_of(data.query);
  return data;
}

QueryData describe_loop(const QueryInputs& inputs, const SequenceQuerySettings& settings,
                        ResultContext& context, const Monitor& monitor) {
  QueryData data{inputs.query.name};
  const std::string& times = inputs.frame_times;
  const std::string path = argument_text(inputs.query.sequence);
  const bool needs_times = settings.loop_gap_s != 0;
  const SequenceSource source = open_sequence(inputs.query.sequence);
  if (needs_times)
    data.times_ns =
        times.empty() ? times_of_names(source, path, monitor) : read_frame_times(times, monitor);
  data.query = describe_own(source, settings, monitor);
  const size_t frames = data.query.rows().size();
  if (needs_times && data.times_ns.size() != frames)
    throw Error(ErrorKind::data, "{}: has {}, and {} has {}", times.empty() ? path : times,
                counted(data.times_ns.size(), "time"), path, counted(frames, "frame"));
  data.database = std::make_shared<SequenceDatabase>(own_database(data.query, data.name));
  context.database_fingerprint = context.query_fingerprint = fingerprint_of(data.query);
  return data;
}

QueryData open_scores(const QueryInputs& inputs, ResultContext& context, const Monitor& monitor) {
  const ScoreInput& scores = inputs.scores;
  require_order(scores);
  const auto distances = std::make_shared<const PrecomputedDistances>(scores.open(), monitor);
  std::vector<NamedArgument> sequences;
  for (const std::string& range : inputs.train_sequences)
    sequences.push_back(parse_named_range(range, "", "--train-sequence"));
  QueryData data = matrix_query(*distances, sequences);
  if (!scores.array) context.run.paths["scores"] = scores.path;
  context.scores = distances->units();
  context.database_fingerprint = context.query_fingerprint = distances->fingerprint(monitor);
  const std::string& name = inputs.query.name;
  const SequenceArgument& query = inputs.query.sequence;
  data.name = name.empty() ? std::filesystem::path(scores.path).stem().string() : name;
  data.query =
      selected(std::move(data.query), at_speed(query.speed, distances->queries(), query.seed));
  data.scores = distances;
  return data;
}

}  // namespace

SequenceDatabase own_database(const DescriptorSet& query, const std::string& name) {
  SequenceDatabase database;
  database.descriptors.kind = query.descriptors.kind;
  database.descriptors.unit = query.descriptors.unit;
  database.descriptors.append(query.rows());
  database.sequences.push_back({query.sequence});
  database.sequences.back().sequence.name = name;
  database.overlapping_sequences.emplace();
  return database;
}

QueryData matrix_query(const PrecomputedDistances& matrix,
                       const std::vector<NamedArgument>& sequences) {
  QueryData made{"", std::make_shared<SequenceDatabase>()};
  SequenceDatabase& database = *made.database;
  database.descriptors.kind = &precomputed_kind();
  if (sequences.empty()) append_frames(database, matrix, {"references", {}});
  for (const NamedArgument& sequence : sequences) append_frames(database, matrix, sequence);
  made.query.descriptors.kind = &precomputed_kind();
  append_frame_numbers(made.query.descriptors.owned, 0, matrix.queries());
  Sequence& query = made.query.sequence;
  query.frames = matrix.queries();
  for (size_t i = 0; i < query.frames; ++i) query.frame_names.push_back(fmt::format("#{}", i));
  query.unreadable = matrix.empty_queries();
  made.query.precomputed = &matrix;
  const size_t frames = database.descriptors.rows().size();
  database.overlapping_sequences.emplace();
  database.statistics =
      TrainStatistics{{},
                      0,
                      std::vector<float>(frames, 0),
                      std::vector<float>(frames, static_cast<float>(first_variance(made))),
                      no_components(frames)};
  return made;
}

QueryData open_query(const QueryInputs& inputs, const ResolvedSettings& settings,
                     ResultContext& context, const Monitor& monitor) {
  if (!inputs.scores.path.empty()) return open_scores(inputs, context, monitor);
  set_query_path(context.run, inputs.query.sequence);
  return inputs.database ? describe_for(inputs, settings, context, monitor)
                         : describe_loop(inputs, *settings, context, monitor);
}

QueryRun run_query(const QueryData& data, const ResolvedSettings& settings,
                   const QueryResources& resources, const Observers& observers,
                   ResultContext& context, const Monitor& monitor) {
  context.run.memory_limit = resources.memory_limit;
  QueryPlan plan = plan_query(*data.database, data.query, data.name, settings, resources, monitor,
                              data.times_ns);
  if (settings->loop)
    std::get<SequenceQuerySettings>(plan.result.settings).descriptor =
        data.query.descriptors.kind->name;
  const Sinks sinks = observers ? observers(plan) : Sinks{};
  QueryRun run = run_query(std::move(plan), sinks, monitor);
  context.seconds.insert(run.seconds.begin(), run.seconds.end());
  if (const auto sentence = excess_advice(run.result)) warn(monitor, *sentence);
  return run;
}

}  // namespace vpr
