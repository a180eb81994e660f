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
  visit("tolerance", inputs.truth.flags.tolerance_frames);
  visit("format", inputs.format);
}

namespace {

constexpr uint64_t kMaxWindow = 1'000'000;
constexpr uint64_t kMaxFrames = 10'000'000;
constexpr uint64_t kMaxPairs = 1'000'000;  // per query
constexpr const char* kWindowFlag = "--rows-are-windows-of";
constexpr const char* kPictureGroup = "Page and plots";
constexpr const char* kFileGroup = "Other outputs";
constexpr const char* kMetricGroup = "Metrics";

void check_range(const char* flag, uint64_t value, uint64_t most) {
  if (value == 0 || value > most)
    throw Error(ErrorKind::usage, "{} must be 1 to {}, found {}", flag, most, value);
}

std::string metrics_help() {
  std::string text = "Metrics (of best matches, all pairs of a matrix, and the path):\n";
  for (const Metric& metric : metrics()) {
    if (metric.meaning.empty()) continue;
    const char* parameter = metric.of_query != nullptr       ? "K"
                            : metric.of_stretches != nullptr ? "r"
                                                             : "";
    text +=
        fmt::format("  {:<32}{}\n", fmt::format("{}{}", metric.symbol, parameter), metric.meaning);
  }
  return text;
}

void add_file_flags(const Command& command, EvalInputs& inputs) {
  command.add_option("--expect", inputs.expected,
                     "compare with a vpr.expected/4 file (numbers, with \"tolerance\", or \"min\" "
                     "and \"max\") or an earlier report; exit code 5 if they differ",
                     kFileGroup, "FILE");
  command.add_flag("--update", inputs.update,
                   "replace the values in the file of --expect; tolerances and bounds that are met "
                   "stay. Without the file, write the report there",
                   kFileGroup);
  command.add_option("--junit", inputs.junit,
                     "JUnit XML file with the comparison of --expect, one test case per value",
                     kFileGroup, "FILE");
  command.add_option("--outcomes-csv", inputs.outcomes_csv,
                     "CSV file with one row per query: its best match and the verdict", kFileGroup,
                     "FILE");
  command.add_option("--pairs", inputs.pairs,
                     "list of the best references of each query, one \"query reference\" per line, "
                     "as for hloc; needs no ground truth",
                     kFileGroup, "FILE");
  add_setting(command, "--top-k", inputs.top_k,
              "references per query in --pairs (default: 1 for a result, 10 for scores)",
              kFileGroup, "K");
  command.add_list("--name", inputs.names,
                   "name in tables and comparisons (default: the name of the file); repeat it for "
                   "several results, in their order",
                   kFileGroup);
  add_format_flag(command, inputs.format).group(kFileGroup);
}

// The flags that the evaluations of results and of scores share.
void add_evaluation_flags(Program& program, const Command& command, EvalInputs& inputs) {
  add_truth_flags(command, inputs.truth);
  command.add_option("--html", inputs.html,
                     "HTML page with charts and images; one file that opens without a network",
                     kEssentialGroup, "FILE");
  command.add_option("--plot", inputs.plots,
                     "folder for curves, timeline and matrix with ground truth, as SVG and PNG",
                     kPictureGroup, "FOLDER");
  command.add_option("--query", inputs.query,
                     "query, for its images and names: a sequence, or its name in the data set",
                     kPictureGroup, "SEQUENCE");
  command.add_list(
      "--train", inputs.train,
      "training sequence, for its images and names; repeat it in the order of the database",
      kPictureGroup, "SEQUENCE");
  command.add_option("--poses", inputs.by.poses,
                     "positions of the query's frames (CSV frame,x,y in meters), for gaps in "
                     "meters (default: those of the data set)",
                     kMetricGroup, "FILE");
  add_setting(
      command, "--stretch", inputs.by.stretch_frames,
      fmt::format("frames per stretch of the path, for the recall achievement rate (default: {})",
                  kDefaultStretch),
      kMetricGroup);
  add_file_flags(command, inputs);
  program.add_config(command, inputs);
  command.add_footer(metrics_help());
}

// The order of list files, and flags that only a matrix has.
void check_scores(const ScoreInputs& inputs) {
  const bool has_descriptors = !inputs.query_npy.empty();
  if (has_descriptors != !inputs.train_npy.empty())
    throw Error(ErrorKind::usage, "--query-npy and --train-npy go together");
  if (has_descriptors && !inputs.path.empty())
    throw Error(ErrorKind::usage,
                "evaluate one of these: SCORES, or descriptors (--query-npy and --train-npy)");
  if (inputs.is_list())
    for (const auto& [is_given, flag] : {std::pair(inputs.matrix.train_first, "--train-first"),
                                         std::pair(inputs.matrix.missing.has_value(), "--missing"),
                                         std::pair(inputs.window_length != 1, kWindowFlag)})
      refuse(is_given, flag, "is for a matrix (.npy), not for a list of matches");
  if (has_descriptors) {
    for (const auto& [is_given, flag] : {std::pair(inputs.matrix.is_distance, "--distance"),
                                         std::pair(inputs.matrix.is_similarity, "--similarity"),
                                         std::pair(inputs.matrix.train_first, "--train-first"),
                                         std::pair(inputs.matrix.missing.has_value(), "--missing")})
      refuse(is_given, flag, "is for SCORES; distances of descriptors are computed");
    refuse(inputs.window_length != 1, kWindowFlag,
           "is for SCORES; rows of descriptors are frames. For windows of N frames, use vpr-train "
           "descriptors and vpr-query --query-npy --c-l N");
  }
  refuse(inputs.metric && !has_descriptors, "--metric",
         "is for descriptors. Pass them with --query-npy");
  if (inputs.query_frames) check_range("--query-frames", *inputs.query_frames, kMaxFrames);
  if (inputs.train_frames) check_range("--train-frames", *inputs.train_frames, kMaxFrames);
  refuse(inputs.train_frames && has_descriptors, "--train-frames", "is for lists of numbers");
  check_range(kWindowFlag, inputs.window_length, kMaxWindow);
  if (inputs.speed.empty()) return;
  check_speed(inputs.speed);
  refuse(!inputs.query_frames, "--speed", "needs the number of recorded frames: --query-frames N");
}

}  // namespace

