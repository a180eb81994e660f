// vpr-eval check (vpr.ground-truth-check/3) and convert (vpr.conversion/3).
#include <memory>

#include <fmt/format.h>
#include <opencv2/core/mat.hpp>

#include "base/error.h"
#include "base/text.h"
#include "describe/imported.h"
#include "eval.h"
#include "sequence/frames.h"
#include "sequence/sequence_source.h"
#include "truth/formats.h"
#include "truth/ground_truth.h"

namespace vpr {
namespace {

/// Numbers of frames; empty: those of the ground truth.
struct ScopeInputs {
  std::string result;
  std::string query;
  std::vector<std::string> train;
  std::optional<uint64_t> query_frames;
  std::optional<uint64_t> train_frames;
};

struct TruthInputs {
  std::string ground_truth;
  std::string target;  ///< format to convert to
  GroundTruthFlags flags;
  ScopeInputs scope;
  TableFormat format = TableFormat::text;
};

size_t count_frames(const SequenceArgument& argument, const Monitor& monitor) {
  const SequenceSource sequence = open_sequence(argument);
  if (sequence.kind == SequenceKind::descriptors) return ArrayRows(sequence).count();
  if (sequence.kind == SequenceKind::images) return sequence.files.size();
  return for_each_frame(sequence, PixelFormat::gray, Unreadable::skip, monitor,
                        [](size_t, const cv::Mat&) {})
      .frames;
}

GroundTruthScope scope_of_sequences(const ScopeInputs& inputs, const Monitor& monitor) {
  std::vector<SequenceArgument> arguments;
  for (const std::string& text : inputs.train) arguments.push_back(parse_sequence_argument(text));
  const std::vector<std::string> names = sequence_names(arguments);
  GroundTruthScope scope;
  const SequenceArgument query = parse_sequence_argument(inputs.query);
  scope.query.frames = count_frames(query, monitor);
  scope.query_names = [query] { return frame_names(query); };
  for (size_t s = 0; s < arguments.size(); ++s) {
    scope.sequences.push_back({{names[s], count_frames(arguments[s], monitor)}});
    scope.sequences.back().names = [train = arguments[s]] { return frame_names(train); };
  }
  return scope;
}

void add_scope_flags(const Command& command, ScopeInputs& inputs) {
  constexpr const char* kGroup = "Numbers of frames (default: those of the ground truth)";
  command.add_option("--result", inputs.result, "result of vpr-query with these frames", kGroup);
  command.add_option("--query", inputs.query, "query with these frames: folder, list or video",
                     kGroup);
  command.add_list("--train", inputs.train, "training sequence with these frames; repeatable",
                   kGroup);
  command.add_option("--query-frames", inputs.query_frames, "number of query frames", kGroup,
                     "NUMBER");
  command.add_option("--train-frames", inputs.train_frames, "number of training frames", kGroup,
                     "NUMBER");
}

// Videos are read to count their frames.
GroundTruthScope find_scope(const ScopeInputs& inputs, const Monitor& monitor) {
  const bool has_sequences = !inputs.query.empty() || !inputs.train.empty();
  const bool has_numbers = inputs.query_frames || inputs.train_frames;
  if (int{!inputs.result.empty()} + int{has_sequences} + int{has_numbers} > 1)
    throw Error(ErrorKind::usage,
                "the numbers of frames have several sources. Use one: --result, --query with "
                "--train, or --query-frames with --train-frames");
  if (!inputs.result.empty()) return scope_of(read_result(inputs.result, monitor).result);
  if (has_sequences) {
    if (inputs.query.empty() || inputs.train.empty())
      throw Error(ErrorKind::usage, "--query and --train go together");
    return scope_of_sequences(inputs, monitor);
  }
  if (!has_numbers) return {{"", kUnknownFrames}, {{{"", kUnknownFrames}}}};
  if (!inputs.query_frames || !inputs.train_frames)
    throw Error(ErrorKind::usage, "--query-frames and --train-frames go together");
  if (*inputs.query_frames > kMaxGrownFrames || *inputs.train_frames > kMaxGrownFrames)
    throw Error(ErrorKind::usage, "the maximum number of frames is {}", kMaxGrownFrames);
  return {{"", *inputs.query_frames}, {{{"", *inputs.train_frames}}}};
}

Json finding_json(const GroundTruthFinding& finding) {
  return {{"count", finding.count}, {"examples", finding.examples}};
}

Json ground_truth_report_json(const InspectedGroundTruth& ground_truth,
                              const GroundTruthSummary& summary, const RunInfo& run) {
  const auto finding = [&](FindingKind kind) {
    return finding_json(ground_truth.findings[static_cast<size_t>(kind)]);
  };
  Json json = {{"schema", "vpr.ground-truth-check/3"},
               {"format", ground_truth.format},
               {"protocol", ground_truth.truth.protocol}};
  json["frames"] = {{"query", summary.query_frames}, {"train", summary.train_frames}};
  json["pairs"] = {
      {"same", summary.same}, {"ignored", summary.ignored}, {"most_matches", summary.most_matches}};
  json["findings"] = {{"out_of_range", finding(FindingKind::out_of_range)},
                      {"contradiction", finding(FindingKind::contradiction)},
                      {"duplicate", finding(FindingKind::duplicate)},
                      {"queries_without_match", summary.queries_without_match},
                      {"train_frames_without_match", summary.train_frames_without_match},
                      {"one_sided", nullptr}};
  if (summary.one_sided)
    json["findings"]["one_sided"] = finding_json({*summary.one_sided, summary.one_sided_examples});
  json["provenance"] = provenance_json(run);
  json["machine"] = machine_json(run);
  return json;
}

/// A row per count, with its meaning.
Table ground_truth_table(const InspectedGroundTruth& ground_truth,
                         const GroundTruthSummary& summary) {
  const auto finding = [&](FindingKind kind) {
    return ground_truth.findings[static_cast<size_t>(kind)].count;
  };
  Table table{ground_truth.truth.protocol, {"what", "count"}, {}};
  add_row(table, "query frames", summary.query_frames);
  add_row(table, "training frames", summary.train_frames);
  add_row(table, "pairs of the same place, tolerance applied", summary.same);
  add_row(table, "pairs to ignore", summary.ignored);
  add_row(table, "most matches of one query", summary.most_matches);
  add_row(table, "pairs out of range: damage", finding(FindingKind::out_of_range));
  add_row(table, "pairs labeled both same and ignore: damage", finding(FindingKind::contradiction));
  add_row(table, "pairs given more than once; they count once", finding(FindingKind::duplicate));
  add_row(table, "queries without a match; counted apart", summary.queries_without_match);
  add_row(table, "training frames that no query matches", summary.train_frames_without_match);
  add_row(table, "pairs (i, j) without (j, i); usual between two sequences",
          summary.one_sided ? std::to_string(*summary.one_sided) : "-");
  return table;
}

/// The first pairs of each finding, one per line.
std::string ground_truth_examples(const InspectedGroundTruth& ground_truth,
                                  const GroundTruthSummary& summary) {
  std::string text;
  for (const FindingKind kind :
       {FindingKind::out_of_range, FindingKind::contradiction, FindingKind::duplicate})
    for (const std::string& example : ground_truth.findings[static_cast<size_t>(kind)].examples)
      text += example + "\n";
  if (summary.one_sided)
    for (const std::string& example : summary.one_sided_examples) text += example + "\n";
  return text;
}

/// `target`: the other format.
Json conversion_json(const InspectedGroundTruth& ground_truth, const GroundTruthSummary& summary,
                     std::string_view target) {
  return {{"schema", "vpr.conversion/3"},
          {"from", ground_truth.format},
          {"to", target},
          {"query_frames", summary.query_frames},
          {"same", summary.same},
          {"ignored", summary.ignored}};
}

void run_check(Session& session, const TruthInputs& inputs) {
  session.claim_output();
  const GroundTruthArgument argument = ground_truth_argument(inputs.ground_truth, inputs.flags);
  const InspectedGroundTruth found =
      inspect_ground_truth(argument, find_scope(inputs.scope, session.monitor), session.monitor);
  const GroundTruthSummary summary = summarize(found, session.monitor);
  const Json json = ground_truth_report_json(found, summary, session.run);
  session.write_output(json);
  std::string text = render_table(ground_truth_table(found, summary), inputs.format);
  if (inputs.format == TableFormat::text) text += ground_truth_examples(found, summary);
  session.print_result(text, json);
  require_undamaged(found, inputs.ground_truth);
}

bool is_written(const GroundTruthFormat& format) { return format.write != nullptr; }

void run_convert(Session& session, const TruthInputs& inputs) {
  const CommonOptions& options = session.options;
  if (options.output.empty())
    throw Error(ErrorKind::usage, "the output file is missing. Add it, as in -o pairs.csv");
  const GroundTruthFormat& target = find_format(inputs.target);
  if (!is_written(target))
    throw Error(ErrorKind::usage, "{} cannot be written. Use --to with {}", target.name,
                format_names(is_written));
  session.claim_output();
  const GroundTruthArgument argument = ground_truth_argument(inputs.ground_truth, inputs.flags);
  const InspectedGroundTruth found =
      inspect_ground_truth(argument, find_scope(inputs.scope, session.monitor), session.monitor);
  require_undamaged(found, inputs.ground_truth);
  if (!found.truth.asked.empty())
    throw Error(ErrorKind::usage, "{}: most pairs are unknown, and no other format has such pairs",
                inputs.ground_truth);
  const GroundTruthSummary summary = summarize(found, session.monitor);
  const bool holds_ignored = target.ignores_in.empty() ||
                             std::filesystem::path(options.output).extension() == target.ignores_in;
  if (summary.ignored > 0 && !holds_ignored)
    warn(session.monitor, "{} labeled ignore become different, since {} has no such label",
         counted(summary.ignored, "pair"), target.name);
  target.write(found, session.outputs.file(options.output), session.monitor);
  session.print_result(fmt::format("{} ({}) to {} ({}): {}, {} of the same place, {} ignored\n",
                                   inputs.ground_truth, found.format, options.output, target.name,
                                   counted(summary.query_frames, "query frame"),
                                   counted(summary.same, "pair"), summary.ignored),
                       conversion_json(found, summary, target.name));
}

}  // namespace

void add_check(Program& program) {
  const auto inputs = std::make_shared<TruthInputs>();
  const Command command = program.add_command(
      "check",
      "Check a ground truth for mistakes. Indices out of range and contradictions have exit code "
      "4; duplicates, one-sided pairs and queries without a match are listed.",
      "  vpr-eval check pairs.csv --query tuesday --train monday\n"
      "  vpr-eval check GT.npz --json",
      [inputs](Session& session) { run_check(session, *inputs); });
  command.add_option("GROUND-TRUTH", inputs->ground_truth, ground_truth_help()).required();
  add_format_flag(command, inputs->format);
  add_ground_truth_flags(command, inputs->flags);
  add_scope_flags(command, inputs->scope);
}

void add_convert(Program& program) {
  const auto inputs = std::make_shared<TruthInputs>();
  const Command command = program.add_command(
      "convert", "Convert a ground truth to another format.",
      "  vpr-eval convert pairs.csv --query tuesday --train monday --to matrix -o matrix.npy\n"
      "  vpr-eval convert ground_truth_new.npy --to pairs -o pairs.csv\n"
      "  vpr-eval convert query.csv --ground-truth-train ref.csv --radius 5 --to matrix "
      "-o GT.npz\n"
      "  vpr-eval convert aligned --tolerance 3 --query-frames 111 --train-frames 111 --to pairs "
      "-o aligned.csv",
      [inputs](Session& session) { run_convert(session, *inputs); });
  command.add_option("GROUND-TRUTH", inputs->ground_truth, ground_truth_help()).required();
  command.add_option("--to", inputs->target, "output format: " + format_names(is_written))
      .required();
  add_ground_truth_flags(command, inputs->flags, "--from,--ground-truth-format");
  add_scope_flags(command, inputs->scope);
}

}  // namespace vpr
