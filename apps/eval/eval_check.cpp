#include "eval_check.h"

#include <fmt/format.h>

#include "base/json.h"
#include "ground_truth/check.h"
#include "ground_truth/formats.h"
#include "report/ground_truth_report.h"

namespace vpr {
namespace {

void run(Session& session, const CheckInputs& inputs) {
  session.claim_output();
  const GroundTruthArgument argument = ground_truth_argument(inputs.ground_truth, inputs.flags);
  const InspectedGroundTruth found =
      inspect_ground_truth(argument, find_scope(inputs.scope, session.monitor), session.monitor);
  const Json json = ground_truth_report_json(found, summarise(found, session.monitor), session.run);
  session.write_output(json);
  std::string text = render_table(ground_truth_table(json), inputs.format);
  if (inputs.format == TableFormat::text) text += ground_truth_examples(json);
  session.print_result(text, json);
  require_undamaged(found, inputs.ground_truth);
}

}  // namespace

void add_check(Program& program, CheckInputs& inputs) {
  const Command command = program.add_command(
      "check",
      "Look for what is odd in a ground truth: indices out of range, contradictions (exit code 4), "
      "duplicates, one-sided pairs, queries without a match.",
      "  vpr-eval check ground_truth.csv --query corridor/query --train corridor/ref\n"
      "  vpr-eval check GT.npz --json",
      [&inputs](Session& session) { run(session, inputs); });
  command.add_option("GROUND-TRUTH", inputs.ground_truth, ground_truth_help()).required();
  add_setting(command, "--format", inputs.format, "of the table: text, csv, markdown or latex");
  add_ground_truth_flags(command, inputs.flags);
  add_scope_flags(command, inputs.scope);
}

}  // namespace vpr