bool ScoreInputs::is_list() const { return !path.empty() && !path.ends_with(".npy"); }

void add_truth_flags(const Command& command, TruthSource& truth) {
  command.add_option("--ground-truth", truth.path, ground_truth_help());
  add_ground_truth_flags(command, truth.flags);
  command.add_option("--dataset", truth.dataset, "data set description that names the ground truth",
                     kGroundTruthGroup, "FILE");
}

void add_result_flags(Program& program, const Command& command, EvalInputs& inputs) {
  command.add_option("RESULT", inputs.results,
                     "result of vpr-query; several make one table with one row per result");
  add_evaluation_flags(program, command, inputs);
  command.add_option("--places", inputs.by.places,
                     "CSV file of the page of --ask-places: judge each place, and its "
                     "recognitions, by your answer instead of a ground truth",
                     kGroundTruthGroup, "FILE");
  command.add_option(
      "--matrix", inputs.matrix,
      "matrix that was saved with RESULT (vpr-query --save-matrix), for ranks and all pairs",
      kMetricGroup, "FILE");
  add_setting(command, "--confidence", inputs.by.confidence,
              "value by which curves, metrics, plots and comparisons accept best matches: score, "
              "or margin, the difference from the best match outside the exclusion zone (default: "
              "as the result was decided); the other one is reported next to it",
              kMetricGroup);
  command.add_option(
      "--ask-frames", inputs.frame_questions,
      "HTML page that shows the images of frames and their best matches, asks whether they are the "
      "same place, and saves labels for --ground-truth, by which any result can be judged",
      kPictureGroup, "FILE");
  command.add_option("--ask-places", inputs.place_questions,
                     "HTML page that shows images of each recognized place, asks whether it is the "
                     "same place, and saves the answers for --places",
                     kPictureGroup, "FILE");
  command.add_option("--map", inputs.map,
                     "folder for a map with plan, training paths and recognitions along the "
                     "query's path, as SVG and PNG; needs --dataset with poses",
                     kPictureGroup, "FOLDER");
  command.add_option(
      "--map-with", inputs.map_with,
      "second result of the same query, on a map next to the first (such as FAB-MAP and FastABLE)",
      kPictureGroup, "RESULT");
  command.add_option(
      "--recognitions-csv", inputs.recognitions_csv,
      "CSV file with one row per recognized place: frames, recognitions and the verdict",
      kFileGroup, "FILE");
  command.add_option(
      "--save-trajectory", inputs.saved_trajectory,
      "TUM trajectory of the positions of recognized frames (time x y z qx qy qz qw), as for evo; "
      "needs poses of training frames: --dataset, or --ground-truth-train",
      kFileGroup, "FILE");
}

