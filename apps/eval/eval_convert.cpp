#include "eval_convert.h"

#include <fmt/format.h>

#include "base/error.h"
#include "base/text.h"
#include "ground_truth/check.h"
#include "ground_truth/formats.h"
#include "report/ground_truth_report.h"

namespace vpr {
namespace {

bool is_written(const GroundTruthFormat& format) { return format.write != nullptr; }

const GroundTruthFormat& find_target(const std::string& name) {
  const GroundTruthFormat& format = find_format(name);
  if (!is_written(format))
    throw Error(ErrorKind::usage,
                fmt::format("a ground truth can't be turned into {}; --to takes {}", format.name,
                            format_names(is_written)));
  return format;
}

void run(Session& session, const ConvertInputs& inputs) {
  const CommonOptions& options = session.options;
  if (options.output.empty())
    throw Error(ErrorKind::usage, "give the file to write, as in -o pairs.csv");
  const GroundTruthFormat& target = find_target(inputs.target);
  session.claim_output();
  const GroundTruthArgument argument = ground_truth_argument(inputs.ground_truth, inputs.flags);
  const InspectedGroundTruth found =
      inspect_ground_truth(argument, find_scope(inputs.scope, session.monitor), session.monitor);
  require_undamaged(found, inputs.ground_truth);
  const GroundTruthSummary summary = summarise(found, session.monitor);
  const bool holds_ignored = target.ignores_in.empty() ||
                             std::filesystem::path(options.output).extension() == target.ignores_in;
  if (summary.ignored > 0 && !holds_ignored)
    warn(session.monitor, fmt::format("{} to ignore become different: {} can't say that",
                                      counted(summary.ignored, "pair"), target.name));
  target.write(found, session.outputs.file(options.output), session.monitor);
  session.print_result(fmt::format("{} ({}) to {} ({}): {}, {} of the same place, {} ignored\n",
                                   inputs.ground_truth, found.format, options.output, target.name,
                                   counted(summary.query_frames, "query frame"),
                                   counted(summary.same, "pair"), summary.ignored),
                       conversion_json(found, summary, target.name));
}

}  // namespace

void add_convert(Program& program, ConvertInputs& inputs) {
  const Command command = program.add_command(
      "convert", "Turn a ground truth into another format.",
      "  vpr-eval convert ground_truth_new.npy --to pairs -o pairs.csv\n"
      "  vpr-eval convert query.csv --ground-truth-reference ref.csv --radius 5 --to matrix "
      "-o GT.npz\n"
      "  vpr-eval convert aligned --tolerance 3 --query-frames 111 --train-frames 111 --to pairs "
      "-o pairs.csv",
      [&inputs](Session& session) { run(session, inputs); });
  command.add_option("GROUND-TRUTH", inputs.ground_truth, ground_truth_help()).required();
  command.add_option("--to", inputs.target, format_names(is_written)).required();
  add_ground_truth_flags(command, inputs.flags, "--from,--ground-truth-format");
  add_scope_flags(command, inputs.scope);
}

}  // namespace vpr
