#include "bench_compare.h"

#include <fmt/format.h>

#include "base/error.h"
#include "base/json.h"
#include "bench/bench_file.h"
#include "bench/bench_tables.h"
#include "bench/compare.h"

namespace vpr {
namespace {

void compare(Session& session, const CompareInputs& inputs) {
  if (!(inputs.factor > 0))
    throw Error(ErrorKind::usage, fmt::format("--factor must be above 0, found {}", inputs.factor));
  session.claim_output();
  const BenchComparison comparison =
      compare_benches(read_bench(inputs.older), read_bench(inputs.newer));
  const Json json = comparison_json(comparison, inputs.factor);
  session.write_output(json);
  std::string text = render_table(comparison_table(comparison, inputs.factor), inputs.format);
  if (inputs.format != TableFormat::csv)
    for (const std::string& name : comparison.only_in_one) text += name + "\n";
  session.print_result(text, json);
  const size_t slower = count_slower(comparison, inputs.factor);
  if (slower > 0)
    throw Error(ErrorKind::expectation,
                fmt::format("{} of {} times are above {} times the old ones", slower,
                            comparison.ratios.size(), inputs.factor));
}

}  // namespace

void add_compare(Program& program, CompareInputs& inputs, NoSettings& none) {
  const Command command = program.add_command(
      "compare", "Two runs on one machine: ratios, and exit code 5 where the new one is slower.",
      "  vpr-bench compare old.json new.json --factor 1.2",
      [&inputs](Session& session) { compare(session, inputs); });
  program.add_config(command, none);
  command.add_option("OLD", inputs.older, "an earlier run").required();
  command.add_option("NEW", inputs.newer, "a later one").required();
  add_setting(command, "--factor", inputs.factor, "a larger ratio is too slow (default 1.2)");
  add_setting(command, "--format", inputs.format,
              "of the table: text (default), csv, markdown or latex");
}

}  // namespace vpr
