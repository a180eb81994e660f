#include "query/sequence_query.h"

#include "base/checksum.h"
#include "base/error.h"
#include "base/text.h"
#include "database/imported.h"
#include "query/advice.h"
#include "query/open.h"
#include "query/prepare.h"
#include "query/thresholds.h"
#include "truth/frame_times.h"

namespace vpr {
namespace {

std::string fingerprint_of(const DescriptorSet& query) {
  return checksum(std::as_bytes(query.rows().bytes));
}

// Times from a video, the rate of the recording or the names of the frames, which were not made for
// this purpose: an error is one of usage.
std::vector<int64_t> own_times(const SequenceSource& source, const std::string& query,
                               const Monitor& monitor) {
  try {
    const std::optional<double> fps = source.argument.sequence.fps;
    if (fps && !states_times(source)) return even_times(count_frames(source), *fps);
    if (source.is_one_array())
      throw Error(ErrorKind::data, "{}: the rows have no times", source.argument.path.string());
    return read_frame_times(query, {}, monitor);
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
  const std::string& name = settings.past->descriptor.empty() ? usual : settings.past->descriptor;
  SequenceDatabase described;
  described.descriptors.kind = &descriptor_kind(name);
  if (described.descriptors.kind->shape.element == ElementType::points16)
    described.descriptors.unit = coordinate_unit(name, {&sequence, 1}, monitor);
  return describe_frames(sequence, described, settings.skip_unreadable, monitor);
}

QueryData describe_for(const QueryInputs& inputs, const SequenceQuerySettings& settings,
                       ResultContext& context, const Monitor& monitor) {
  QueryData data{inputs.query.name, inputs.database};
  check_automatic(*data.database, settings);
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
  const bool needs_times = std::holds_alternative<double>(settings.past->gap);
  const SequenceSource source = open_sequence(inputs.query.sequence);
  if (needs_times)
    data.times_ns = times.empty() ? own_times(source, path, monitor)
                                  : read_frame_times(times, name_reader(source.argument), monitor);
  data.query = describe_own(source, settings, monitor);
  const size_t frames = data.query.rows().size();
  if (needs_times && data.times_ns.size() != frames)
    throw Error(ErrorKind::data, "{}: has {}, and {} has {}", times.empty() ? path : times,
                counted(data.times_ns.size(), "time"), path, counted(frames, "frame"));
  data.database = std::make_shared<SequenceDatabase>(own_database(data.query, data.name));
  context.database_fingerprint = context.query_fingerprint = fingerprint_of(data.query);
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

QueryData open_query(const QueryInputs& inputs, const SequenceQuerySettings& settings,
                     ResultContext& context, const Monitor& monitor) {
  set_query_path(context.run, inputs.query.sequence);
  return inputs.database ? describe_for(inputs, settings, context, monitor)
                         : describe_loop(inputs, settings, context, monitor);
}

QueryRun run_query(const QueryData& data, const SequenceQuerySettings& settings,
                   const QueryResources& resources, const Observers& observers,
                   ResultContext& context, const Monitor& monitor) {
  context.run.memory_limit = resources.memory_limit;
  QueryPlan plan = plan_query(prepare(*data.database, settings, resources, monitor), data.query,
                              data.name, settings, resources, monitor, data.times_ns);
  if (settings.past)
    std::get<SequenceQuerySettings>(plan.result.settings).past->descriptor =
        data.query.descriptors.kind->name;
  const Sinks sinks = observers ? observers(plan) : Sinks{};
  QueryRun run = run_query(std::move(plan), sinks, monitor);
  context.seconds.insert(run.seconds.begin(), run.seconds.end());
  if (const auto sentence = excess_advice(run.result)) warn(monitor, *sentence);
  return run;
}

}  // namespace vpr
