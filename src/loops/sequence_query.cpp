#include "loops/sequence_query.h"

#include <filesystem>

#include <fmt/format.h>

#include "base/checksum.h"
#include "base/error.h"
#include "base/text.h"
#include "loops/own_database.h"
#include "run/advice.h"
#include "run/open.h"
#include "truth/times.h"

namespace vpr {
namespace {

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
std::vector<int64_t> times_of_names(const std::string& query, const Monitor& monitor) {
  try {
    const std::vector<int64_t> times = read_frame_times(query, monitor);
    if (may_be_numbers(times))
      warn(monitor,
           fmt::format("{}: the names of its frames, {} to {}, are interpreted as seconds; if they "
                       "count frames, use --frame-times, or a gap in frames",
                       query, time_text(times.front()), time_text(times.back())));
    return times;
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::data) throw;
    throw Error(
        ErrorKind::usage,
        fmt::format("{}; a gap in seconds needs times. Use --frame-times FILE with one per line, "
                    "or a gap in frames, as in --gap 300.",
                    error.what()));
  }
}

}  // namespace

QueryData describe_for(std::shared_ptr<SequenceDatabase> database, const NamedArgument& query,
                       const ResolvedSettings& settings, ResultContext& context,
                       const Monitor& monitor) {
  QueryData data{query.name, std::move(database)};
  data.query = describe_query(query.sequence, *data.database, settings, monitor);
  set_query_path(context.run, query.sequence);
  context.database_fingerprint = data.database->fingerprint;
  context.query_fingerprint = fingerprint_of(data.query);
  if (const FusedViews* fused = fused_views(*data.database))
    context.fused_fingerprint = fused->fabmap.fingerprint;
  return data;
}

QueryData describe_loop(const NamedArgument& query, const std::string& times,
                        const SequenceQuerySettings& settings, ResultContext& context,
                        const Monitor& monitor) {
  QueryData data{query.name};
  const std::string path = argument_text(query.sequence);
  const bool needs_times = settings.loop_gap_s != 0;
  if (needs_times)
    data.times_ns =
        times.empty() ? times_of_names(path, monitor) : read_frame_times(times, monitor);
  data.query = describe_own(open_sequence(query.sequence), settings, monitor);
  const size_t frames = data.query.rows().size();
  if (needs_times && data.times_ns.size() != frames)
    throw Error(ErrorKind::data, "{}: has {}, and {} has {}", times.empty() ? path : times,
                counted(data.times_ns.size(), "time"), path, counted(frames, "frame"));
  data.database = std::make_shared<SequenceDatabase>(own_database(data.query, data.name));
  set_query_path(context.run, query.sequence);
  context.database_fingerprint = context.query_fingerprint = fingerprint_of(data.query);
  return data;
}

QueryData open_scores(const ScoreInput& scores, const std::string& name,
                      const std::vector<std::string>& ranges, const std::string& speed,
                      uint64_t seed, ResultContext& context, const Monitor& monitor) {
  require_order(scores);
  const auto distances = std::make_shared<const PrecomputedDistances>(scores.open(), monitor);
  std::vector<NamedArgument> sequences;
  for (const std::string& range : ranges)
    sequences.push_back(parse_named_range(range, "", "--train-sequence"));
  MatrixQuery made = matrix_query(*distances, sequences);
  const PrecomputedUnits& units = distances->units();
  context.scores = {scores.order(), units.best, units.unit, units.is_exact};
  context.database_fingerprint = context.query_fingerprint = distances->fingerprint(monitor);
  return {name.empty() ? std::filesystem::path(scores.path).stem().string() : name,
          std::make_shared<SequenceDatabase>(std::move(made.database)),
          selected(std::move(made.query), at_speed(speed, distances->queries(), seed)),
          {},
          distances};
}

QueryRun run_query(const QueryData& data, const ResolvedSettings& settings,
                   const QueryResources& resources, const Observers& observers,
                   ResultContext& context, const Monitor& monitor) {
  context.run.memory_limit = resources.memory_limit;
  QueryPlan plan = plan_query(*data.database, data.query, data.name, settings, resources, monitor,
                              data.times_ns);
  const Sinks sinks = observers ? observers(plan) : Sinks{};
  QueryRun run = run_query(std::move(plan), settings, resources, sinks, monitor);
  if (settings->loop)
    std::get<SequenceQuerySettings>(run.result.settings).descriptor =
        data.query.descriptors.kind->name;
  context.seconds.insert(run.seconds.begin(), run.seconds.end());
  if (const auto sentence = excess_advice(run.result)) warn(monitor, *sentence);
  return run;
}

}  // namespace vpr
