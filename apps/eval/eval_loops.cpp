#include <cmath>

#include <fmt/format.h>

#include "base/error.h"
#include "base/stopwatch.h"
#include "eval.h"
#include "present/loops_report.h"
#include "truth/times.h"

namespace vpr {
namespace {

constexpr double kMaxGap = 1e9;

void check_inputs(const EvalInputs& inputs) {
  if (inputs.loops.path.empty())
    throw Error(ErrorKind::usage, "--gap, --pose-times and --frames-by need --loops LIST");
  GroundTruthFlags flags = inputs.flags;
  flags.options.radius_m.reset();
  flags.options.max_difference_s.reset();
  if (!inputs.results.empty() || !inputs.scores.source().empty() || !inputs.ground_truth.empty() ||
      !inputs.dataset.empty() || !inputs.protocols.empty() || inputs.has_expectation() ||
      !inputs.saved_trajectory.empty() || !inputs.map.empty() || inputs.has_csv() ||
      !inputs.pairs.empty() || inputs.top_k || inputs.query || !inputs.train.empty() ||
      inputs.confidence || has_ground_truth_flags(flags))
    throw Error(
        ErrorKind::usage,
        "--loops needs --poses, --radius and --gap, and allows --pose-times, --max-difference, "
        "--html, --plot, -o and --name; other flags cannot be combined with it");
  ScoreInputs rest = inputs.scores;
  rest.matrix.is_distance = rest.matrix.is_similarity = false;  // of the list
  check_scores(rest, false);
  if (inputs.scores.poses.empty())
    throw Error(ErrorKind::usage,
                "--loops needs the trajectory of its frames, as in --poses trajectory.txt");
  if (!inputs.flags.options.radius_m)
    throw Error(ErrorKind::usage,
                "--loops needs the radius of a correct loop in meters, as in --radius 2");
  if (inputs.loops.gap.empty())
    throw Error(ErrorKind::usage,
                "--loops needs the minimum separation of the two frames of a loop, in seconds "
                "(--gap 30s) or in frames (--gap 300)");
}

LoopsEvaluation evaluate(const EvalInputs& inputs) {
  const std::filesystem::path path = inputs.loops.path;
  LoopsEvaluation found;
  found.name = inputs.names.empty() ? path.stem().string() : inputs.names.front();
  found.rules = {*inputs.flags.options.radius_m, parse_loop_gap(inputs.loops.gap, "--gap"),
                 inputs.scores.matrix.is_distance ? ScoreOrder::distance : ScoreOrder::similarity};
  found.trajectory = read_trajectory(inputs.scores.poses, inputs.loops.times);
  LoopListRules rules;
  rules.frames = inputs.loops.frames;
  if (const auto seconds = inputs.flags.options.max_difference_s) {
    if (!(*seconds >= 0 && *seconds <= kMaxGap))
      throw Error(ErrorKind::usage, "--max-difference must be 0 to 1e9 seconds");
    rules.max_difference_ns = std::llround(*seconds * double{kSecond});
  }
  if (path.extension() == ".json") {
    const Result result = read_result(path).result;
    found.list = loop_list_of(result, path.string(), found.trajectory);
    found.rules.order = result.score().order;
  } else {
    found.list = read_loop_list(path, found.trajectory, rules);
    if (found.list.has_scores && !inputs.scores.matrix.has_order())
      throw Error(ErrorKind::usage,
                  fmt::format("{}: the list has scores. Add --similarity (higher is better) or "
                              "--distance (lower is better)",
                              found.list.name));
  }
  found.judgment = judge_loops(found.list, found.trajectory, found.rules);
  return found;
}

}  // namespace

void run_loops(Session& session, const EvalInputs& inputs) {
  check_inputs(inputs);
  session.claim_output();
  if (!inputs.html.empty()) session.outputs.claim_file(inputs.html);
  if (!inputs.plots.empty()) session.outputs.claim_folder(inputs.plots, is_marked_folder);
  const Stopwatch watch;
  const LoopsEvaluation evaluation = evaluate(inputs);
  Json report = loops_json(evaluation, session.run);
  RunInfo run = session.run;
  run.paths = {{"loops", inputs.loops.path}, {"poses", inputs.scores.poses}};
  report["machine"] = machine_json(run);
  report["timing"] = timing_json({{"evaluate", watch.elapsed_s()}});
  session.write_output(report);
  if (!inputs.html.empty())
    session.outputs.file(inputs.html).write(loops_page(evaluation, session.run));
  if (!inputs.plots.empty())
    draw_loops(evaluation, session.outputs.folder(inputs.plots, is_marked_folder).temporary());
  std::string text = render_table(loops_table(evaluation), inputs.format);
  if (inputs.format == TableFormat::text)
    text = loops_sentence(evaluation) + "\n\n" + text + loops_mistakes(evaluation);
  session.print_result(text, report);
}

}  // namespace vpr
