// vpr-query --scores: windows of a matrix that any program computed.
#include <filesystem>

#include <fmt/format.h>

#include "base/error.h"
#include "query_inputs.h"
#include "sequence/sequence_source.h"

namespace vpr {
QuerySource find_scored_query(const QueryInputs& inputs) {
  QuerySource source;
  source.sequence.name =
      inputs.query.value_or(std::filesystem::path(inputs.scores.matrix.path).stem().string());
  if (!inputs.ground_truth.empty())
    source.ground_truth = ground_truth_argument(inputs.ground_truth, inputs.flags);
  require_order(inputs.scores.matrix);
  return source;
}

std::vector<NamedArgument> scored_sequences(const QueryScores& scores) {
  std::vector<NamedArgument> sequences;
  for (const std::string& text : scores.train_sequences) {
    const size_t equals = text.rfind('=');
    if (equals == std::string::npos || equals == 0)
      throw Error(ErrorKind::usage,
                  fmt::format("--train-sequence takes NAME=FIRST:LAST, found {}", text));
    const SequenceArgument argument = parse_sequence_argument("@" + text.substr(equals + 1));
    if (!argument.path.empty())
      throw Error(ErrorKind::usage, fmt::format("--train-sequence takes NAME=FIRST:LAST, columns "
                                                "that are numbered from 0, found {}",
                                                text));
    sequences.push_back({text.substr(0, equals), argument});
  }
  return sequences;
}

}  // namespace vpr
