#include "tune_inputs.h"

#include <algorithm>
#include <limits>

#include <fmt/format.h>

#include "base/error.h"
#include "images/sequence_names.h"

namespace vpr {

namespace {

// A query of a data set, with the flags' changes to its ground truth.
Source find_in_dataset(const TuneInputs& inputs, const std::string& path, const std::string& name,
                       bool is_fabmap) {
  const Dataset dataset = read_dataset(path);
  const DatasetQuery& query =
      select_query(dataset, name.empty() ? std::nullopt : std::optional(name));
  const auto& truth = is_fabmap ? query.place_ground_truth : query.sequence_ground_truth;
  if (!truth)
    throw Error(ErrorKind::usage,
                fmt::format("{}: the query {} has no ground truth", path, query.sequence.name));
  return {query.sequence, with_flags(*truth, inputs.flags)};
}

// A sequence and a ground truth as the command line names them.
Source parse_source(const TuneInputs& inputs, const std::string& sequence,
                    const std::string& ground_truth) {
  const SequenceArgument argument = parse_sequence_argument(sequence);
  return {{sequence_names({argument}).front(), argument},
          ground_truth_argument(ground_truth, inputs.flags)};
}

bool share_frames(const SequenceArgument& a, const SequenceArgument& b) {
  constexpr uint64_t kEnd = std::numeric_limits<uint64_t>::max();
  return a.path == b.path && a.range.first < b.range.last.value_or(kEnd) &&
         b.range.first < a.range.last.value_or(kEnd);
}

}  // namespace

std::vector<Source> find_sources(const TuneInputs& inputs, bool is_fabmap) {
  std::vector<Source> sources;
  for (const std::string& path : inputs.datasets)
    sources.push_back(find_in_dataset(inputs, path, inputs.query, is_fabmap));
  if (!sources.empty()) return sources;
  if (inputs.query.empty() || inputs.ground_truth.empty())
    throw Error(ErrorKind::usage,
                "give --query and --ground-truth, or data sets that have both (--dataset)");
  return {parse_source(inputs, inputs.query, inputs.ground_truth)};
}

std::optional<Source> find_validation(const TuneInputs& inputs, const std::vector<Source>& sources,
                                      bool is_fabmap, const Monitor& monitor) {
  const bool in_dataset = inputs.validate_ground_truth.empty() && inputs.datasets.size() == 1;
  if (inputs.validate.empty() != inputs.validate_ground_truth.empty() && !in_dataset)
    throw Error(ErrorKind::usage,
                "give both --validate and --validate-ground-truth, or with one --dataset the name "
                "of another of its queries as --validate");
  if (inputs.validate.empty()) return std::nullopt;
  Source validation =
      in_dataset ? find_in_dataset(inputs, inputs.datasets.front(), inputs.validate, is_fabmap)
                 : parse_source(inputs, inputs.validate, inputs.validate_ground_truth);
  for (const Source& source : sources)
    if (share_frames(source.sequence.sequence, validation.sequence.sequence))
      warn(monitor, fmt::format("{}: is also what the setting is chosen on; a validation needs "
                                "frames that were not seen",
                                validation.sequence.sequence.path.string()));
  return validation;
}

TruthReader reader_of(const GroundTruthArgument& argument, std::string& protocol,
                      const Monitor& monitor) {
  return [argument, &protocol, &monitor](const GroundTruthScope& scope) {
    const bool is_first = protocol.empty();  // what is odd is said once
    GroundTruth truth = read_ground_truth(argument, scope, is_first ? monitor : Monitor{});
    protocol = truth.protocol;
    return truth;
  };
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
  add_ground_truth_flags(command, inputs.flags);
  command.add_option("--heat-map", inputs.heat_map,
                     "picture (PNG) of correct and incorrect hits over the grid");
  command.add_option("--plot", inputs.plots, "folder for plots of correct against incorrect hits");
  add_setting(command, "--format", inputs.format,
              "of the tables: text (default), markdown or latex; csv has one row a cell");
}

}  // namespace vpr
