#include "query_inputs.h"

#include <fmt/format.h>

#include "base/error.h"
#include "base/json.h"
#include "sequence/selection.h"
#include "sequence/sequence_source.h"

namespace vpr {

namespace {

NamedSequence named_sequence(const std::string& text) {
  const SequenceArgument argument = parse_sequence_argument(text);
  return {sequence_names({argument}).front(), argument};
}

// As --query or --query-npy names it.
NamedSequence sequence_of_flags(const QueryInputs& inputs) {
  if (!inputs.query_npy.empty()) {
    const NamedSequence sequence = named_sequence(inputs.query_npy);
    if (open_sequence(sequence.sequence).kind != SequenceKind::descriptors)
      throw Error(ErrorKind::usage,
                  fmt::format("{}: is no .npy file, nor a folder with .npy files and no images",
                              sequence.sequence.path.string()));
    return sequence;
  }
  if (!inputs.query) throw Error(ErrorKind::usage, "give the query sequence, as in --query FOLDER");
  return named_sequence(*inputs.query);
}

}  // namespace

QuerySource find_query(const QueryInputs& inputs, const Session& session) {
  QuerySource source;
  if (!inputs.ground_truth.empty())
    source.ground_truth = ground_truth_argument(inputs.ground_truth, inputs.flags);
  std::optional<Dataset> dataset;
  if (!inputs.dataset.empty()) {
    dataset = read_dataset(inputs.dataset);
    const DatasetQuery& query = select_query(*dataset, inputs.query);
    source.sequence = query.sequence;
    if (!source.ground_truth)
      source.ground_truth = ground_truth_of(query, DatabaseFamily::sequences, inputs.flags);
  } else {
    source.sequence = sequence_of_flags(inputs);
  }
  SequenceArgument& sequence = source.sequence.sequence;
  if (!inputs.follow || std::filesystem::is_regular_file(sequence.path))
    sequence = selected(sequence, inputs.selection, inputs.flags.options.query_times,
                        dataset ? &*dataset : nullptr, session);
  if (source.ground_truth) leave_times_to_rate(*source.ground_truth, inputs.selection);
  return source;
}

bool asks_for_truth(const QueryInputs& inputs) {
  GroundTruthFlags flags = inputs.flags;
  if (inputs.selection.fps) flags.options.query_times.clear();
  return !inputs.ground_truth.empty() || any_given(flags);
}

ResultContext context_of(const Session& session, const QueryInputs& inputs,
                         const std::string& query_path,
                         const std::map<std::string, double>& seconds) {
  ResultContext context;
  context.run = session.run;
  context.run.simd_target = session.kernels.target;
  if (inputs.scores.matrix.path.empty() && inputs.database.empty())
    context.run.paths = {{"query", query_path}};
  else if (inputs.scores.matrix.path.empty())
    context.run.paths = {{"database", inputs.database}, {"query", query_path}};
  else
    context.run.paths = {{"scores", inputs.scores.matrix.path}};
  if (!inputs.fuse.empty()) context.run.paths["fuse"] = inputs.fuse;
  context.seconds = seconds;
  return context;
}

Json keep_result(const Session& session, const Result& result, const ResultContext& context) {
  const std::string& output = session.options.output;
  return output.empty() ? result_json(result, context)
                        : write_result(output, result, context, session.outputs);
}

std::string query_title(const Result& result) {
  const std::string selection = selection_text(result.query.selection);
  return result.query.name + (selection.empty() ? "" : ", " + selection);
}

}  // namespace vpr
