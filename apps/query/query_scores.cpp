// vpr-query --scores: windows of a matrix that any program computed.
#include <filesystem>

#include <fmt/format.h>

#include "base/error.h"
#include "match/lsh.h"
#include "match/match.h"
#include "query_inputs.h"
#include "sequence/sequence.h"

namespace vpr {
namespace {

void check_alone(const QueryScores& scores) {
  constexpr const char* kWithout = "describes a matrix; give it with --scores";
  refuse_format(scores.matrix, kWithout);
  refuse(!scores.train_sequences.empty(), "--train-sequence", kWithout);
}

// Nothing is known of training frames among themselves.
void check_settings(const SequenceQuerySettings& settings) {
  if (has_paths(settings.method) || settings.method == kLshMethod)
    throw Error(ErrorKind::usage,
                fmt::format("--method {} needs descriptors; windows of --scores are compared by "
                            "fastable, fastable-online or openable",
                            settings.method));
  const bool by_margin = settings.decision == Decision::margin;
  if (by_margin && (!settings.margin || !settings.margin_width))
    throw Error(ErrorKind::usage,
                "of a matrix of scores, nothing is known of how far training frames are from each "
                "other: with --decide margin, give numbers for --margin and --margin-width");
  refuse(settings.safety_factor.has_value(), "--safety-factor",
         "is for automatic thresholds, which a matrix of scores does not have");
}

}  // namespace

QuerySource find_scored_query(const QueryInputs& inputs) {
  QuerySource source;
  source.sequence.name =
      inputs.query.value_or(std::filesystem::path(inputs.scores.matrix.path).stem().string());
  if (!inputs.ground_truth.empty())
    source.ground_truth = ground_truth_argument(inputs.ground_truth, inputs.flags);
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

void check_scores(const QueryInputs& inputs, const SequenceQuerySettings& settings) {
  const QueryScores& scores = inputs.scores;
  if (scores.matrix.path.empty()) return check_alone(scores);
  if (!inputs.database.empty())
    throw Error(ErrorKind::usage,
                "--scores holds what a database would be compared for: give one of them");
  require_order(scores.matrix);
  constexpr const char* kBeside = "does not go with --scores, which has the query's distances";
  refuse(!inputs.query_npy.empty(), "--query-npy", kBeside);
  refuse(!inputs.dataset.empty(), "--dataset", kBeside);
  refuse(inputs.follow, "--follow", kBeside);
  refuse(inputs.rate.fps || inputs.rate.recorded_fps, "--fps",
         "does not go with --scores, whose frames are those of the matrix");
  refuse(!inputs.fuse.empty() || settings.fusion_weight, "--fuse", kBeside);
  refuse(settings.skip_unreadable, "--skip-unreadable",
         "does not go with --scores: frames without a score never match");
  check_settings(settings);
}

}  // namespace vpr
