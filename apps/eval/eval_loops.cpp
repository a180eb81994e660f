#include <cmath>

#include <fmt/format.h>

#include "base/error.h"
#include "base/stopwatch.h"
#include "eval_inputs.h"
#include "evaluate/loops.h"
#include "present/loops_report.h"
#include "present/result_file.h"
#include "truth/times.h"

namespace vpr {
namespace {

constexpr double kMostGap = 1e9;

LoopRules rules_of(const EvalInputs& inputs) {
  if (inputs.scores.poses.empty())
    throw Error(ErrorKind::usage,
                "--loops needs the trajectory that the list's frames are of, as "
                "in --poses trajectory.txt");
  if (!inputs.flags.options.radius_m)
    throw Error(
        ErrorKind::usage,
        "--loops needs the radius in meters within which a loop is right, as in --radius 2");
  if (inputs.loops.gap.empty())
    throw Error(ErrorKind::usage,
                "--loops needs --gap, how long ago a place must have been left before it can be "
                "closed as a loop: in seconds (--gap 30s) or in frames (--gap 300)");
  return {*inputs.flags.options.radius_m, parse_loop_gap(inputs.loops.gap, "--gap"),
          inputs.scores.matrix.is_distance ? ScoreOrder::distance : ScoreOrder::similarity};
}

// Whether a flag of ground truth is given that loops have no use for.
bool has_other_flags(GroundTruthFlags flags) {
  flags.options.radius_m.reset();
  flags.options.max_difference_s.reset();
  return any_given(flags);
}

void refuse_others(const EvalInputs& inputs) {
  if (inputs.loops.path.empty())
    throw Error(ErrorKind::usage, "--gap, --times and --frames-by belong to --loops LIST");
  const bool has_others =
      !inputs.results.empty() || inputs.scores.any() || !inputs.ground_truth.empty() ||
      !inputs.dataset.empty() || !inputs.protocols.empty() || inputs.expect.any() ||
      !inputs.fixes.empty() || !inputs.map.empty() || inputs.csv.any() || inputs.pairs.any() ||
      inputs.pictures.query || !inputs.pictures.train.empty() || inputs.confidence ||
      has_other_flags(inputs.flags);
  if (has_others)
    throw Error(ErrorKind::usage,
                "--loops judges a list by its trajectory alone: give --poses, --radius, --gap, "
                "and maybe --times, --max-difference, --html, --plot, -o and --name");
  ScoreInputs rest = inputs.scores;
  rest.matrix.is_distance = rest.matrix.is_similarity = false;  // of the list
  check_score_inputs(rest, false);
}

void require_order(const EvalInputs& inputs, const LoopList& list) {
  if (!list.has_scores || inputs.scores.matrix.has_order()) return;
  throw Error(ErrorKind::usage,
              fmt::format("{}: has scores; say which are good, --similarity (large ones) or "
                          "--distance (small ones)",
                          list.name));
}

bool is_result(const std::filesystem::path& path) { return path.extension() == ".json"; }

LoopsEvaluation evaluate(const EvalInputs& inputs) {
  LoopsEvaluation found;
  found.rules = rules_of(inputs);
  found.name = inputs.names.empty() ? std::filesystem::path(inputs.loops.path).stem().string()
                                    : inputs.names.front();
  found.trajectory = read_trajectory(inputs.scores.poses, inputs.loops.times);
  LoopListRules rules;
  rules.frames = inputs.loops.frames;
  if (const auto seconds = inputs.flags.options.max_difference_s) {
    if (!(*seconds >= 0 && *seconds <= kMostGap))
      throw Error(ErrorKind::usage, "--max-difference must be 0 to 1e9 seconds");
    rules.max_difference_ns = std::llround(*seconds * double{kSecond});
  }
  if (is_result(inputs.loops.path)) {
    const Result result = read_result(inputs.loops.path).result;
    found.list = loop_list_of(result, inputs.loops.path, found.trajectory);
    found.rules.order = result.score().order;
  } else {
    found.list = read_loop_list(inputs.loops.path, found.trajectory, rules);
    require_order(inputs, found.list);
  }
  found.judgment = judge_loops(found.list, found.trajectory, found.rules);
  return found;
}

}  // namespace

void add_loop_options(const Command& app, LoopInputs& inputs) {
  const std::string group = "Loop closures";
  app.add_option("--loops", inputs.path,
                 "list of a SLAM system's loop closures (CSV query,match[,score], of indices or "
                 "time stamps), or a result of vpr-query --loop; with --poses, --radius and --gap")
      .group(group)
      .type_name("FILE");
  app.add_option("--gap", inputs.gap,
                 "a place counts as left for so long before it can be closed as a loop: seconds "
                 "(30s) or frames (300)")
      .group(group)
      .type_name("TIME");
  app.add_option("--times", inputs.times,
                 "times of --poses that have none (KITTI's times.txt), one a line")
      .group(group)
      .type_name("FILE");
  add_setting(app, "--frames-by", inputs.frames,
              "what names frames in --loops: auto (default: time stamps if any has a decimal "
              "point, or all are beyond the last frame), index or time")
      .group(group);
}

bool is_given(const LoopInputs& inputs) {
  return !inputs.path.empty() || !inputs.times.empty() || !inputs.gap.empty() ||
         inputs.frames != LoopFrames::automatic;
}

void run_loops(Session& session, const EvalInputs& inputs) {
  refuse_others(inputs);
  session.claim_output();
  check_picture_outputs(session, inputs.pictures);
  const Stopwatch watch;
  const LoopsEvaluation evaluation = evaluate(inputs);
  Json report = loops_json(evaluation, session.run);
  RunInfo run = session.run;
  run.paths = {{"loops", inputs.loops.path}, {"poses", inputs.scores.poses}};
  report["machine"] = machine_json(run);
  report["timing"] = timing_json({{"evaluate", watch.elapsed_s()}});
  session.write_output(report);
  if (!inputs.pictures.html.empty())
    session.outputs.file(inputs.pictures.html).write(loops_page(evaluation, session.run));
  if (!inputs.pictures.plots.empty())
    draw_loops(evaluation,
               session.outputs.folder(inputs.pictures.plots, is_marked_folder).temporary());
  std::string text = render_table(loops_table(evaluation), inputs.format);
  if (inputs.format == TableFormat::text)
    text = loops_sentence(evaluation) + "\n\n" + text + loops_mistakes(evaluation);
  session.print_result(text, report);
}

}  // namespace vpr
