#include <cassert>

#include <fmt/format.h>

#include "base/error.h"
#include "base/json.h"
#include "base/text.h"
#include "eval_inputs.h"
#include "evaluate/matrix_scan.h"
#include "evaluate/score_sources.h"
#include "present/result_file.h"
#include "sequence/sequence_source.h"

namespace vpr {
namespace {

constexpr uint64_t kMostPairs = 1'000'000;  // of a query

// The sequence of the query: the data set's of this name, or what --query names; none where neither
// is given.
std::optional<SequenceArgument> query_argument(const EvalInputs& inputs,
                                               const std::optional<std::string>& query) {
  if (!inputs.dataset.empty())
    return select_query(read_dataset(inputs.dataset), query).sequence.sequence;
  return query ? std::optional(parse_sequence_argument(*query)) : std::nullopt;
}

std::vector<SequenceArgument> train_arguments(const EvalInputs& inputs) {
  std::vector<SequenceArgument> arguments;
  for (const std::string& text : inputs.pictures.train)
    arguments.push_back(parse_sequence_argument(text));
  if (arguments.empty() && !inputs.dataset.empty())
    for (const NamedSequence& sequence : read_dataset(inputs.dataset).train)
      arguments.push_back(sequence.sequence);
  return arguments;
}

std::vector<std::string> query_names(const EvalInputs& inputs) {
  const auto query = query_argument(inputs, inputs.pictures.query);
  return query ? frame_names(*query) : std::vector<std::string>{};
}

std::vector<std::vector<std::string>> train_names(const EvalInputs& inputs) {
  std::vector<std::vector<std::string>> names;
  for (const SequenceArgument& argument : train_arguments(inputs))
    names.push_back(frame_names(argument));
  return names;
}

std::string name_of(const std::vector<std::string>& names, size_t frame) {
  if (names.empty()) return std::to_string(frame);
  if (frame >= names.size())
    throw Error(
        ErrorKind::usage,
        fmt::format("there are names of {}, and frame {} is to be named; give the sequences "
                    "that were evaluated",
                    counted(names.size(), "frame"), frame));
  return names[frame];
}

std::string pair_lines(const std::vector<BestPair>& pairs, const EvalInputs& inputs,
                       size_t sequences) {
  const std::vector<std::string> query = query_names(inputs);
  std::vector<std::vector<std::string>> train = train_names(inputs);
  if (sequences > 1 && train.size() < sequences)
    throw Error(ErrorKind::usage,
                fmt::format("--pairs: name the frames of all {} training sequences, in the order "
                            "of the database, with --train",
                            sequences));
  train.resize(std::max(train.size(), sequences));
  std::string text;
  for (const BestPair& pair : pairs)
    text += fmt::format("{} {}\n", name_of(query, pair.query),
                        name_of(train[pair.match.sequence], pair.match.reference));
  return text;
}

}  // namespace

std::optional<size_t> query_frames(const EvalInputs& inputs) {
  const auto query = query_argument(inputs, inputs.pictures.query);
  if (!query) return std::nullopt;
  const SequenceSource sequence = open_sequence(*query);
  return sequence.kind == SequenceKind::images ? std::optional(sequence.files.size())
                                               : std::nullopt;
}

void add_names(JudgedBy& by, const EvalInputs& inputs,
               const std::optional<std::string>& query_name) {
  const auto& query = inputs.dataset.empty() ? inputs.pictures.query : query_name;
  if (!inputs.dataset.empty() || query)
    by.query_names = [inputs, query] { return frame_names(*query_argument(inputs, query)); };
  for (const SequenceArgument& argument : train_arguments(inputs))
    by.train_names.emplace_back([argument] { return frame_names(argument); });
}

void add_list_options(const Command& app, EvalInputs& inputs) {
  const std::string group = "Lists";
  app.add_option("--predictions", inputs.scores.predictions,
                 "what any program found, instead of scores: a folder preds of "
                 "VPR-methods-evaluation, or a file with \"query reference\" or \"query reference "
                 "score\" a line; frames are numbers, or are named by --query and --train")
      .group(group)
      .type_name("PATH");
  app.add_option("--pairs", inputs.pairs.path,
                 "write the best references of each query, \"query reference\" a line, as hloc "
                 "reads them; without a ground truth, too")
      .group(group)
      .type_name("FILE");
  add_setting(app, "--top-k", inputs.pairs.most,
              "so many for --pairs (default: 1 of a result, 10 of scores)")
      .group(group)
      .type_name("K");
}

void check_lists(const Session& session, const EvalInputs& inputs) {
  if (inputs.pairs.most && inputs.pairs.path.empty())
    throw Error(ErrorKind::usage, "--top-k says how many are written with --pairs");
  if (inputs.pairs.path.empty()) return;
  if (inputs.pairs.most && (*inputs.pairs.most == 0 || *inputs.pairs.most > kMostPairs))
    throw Error(ErrorKind::usage,
                fmt::format("--top-k must be 1 to {}, found {}", kMostPairs, *inputs.pairs.most));
  if (!inputs.scores.any() && inputs.pairs.most.value_or(1) > 1)
    throw Error(ErrorKind::usage,
                "a result has the best match of each query; for more, give the matrix that was "
                "saved with it, as --scores D.npy (vpr-query --save-matrix)");
  session.outputs.claim_file(inputs.pairs.path);
}

ScoreMatrix open_predictions(const EvalInputs& inputs) {
  std::optional<ScoreOrder> kind;
  if (inputs.scores.matrix.has_order()) kind = inputs.scores.matrix.order();
  std::vector<std::string> references;
  for (const auto& names : train_names(inputs))
    references.insert(references.end(), names.begin(), names.end());
  return prediction_scores(inputs.scores.predictions, FrameNames(query_names(inputs)),
                           FrameNames(references), kind);
}

size_t write_pairs(const Session& session, const EvalInputs& inputs, const ScoreMatrix* matrix,
                   const ScoreLayout& layout, const Result* result) {
  if (inputs.pairs.path.empty()) return 0;
  assert(matrix != nullptr || result != nullptr);
  constexpr uint64_t kUsual = 10;
  const std::vector<BestPair> pairs =
      matrix == nullptr
          ? best_pairs(*result)
          : best_pairs(*matrix, layout, inputs.pairs.most.value_or(result ? 1 : kUsual),
                       session.monitor);
  session.outputs.file(inputs.pairs.path)
      .write(pair_lines(pairs, inputs, layout.scope.sequences.size()));
  return pairs.size();
}

bool only_lists(const EvalInputs& inputs) {
  return !inputs.pairs.path.empty() && inputs.ground_truth.empty() && inputs.dataset.empty() &&
         !wants_pictures(inputs.pictures) && inputs.expect.expected.empty() && inputs.map.empty() &&
         !inputs.csv.any();
}

void run_lists(Session& session, const EvalInputs& inputs) {
  if (!session.options.output.empty())
    throw Error(ErrorKind::usage,
                "without a ground truth there is no report to write; leave -o out, or give "
                "--ground-truth or --dataset");
  const OpenedScores opened = open_inputs(session, inputs);
  const Result* result = opened.stored ? &opened.stored->result : nullptr;
  const ScoreLayout layout =
      result ? layout_of(*result) : layout_of(*opened.matrix, inputs.scores.window_length);
  const ScoreMatrix* matrix = opened.matrix ? &*opened.matrix : nullptr;
  if (matrix != nullptr && result == nullptr)
    check_rows(inputs.scores, matrix->queries(), std::nullopt);
  if (matrix != nullptr) require_fit(*matrix, layout);
  const size_t count = write_pairs(session, inputs, matrix, layout, result);
  session.print_result(fmt::format("{}: {}\n", inputs.pairs.path, counted(count, "pair")),
                       {{"pairs", count}});
}

}  // namespace vpr
