#include "tune_inputs.h"

#include <algorithm>
#include <limits>

#include <fmt/format.h>

#include "base/error.h"
#include "common/selection_flags.h"
#include "sequence/sequence_source.h"
#include "store/sequence_database.h"

namespace vpr {

namespace {

// A query of a data set, with the flags' changes to its ground truth.
Source find_in_dataset(const TuneInputs& inputs, const std::string& path, const std::string& name,
                       DatabaseFamily family, const Session& session) {
  const Dataset dataset = read_dataset(path);
  const DatasetQuery& query =
      select_query(dataset, name.empty() ? std::nullopt : std::optional(name));
  auto truth = ground_truth_of(query, family, inputs.flags);
  if (!truth)
    throw Error(ErrorKind::usage,
                fmt::format("{}: the query {} has no ground truth", path, query.sequence.name));
  NamedSequence sequence = query.sequence;
  sequence.sequence =
      selected(sequence.sequence, inputs.selection, truth->options.query_times, &dataset, session);
  leave_times_to_rate(*truth, inputs.selection);
  return {sequence, *truth};
}

// A sequence and a ground truth as the command line names them.
Source parse_source(const TuneInputs& inputs, const std::string& sequence,
                    const std::string& ground_truth, const Session& session) {
  const SequenceArgument argument = parse_sequence_argument(sequence);
  GroundTruthArgument truth = ground_truth_argument(ground_truth, inputs.flags);
  const NamedSequence named = {
      sequence_names({argument}).front(),
      selected(argument, inputs.selection, truth.options.query_times, nullptr, session)};
  leave_times_to_rate(truth, inputs.selection);
  return {named, truth};
}

bool share_frames(const SequenceArgument& a, const SequenceArgument& b) {
  constexpr uint64_t kEnd = std::numeric_limits<uint64_t>::max();
  return a.path == b.path && a.range.first < b.range.last.value_or(kEnd) &&
         b.range.first < a.range.last.value_or(kEnd);
}

std::vector<Source> find_queries(const TuneInputs& inputs, DatabaseFamily family,
                                 const Session& session) {
  std::vector<Source> queries;
  for (const std::string& path : inputs.datasets)
    queries.push_back(find_in_dataset(inputs, path, inputs.query, family, session));
  if (!queries.empty()) return queries;
  if (inputs.query.empty() || inputs.ground_truth.empty())
    throw Error(ErrorKind::usage,
                "give --query and --ground-truth, or data sets that have both (--dataset)");
  return {parse_source(inputs, inputs.query, inputs.ground_truth, session)};
}

std::optional<Source> find_validation(const TuneInputs& inputs, DatabaseFamily family,
                                      const Session& session) {
  const bool in_dataset = inputs.validate_ground_truth.empty() && inputs.datasets.size() == 1;
  if (inputs.validate.empty() != inputs.validate_ground_truth.empty() && !in_dataset)
    throw Error(ErrorKind::usage,
                "give both --validate and --validate-ground-truth, or with one --dataset the name "
                "of another of its queries as --validate");
  if (inputs.validate.empty()) return std::nullopt;
  return in_dataset
             ? find_in_dataset(inputs, inputs.datasets.front(), inputs.validate, family, session)
             : parse_source(inputs, inputs.validate, inputs.validate_ground_truth, session);
}

}  // namespace

TruthReader reader_of(const Source& source, const SequenceDatabase* database,
                      const Monitor& monitor) {
  return [&, database](GroundTruthScope scope) {
    scope.query_names = [&] { return frame_names(source.sequence.sequence); };
    if (database != nullptr)
      for (size_t s = 0; s < scope.sequences.size(); ++s)
        scope.sequences[s].names = [database, s] {
          return database->sequences[s].sequence.frame_names;
        };
    return read_ground_truth(source.ground_truth, scope, monitor);
  };
}

Sources find_sources(const TuneInputs& inputs, DatabaseFamily family, const Session& session) {
  if (!inputs.selection.warp.empty()) check_warp(inputs.selection.warp);
  Sources sources{find_queries(inputs, family, session), find_validation(inputs, family, session)};
  if (!sources.validation) return sources;
  const SequenceArgument& validation = sources.validation->sequence.sequence;
  for (const Source& query : sources.queries)
    if (share_frames(query.sequence.sequence, validation))
      warn(session.monitor,
           fmt::format("{}: is also what the setting is chosen on; a validation needs "
                       "frames that were not seen",
                       validation.path.string()));
  return sources;
}

std::vector<Sweep> sweep_all(const Sources& sources, const SequenceDatabase* database,
                             const SweepQuery& sweep, const Monitor& monitor) {
  std::vector<Sweep> sweeps;
  std::optional<Grid> grid;
  for (const Source& query : sources.queries) {
    Sweep& found = sweeps.emplace_back(
        sweep(query, grid ? &*grid : nullptr, reader_of(query, database, monitor)));
    grid = grid_of(found.cells);
    const auto& recommended = found.recommendation.cell;
    if (!recommended || !sources.validation) continue;
    const Source& other = *sources.validation;
    const Grid one = grid_of({&found.cells[*recommended], 1});
    found.validation = {other.sequence.name,
                        sweep(other, &one, reader_of(other, database, monitor)).cells.front()};
  }
  return sweeps;
}

void add_tune_inputs(const Command& command, TuneInputs& inputs) {
  command.add_option("DB", inputs.database, "database made by vpr-train").required();
  command.add_option("--query", inputs.query, "query sequence, or with --dataset the name of one");
  command.add_option("--ground-truth", inputs.ground_truth, ground_truth_help());
  command.add_list("--dataset", inputs.datasets,
                   "data set description with query and ground truth; repeatable");
  command.add_option("--save-config", inputs.save_config,
                     "the recommended settings as a file for vpr-query --config; exit code 5 if "
                     "none is recommended");
  command.add_option("--validate", inputs.validate,
                     "another query, on which the recommended setting is reported; with one "
                     "--dataset, the name of another of its queries");
  command.add_option("--validate-ground-truth", inputs.validate_ground_truth,
                     "its ground truth, read like the other");
  add_warp_flag(command, inputs.selection.warp);
  add_rate_flags(command, inputs.selection, "queries");
  add_ground_truth_flags(command, inputs.flags);
  command.add_option("--heat-map", inputs.heat_map,
                     "picture (PNG) of correct and incorrect recognitions over the grid");
  command.add_option("--plot", inputs.plots,
                     "folder for plots of correct against incorrect recognitions");
  add_setting(command, "--format", inputs.format,
              "of the tables: text (default), markdown or latex; csv has one row a cell");
}

}  // namespace vpr
