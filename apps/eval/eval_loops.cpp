#include <cmath>
#include <memory>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "base/named_table.h"
#include "base/stopwatch.h"
#include "eval.h"
#include "evaluate/metrics.h"
#include "loops/loops_report.h"
#include "truth/layouts.h"
#include "truth/times.h"

namespace vpr {
namespace {

constexpr double kMaxGap = 1e9;

/// Empty strings: not given.
struct LoopInputs {
  std::string path;
  std::string poses;
  std::string times;
  std::optional<double> radius_m;
  std::optional<double> angle_deg;
  std::optional<double> ignore_radius_m;
  std::string gap;
  LoopFrames frames = LoopFrames::automatic;
  std::optional<double> max_difference_s;
  ScoreInput scores;
  std::string name;
  std::string html;
  std::string plots;
  TableFormat format = TableFormat::text;
};

void warn_of_loop_order(const LoopsEvaluation& found, const Monitor& monitor) {
  constexpr double kClear = 1.5;
  if (!found.judgment.curve) return;
  const bool is_distance = found.rules.order == ScoreOrder::distance;
  LoopRules other = found.rules;
  other.order = is_distance ? ScoreOrder::similarity : ScoreOrder::distance;
  const auto reversed = judge_loops(found.list, found.trajectory, other);
  const auto ap = average_precision(*found.judgment.curve).value;
  const auto other_ap = average_precision(*reversed.curve).value;
  if (ap && other_ap && *other_ap > kClear * *ap)
    warn(monitor, "{}: AP is {:.4f} with --{} and {:.4f} with --{}", found.name, *ap,
         enum_name(found.rules.order), *other_ap, enum_name(other.order));
}

LoopsEvaluation evaluate(const LoopInputs& inputs, const Monitor& monitor) {
  const std::filesystem::path path = inputs.path;
  LoopsEvaluation found;
  found.name = inputs.name.empty() ? path.stem().string() : inputs.name;
  found.rules = {{*inputs.radius_m, inputs.angle_deg, inputs.ignore_radius_m},
                 parse_loop_gap(inputs.gap, "--gap"),
                 inputs.scores.is_distance ? ScoreOrder::distance : ScoreOrder::similarity};
  found.trajectory = read_trajectory(inputs.poses, inputs.times);
  warn_of_steps(found.trajectory, monitor);
  LoopListRules rules;
  rules.frames = inputs.frames;
  if (const auto seconds = inputs.max_difference_s) {
    if (!(*seconds >= 0 && *seconds <= kMaxGap))
      throw Error(ErrorKind::usage, "--max-difference must be 0 to 1e9 seconds");
    rules.max_difference_ns = std::llround(*seconds * double{kSecond});
  }
  if (path.extension() == ".json") {
    refuse(inputs.scores.has_order() || inputs.max_difference_s ||
               inputs.frames != LoopFrames::automatic,
           path.string(),
           "states its frames and scores; omit --similarity, --distance, --frames-by and "
           "--max-difference");
    const Result result = read_result(path).result;
    found.list = loop_list_of(result, path.string(), found.trajectory);
    found.rules.order = result.score().order;
  } else {
    found.list = read_loop_list(path, found.trajectory, rules);
    if (found.list.has_scores && !inputs.scores.has_order())
      throw Error(ErrorKind::usage,
                  "{}: the list has scores. Add --similarity (higher is better) or --distance "
                  "(lower is better)",
                  path.string());
  }
  found.judgment = judge_loops(found.list, found.trajectory, found.rules);
  if (const std::string fault =
          gap_fault(found.rules.gap, found.trajectory.times_ns, found.trajectory.poses.size());
      !fault.empty())
    warn(monitor, "{}: --gap {} {}. Check the unit of its times", inputs.poses, inputs.gap, fault);
  if (inputs.angle_deg) warn_of_headings(inputs.poses, found.trajectory.poses, monitor);
  if (inputs.scores.has_order()) warn_of_loop_order(found, monitor);
  return found;
}

void run_loops(Session& session, const LoopInputs& inputs) {
  session.claim_output({inputs.html}, inputs.plots);
  const Stopwatch watch;
  const LoopsEvaluation evaluation = evaluate(inputs, session.monitor);
  Json report = loops_json(evaluation, session.run);
  RunInfo run = session.run;
  run.paths = {{"loops", inputs.path}, {"poses", inputs.poses}};
  add_run(report, run, {{"evaluate", watch.elapsed_s()}});
  session.write_output(report);
  if (!inputs.html.empty())
    session.outputs.file(inputs.html).write(loops_page(evaluation, session.run));
  if (!inputs.plots.empty())
    draw_loops(evaluation, session.outputs.folder(inputs.plots, is_marked_folder).temporary());
  std::string tables = render_table(loops_table(evaluation), inputs.format);
  if (inputs.format == TableFormat::text) tables += loops_mistakes(evaluation);
  session.print_result(output_text(session, inputs.format, loops_text(evaluation), tables), report);
}

void add_nearness_flags(const Command& command, LoopInputs& inputs) {
  command
      .add_option("--radius", inputs.radius_m,
                  "largest distance of the two frames of a correct loop, in meters")
      .required();
  command.add_option("--angle", inputs.angle_deg,
                     "largest difference of the two headings of a correct loop, in degrees",
                     kMoreGroup);
  command.add_option(
      "--ignore-radius", inputs.ignore_radius_m,
      "loops farther apart than --radius, up to this distance in meters, are ignored", kMoreGroup);
}

}  // namespace

void add_loops(Program& program) {
  const auto inputs = std::make_shared<LoopInputs>();
  const Command command = program.add_command(
      "loops", "Evaluate loop closures by a trajectory.",
      "  vpr-eval loops loops.csv --poses building/laps/poses.csv --radius 1 --gap 60 --distance\n"
      "  vpr-eval loops slam.csv --poses trajectory.txt --radius 2 --gap 30s --similarity\n"
      "  vpr-eval loops result.json --poses poses.txt --pose-times times.txt --radius 2 --gap 15s "
      "--plot plots",
      [inputs](Session& session) { run_loops(session, *inputs); });
  command
      .add_option("LIST", inputs->path,
                  "loop closures of a SLAM system, or a result of vpr-query loops; a list is a CSV "
                  "query,match[,score] of indices or time stamps")
      .required();
  command
      .add_option("--poses", inputs->poses,
                  fmt::format("trajectory of the frames: {}, or a CSV frame,x,y or lat,lon",
                              fmt::join(names_of(layouts()), ", ")),
                  kEssentialGroup, "FILE")
      .required();
  add_nearness_flags(command, *inputs);
  command
      .add_option(
          "--gap", inputs->gap,
          "minimum separation of the two frames of a loop, in seconds (30s) or frames (300)",
          kEssentialGroup, "TIME")
      .required();
  const Flag distance =
      command.add_flag("--distance", inputs->scores.is_distance, "small scores are better");
  command.add_flag("--similarity", inputs->scores.is_similarity, "large scores are better")
      .excludes(distance);
  command.add_option("--html", inputs->html,
                     "HTML page with the map and the curve; one file that opens without a network",
                     kEssentialGroup, "FILE");
  command.add_option("--plot", inputs->plots,
                     "folder for the map and the curve as SVG, PDF and PNG", kMoreGroup, "FOLDER");
  command.add_option("--pose-times", inputs->times,
                     "times of --poses without times (KITTI's times.txt), one per line", kMoreGroup,
                     "FILE");
  add_setting(command, "--frames-by", inputs->frames,
              "meaning of frames in LIST: auto (time stamps if any has a decimal point, or if all "
              "are beyond the last frame), index or time (default: auto)",
              kMoreGroup);
  command.add_option(
      "--max-difference", inputs->max_difference_s,
      "longest time from a frame of LIST to its nearest pose in seconds (default: 0.02)",
      kMoreGroup);
  command.add_option("--name", inputs->name, "name in the output (default: the name of the file)",
                     kMoreGroup);
  add_format_flag(command, inputs->format).group(kMoreGroup);
}

}  // namespace vpr
