#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "base/error.h"
#include "base/text.h"
#include "common/flags.h"
#include "eval.h"
#include "evaluate/metrics.h"

namespace vpr {

/// The keys of a configuration file.
template <class Visitor>
void visit_fields(EvalInputs& inputs, Visitor&& visit) {
  visit("tolerance", inputs.flags.tolerance_frames);
  visit("format", inputs.format);
  visit("confidence", inputs.confidence);
}

namespace {

constexpr uint64_t kMaxWindow = 1'000'000;
constexpr uint64_t kMaxFrames = 10'000'000;
constexpr uint64_t kMaxPairs = 1'000'000;  // per query
constexpr const char* kWindowFlag = "--rows-are-windows-of";

void check_range(const char* flag, uint64_t value, uint64_t most) {
  if (value == 0 || value > most)
    throw Error(ErrorKind::usage, fmt::format("{} must be 1 to {}, found {}", flag, most, value));
}

std::string metrics_help() {
  std::string text = "Metrics (of best matches, all pairs of a matrix, and the path):\n";
  for (const Metric& metric : metrics()) {
    const char* parameter = metric.of_ranks != nullptr       ? "K"
                            : metric.of_stretches != nullptr ? "r"
                                                             : "";
    text +=
        fmt::format("  {:<32}{}\n", fmt::format("{}{}", metric.symbol, parameter), metric.meaning);
  }
  return text;
}

void add_score_options(const Command& app, ScoreInputs& inputs) {
  const std::string group = "Scores";
  app.add_option("--scores", inputs.matrix.path,
                 "query x reference matrix of any program (.npy); with RESULT, the matrix that "
                 "was saved with it")
      .group(group)
      .type_name("FILE");
  add_score_flags(app, inputs.matrix, group);
  app.add_option("--query-npy", inputs.query_npy,
                 "descriptors of the query (n x d array, .npy) instead of scores: 1 - cos in "
                 "float64 to --train-npy; for uint8 and bool, the Hamming distance")
      .group(group)
      .type_name("FILE");
  app.add_option("--train-npy", inputs.train_npy, "descriptors of the references")
      .group(group)
      .type_name("FILE");
  add_setting(app, "--metric", inputs.metric,
              "distance of descriptors: cosine, l2 (Euclidean) or chord (Euclidean at length 1) "
              "(default: cosine)")
      .group(group);
  app.add_option("--recall-at", inputs.recall_at, "K of recall@K of scores (default: 1,5,10,20)")
      .group(group)
      .comma_separated()
      .type_name("K");
  add_setting(app, kWindowFlag, inputs.window_length,
              "frames per row and column of --scores, each a window that is judged at its last "
              "frame (default: 1). vpr-query --scores --c-l N computes windows")
      .type_name("N")
      .group(group);
  add_setting(app, "--threshold", inputs.threshold,
              "score from which best matches count as recognized along the path (default: the "
              "threshold of recall at 100 % precision)")
      .group(group);
  add_speed_flag(
      app, inputs.speed,
      "simulated speed of the query of --scores (below), with --seed and --query-frames; "
      "a result states its own")
      .group(group);
  app.add_option("--query-frames", inputs.query_frames,
                 "frames of the query before --speed: required by --speed, otherwise checked")
      .group(group)
      .type_name("NUMBER");
  app.add_option("--poses", inputs.poses,
                 "positions of the query's frames (CSV frame,x,y in meters), for gaps in meters "
                 "(default: those of the data set); for --loops, the trajectory as TUM, KITTI, "
                 "EuRoC or CSV")
      .group(group)
      .type_name("FILE");
}

void add_loop_options(const Command& app, LoopInputs& inputs) {
  const std::string group = "Loop closures";
  app.add_option("--loops", inputs.path,
                 "list of a SLAM system's loop closures (CSV query,match[,score], of indices or "
                 "time stamps), or a result of vpr-query --loop; with --poses, --radius and --gap")
      .group(group)
      .type_name("FILE");
  app.add_option("--gap", inputs.gap,
                 "minimum separation of the two frames of a loop, in seconds (30s) or frames (300)")
      .group(group)
      .type_name("TIME");
  app.add_option("--pose-times", inputs.times,
                 "times of --poses without times (KITTI's times.txt), one per line")
      .group(group)
      .type_name("FILE");
  add_setting(app, "--frames-by", inputs.frames,
              "meaning of frames in --loops: auto (time stamps if any has a decimal point, or if "
              "all are beyond the last frame), index or time (default: auto)")
      .group(group);
}

void add_output_options(const Command& app, EvalInputs& inputs) {
  const std::string lists = "Lists";
  app.add_option("--predictions", inputs.scores.predictions,
                 "matches of any program instead of scores: a folder preds of "
                 "VPR-methods-evaluation, or a file with one \"query reference\" or \"query "
                 "reference score\" per line; frames are numbers, or names of --query and --train")
      .group(lists)
      .type_name("PATH");
  app.add_option("--pairs", inputs.pairs,
                 "write the best references of each query, one \"query reference\" per line, as "
                 "for hloc; needs no ground truth")
      .group(lists)
      .type_name("FILE");
  add_setting(app, "--top-k", inputs.top_k,
              "references per query in --pairs (default: 1 for a result, 10 for scores)")
      .group(lists)
      .type_name("K");
  const std::string plots = "Reports and plots";
  app.add_option("--html", inputs.html,
                 "write an HTML report: one file that opens without a network; a result needs no "
                 "ground truth")
      .group(plots)
      .type_name("FILE");
  app.add_option("--plot", inputs.plots,
                 "draw curves, timeline and matrix as SVG and PNG into this folder")
      .group(plots)
      .type_name("FOLDER");
  app.add_option("--query", inputs.query,
                 "frames of the query for --html: a sequence, or its name in the data set")
      .group(plots)
      .type_name("SEQUENCE");
  app.add_list("--train", inputs.train,
               "training sequence for --html; repeat it in the order of the database")
      .group(plots)
      .type_name("SEQUENCE");
  app.add_option("--map", inputs.map,
                 "draw plan, training paths and recognitions along the query's path as SVG and PNG "
                 "into this folder; needs --dataset with poses")
      .group(plots)
      .type_name("FOLDER");
  app.add_option("--map-with", inputs.map_with,
                 "second result of the same query, on a map next to the first (such as FAB-MAP and "
                 "FastABLE)")
      .group(plots)
      .type_name("RESULT");
}

}  // namespace

void add_eval_flags(Program& program, EvalInputs& inputs) {
  const Command app = program.command();
  app.add_option("RESULT", inputs.results,
                 "result of vpr-query; several make one table with one row per result");
  app.add_option("--ground-truth", inputs.ground_truth, ground_truth_help());
  app.add_option("--dataset", inputs.dataset, "data set description that names the ground truth");
  app.add_list("--name", inputs.names,
               "name of the result or the scores in tables and comparisons (default: the method, "
               "or the name of the file); repeat it for several results, in their order");
  app.add_option("--expect", inputs.expected,
                 "compare with a vpr.expected/3 file (numbers, with \"tolerance\", or \"min\" and "
                 "\"max\") or an earlier report; exit code 5 if they differ")
      .type_name("FILE");
  app.add_flag("--update", inputs.update,
               "replace the values in the file of --expect; tolerances and bounds that are met "
               "stay. Without the file, write the report there");
  app.add_option("--junit", inputs.junit,
                 "write the comparison of --expect as JUnit XML, one test case per value")
      .type_name("FILE");
  add_score_options(app, inputs.scores);
  add_loop_options(app, inputs.loops);
  add_output_options(app, inputs);
  app.add_option("--protocol", inputs.protocols,
                 "presets of a ground truth, one or several with commas, or nordland-all; one row "
                 "per preset");
  add_ground_truth_flags(app, inputs.flags);
  app.add_option("--outcomes-csv", inputs.outcomes_csv,
                 "write one row per query: its best match and the verdict")
      .type_name("FILE");
  app.add_option("--recognitions-csv", inputs.recognitions_csv,
                 "write one row per recognized place: frames, recognitions and the verdict")
      .type_name("FILE");
  app.add_option("--save-trajectory", inputs.saved_trajectory,
                 "write the positions of recognized frames as a TUM trajectory (time x y z qx qy "
                 "qz qw), as for evo; needs poses of training frames: --dataset, or "
                 "--ground-truth-train")
      .type_name("FILE");
  program.add_config(app, inputs);
  add_setting(app, "--confidence", inputs.confidence,
              "value by which curves, metrics, plots and comparisons accept best matches: score, "
              "or margin, the difference from the best match outside the exclusion zone (default: "
              "as the result was decided); the other one is reported next to it");
  add_setting(app, "--stretch", inputs.scores.stretch_frames,
              fmt::format("frames per stretch of the path, for the recall achievement rate "
                          "(default: {})",
                          kDefaultStretch));
  add_setting(app, "--format", inputs.format,
              "format of the table: text, csv, markdown or latex (default: text)");
  app.add_footer(metrics_help());
}

void check_scores(const ScoreInputs& inputs, bool has_result) {
  const bool has_scores = !inputs.source().empty();
  const bool has_descriptors = !inputs.query_npy.empty();
  const bool has_predictions = !inputs.predictions.empty();
  if (has_descriptors != !inputs.train_npy.empty())
    throw Error(ErrorKind::usage, "--query-npy and --train-npy go together");
  if (int{!inputs.matrix.path.empty() || has_result} + int{has_descriptors} + int{has_predictions} >
      1)
    throw Error(ErrorKind::usage,
                "evaluate one of these: a result with or without --scores, --scores, --query-npy, "
                "or --predictions");
  if (has_predictions)
    for (const auto& [is_given, flag] : {std::pair(inputs.matrix.train_first, "--train-first"),
                                         std::pair(inputs.matrix.missing.has_value(), "--missing"),
                                         std::pair(inputs.window_length != 1, kWindowFlag)})
      refuse(is_given, flag, "is for --scores, not for --predictions");
  if (has_descriptors) {
    refuse_matrix_flags(inputs.matrix, "is for --scores; distances of descriptors are computed");
    refuse(inputs.window_length != 1, kWindowFlag,
           "is for --scores; rows of descriptors are frames. For windows of N frames, use "
           "vpr-train descriptors and vpr-query --query-npy --c-l N");
  }
  const char* without = "describes a matrix. Pass one with --scores";
  if (!has_scores && !has_result) refuse_matrix_flags(inputs.matrix, without);
  refuse(inputs.metric != DescriptorMetric::cosine && !has_descriptors, "--metric",
         "is for descriptors. Pass them with --query-npy");
  for (const auto& [is_given, flag] : {std::pair(inputs.matrix.is_distance, "--distance"),
                                       std::pair(inputs.matrix.is_similarity, "--similarity"),
                                       std::pair(inputs.threshold.has_value(), "--threshold"),
                                       std::pair(!inputs.speed.empty(), "--speed"),
                                       std::pair(inputs.query_frames.has_value(), "--query-frames"),
                                       std::pair(!inputs.recall_at.empty(), "--recall-at"),
                                       std::pair(inputs.window_length != 1, kWindowFlag)}) {
    refuse(is_given && has_result, flag, "cannot be combined with a result, which states it");
    refuse(is_given && !has_scores, flag, without);
  }
  if (inputs.query_frames) check_range("--query-frames", *inputs.query_frames, kMaxFrames);
  check_range(kWindowFlag, inputs.window_length, kMaxWindow);
  check_range("--stretch", inputs.stretch_frames, kMaxFrames);
  for (const uint64_t k : inputs.recall_at) check_range("--recall-at", k, kMaxFrames);
  if (inputs.speed.empty()) return;
  check_speed(inputs.speed);
  refuse(!inputs.query_frames, "--speed", "needs the number of recorded frames: --query-frames N");
}

void check_rows(const ScoreInputs& inputs, size_t rows, std::optional<size_t> query_frames) {
  if (inputs.speed.empty() && inputs.query_frames) query_frames = *inputs.query_frames;
  const size_t frames = rows + inputs.window_length - 1;
  if (query_frames ? frames == *query_frames : inputs.window_length <= rows) return;
  const std::string windows =
      inputs.window_length == 1
          ? counted(rows, "frame")
          : fmt::format("windows of {}", counted(inputs.window_length, "frame"));
  throw Error(
      ErrorKind::data,
      query_frames
          ? fmt::format("{}: its {} rows as {} need a query of {}, found {}", inputs.source(), rows,
                        windows, counted(frames, "frame"), *query_frames)
          : fmt::format("{}: its {} rows are fewer than the frames of one window, {}. Set the "
                        "number of query frames with --query-frames, or correct {}",
                        inputs.source(), rows, inputs.window_length, kWindowFlag));
}

void claim_outputs(const Session& session, const EvalInputs& inputs) {
  session.claim_output();
  check_scores(inputs.scores, !inputs.result.empty());
  refuse(!inputs.map_with.empty() && inputs.map.empty(), "--map-with", "needs --map FOLDER");
  refuse(!inputs.map.empty() && inputs.dataset.empty(), "--map",
         "needs --dataset, whose \"poses\" have the positions of frames");
  refuse(!inputs.recognitions_csv.empty() && inputs.result.empty(), "--recognitions-csv",
         "needs a result of vpr-query; for scores, use --outcomes-csv");
  refuse(!inputs.saved_trajectory.empty() && inputs.dataset.empty() &&
             inputs.flags.options.reference.empty(),
         "--save-trajectory",
         "needs the positions of training frames: --dataset with \"poses\", or "
         "--ground-truth-train");
  refuse(inputs.top_k && inputs.pairs.empty(), "--top-k", "needs --pairs FILE");
  if (inputs.top_k) check_range("--top-k", *inputs.top_k, kMaxPairs);
  if (!inputs.pairs.empty() && inputs.scores.source().empty() && inputs.top_k.value_or(1) > 1)
    throw Error(ErrorKind::usage,
                "a result has one best match per query. For more, pass the matrix that was saved "
                "with it, as in --scores D.npy (vpr-query --save-matrix)");
  if (inputs.expected.empty() && inputs.has_expectation())
    throw Error(ErrorKind::usage, fmt::format("{} needs --expect, the file of expected values",
                                              inputs.update ? "--update" : "--junit"));
  for (const std::string* file : {&inputs.html, &inputs.outcomes_csv, &inputs.recognitions_csv,
                                  &inputs.saved_trajectory, &inputs.pairs, &inputs.junit})
    if (!file->empty()) session.outputs.claim_file(*file);
  for (const std::string* folder : {&inputs.plots, &inputs.map})
    if (!folder->empty()) session.outputs.claim_folder(*folder, is_marked_folder);
}

}  // namespace vpr