void add_matrix_flags(Program& program, const Command& command, EvalInputs& inputs) {
  ScoreInputs& scores = inputs.scores;
  command.add_option("SCORES", scores.path,
                     "query x training matrix (.npy), or a list of matches; a list has one \"query "
                     "reference\" or \"query reference score\" per line, or is a folder preds of "
                     "VPR-methods-evaluation. Frames are numbers, or names of --query and --train");
  const Flag distance =
      command.add_flag("--distance", scores.matrix.is_distance, "small scores are better");
  command.add_flag("--similarity", scores.matrix.is_similarity, "large scores are better")
      .excludes(distance);
  command.add_flag("--train-first", scores.matrix.train_first,
                   "rows of the matrix are training frames, columns are queries");
  add_setting(command, "--missing", scores.matrix.missing,
              "value of missing scores, in addition to NaN");
  const std::string descriptors = "Descriptors instead of scores";
  command.add_option("--query-npy", scores.query_npy,
                     "descriptors of the query (n x d array, .npy); their distances to --train-npy "
                     "are computed, for uint8 and bool as Hamming distances",
                     descriptors, "FILE");
  command.add_option("--train-npy", scores.train_npy, "descriptors of the training frames",
                     descriptors, "FILE");
  add_setting(command, "--metric", scores.metric,
              "distance of descriptors: cosine (1 - cos in float64), l2 (Euclidean) or chord "
              "(Euclidean at length 1) (default: cosine)",
              descriptors);
  const std::string rows = "Rows of the scores";
  add_setting(command, kWindowFlag, scores.window_length,
              "frames per row and column, each a window that is judged at its last frame (default: "
              "1)",
              rows, "N");
  command.add_option("--query-frames", scores.query_frames,
                     "frames of the query before --speed: required by --speed, otherwise checked",
                     rows, "NUMBER");
  command.add_option(
      "--train-frames", scores.train_frames,
      "training frames of a list of numbers (default: --train, or the largest number)", rows,
      "NUMBER");
  add_speed_flag(command, scores.speed,
                 "simulated speed of the query (below), with --seed and --query-frames")
      .group(rows);
  add_evaluation_flags(program, command, inputs);
  command
      .add_option("--recall-at", inputs.by.recall_at, "K of recall@K (default: 1,5,10,20)",
                  kMetricGroup, "K")
      .comma_separated();
  add_setting(command, "--threshold", scores.threshold,
              "score from which best matches count as recognized (default: the threshold of recall "
              "at 100 % precision)",
              kMetricGroup);
}

void check_inputs(const EvalInputs& inputs) {
  check_scores(inputs.scores);
  check_evaluation(inputs.by);
  refuse(!inputs.map_with.empty() && inputs.map.empty(), "--map-with", "needs --map FOLDER");
  refuse(!inputs.by.places.empty() && !inputs.truth.path.empty(), "--places",
         "replaces the ground truth. Omit --ground-truth");
  refuse(!inputs.by.places.empty() && !inputs.map_with.empty(), "--places",
         "has answers for one result. Omit --map-with");
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
  check_inputs(inputs);
  refuse(!inputs.map.empty() && inputs.truth.dataset.empty(), "--map",
         "needs --dataset, whose \"poses\" have the positions of frames");
  refuse(!inputs.saved_trajectory.empty() && inputs.truth.dataset.empty() &&
             inputs.truth.flags.options.reference.empty(),
         "--save-trajectory",
         "needs the positions of training frames: --dataset with \"poses\", or "
         "--ground-truth-train");
  refuse(inputs.top_k && inputs.pairs.empty(), "--top-k", "needs --pairs FILE");
  if (inputs.top_k) check_range("--top-k", *inputs.top_k, kMaxPairs);
  if (!inputs.result.empty() && inputs.matrix.empty() && inputs.top_k.value_or(1) > 1)
    throw Error(ErrorKind::usage,
                "a result has one best match per query. For more, pass the matrix that was saved "
                "with it, as in --matrix D.npy (vpr-query --save-matrix)");
  if (inputs.expected.empty() && inputs.has_expectation())
    throw Error(ErrorKind::usage, "{} needs --expect, the file of expected values",
                inputs.update ? "--update" : "--junit");
  session.claim_output(
      {inputs.html, inputs.frame_questions, inputs.place_questions, inputs.outcomes_csv,
       inputs.recognitions_csv, inputs.saved_trajectory, inputs.pairs, inputs.junit},
      inputs.plots);
  if (!inputs.map.empty()) session.outputs.claim_folder(inputs.map, is_marked_folder);
}

}  // namespace vpr
