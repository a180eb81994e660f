#include "scope_inputs.h"

#include <fmt/format.h>
#include <opencv2/core/mat.hpp>

#include "base/error.h"
#include "descriptors/array_rows.h"
#include "evaluation/counts.h"
#include "images/frames.h"
#include "images/sequence.h"
#include "images/sequence_argument.h"
#include "report/result_file.h"

namespace vpr {
namespace {

constexpr uint64_t kMostFrames = uint64_t{1} << 22;

size_t count_frames(const SequenceArgument& argument, const Monitor& monitor) {
  const Sequence sequence = open_sequence(argument);
  if (sequence.kind == SequenceKind::descriptors) return ArrayRows(sequence).count();
  if (sequence.kind == SequenceKind::images) return sequence.files.size();
  return for_each_frame(sequence, PixelFormat::grey, Unreadable::skip, monitor,
                        [](size_t, const cv::Mat&) {})
      .count();
}

GroundTruthScope scope_of_sequences(const ScopeInputs& inputs, const Monitor& monitor) {
  std::vector<SequenceArgument> arguments;
  for (const std::string& text : inputs.train) arguments.push_back(parse_sequence_argument(text));
  const std::vector<std::string> names = sequence_names(arguments);
  GroundTruthScope scope;
  const auto names_of = [](const SequenceArgument& argument) {
    return [argument] { return frame_names(argument); };
  };
  const SequenceArgument query = parse_sequence_argument(inputs.query);
  scope.query_frames = count_frames(query, monitor);
  scope.query_names = names_of(query);
  for (size_t s = 0; s < arguments.size(); ++s) {
    scope.sequences.push_back({names[s], count_frames(arguments[s], monitor)});
    scope.sequences.back().names = names_of(arguments[s]);
  }
  return scope;
}

}  // namespace

void add_scope_flags(const Command& command, ScopeInputs& inputs) {
  constexpr const char* kGroup = "Numbers of frames (default: those of the ground truth)";
  command.add_option("--result", inputs.result, "those of a result of vpr-query").group(kGroup);
  command.add_option("--query", inputs.query, "those of this query: folder, list or video")
      .group(kGroup);
  command.add_list("--train", inputs.train, "and of this training sequence; repeatable")
      .group(kGroup);
  command.add_option("--query-frames", inputs.query_frames, "a number")
      .type_name("NUMBER")
      .group(kGroup);
  command.add_option("--train-frames", inputs.train_frames, "a number")
      .type_name("NUMBER")
      .group(kGroup);
}

GroundTruthScope find_scope(const ScopeInputs& inputs, const Monitor& monitor) {
  const bool has_sequences = !inputs.query.empty() || !inputs.train.empty();
  const bool has_numbers = inputs.query_frames || inputs.train_frames;
  if (int{!inputs.result.empty()} + int{has_sequences} + int{has_numbers} > 1)
    throw Error(
        ErrorKind::usage,
        "give the numbers of frames once: --result, --query with --train, or --query-frames "
        "with --train-frames");
  if (!inputs.result.empty()) return scope_of(read_result(inputs.result, monitor).result);
  if (has_sequences) {
    if (inputs.query.empty() || inputs.train.empty())
      throw Error(ErrorKind::usage, "give both --query and --train");
    return scope_of_sequences(inputs, monitor);
  }
  if (!has_numbers) return {kUnknownFrames, {{"", kUnknownFrames}}};
  if (!inputs.query_frames || !inputs.train_frames)
    throw Error(ErrorKind::usage, "give both --query-frames and --train-frames");
  if (*inputs.query_frames > kMostFrames || *inputs.train_frames > kMostFrames)
    throw Error(ErrorKind::usage, fmt::format("numbers of frames go up to {}", kMostFrames));
  return {*inputs.query_frames, {{"", *inputs.train_frames}}};
}

}  // namespace vpr
