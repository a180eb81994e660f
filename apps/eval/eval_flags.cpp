#include <algorithm>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "base/error.h"
#include "base/json_schema.h"
#include "base/text.h"
#include "common/flags.h"
#include "eval.h"
#include "evaluate/metrics.h"

namespace vpr {

/// The keys of a configuration file.
template <class Visitor>
void visit_fields(EvalFlags& flags, Visitor&& visit) {
  visit("tolerance", flags.truth.flags.tolerance_frames, "Tolerance, in frames.", at_least(0));
  visit("format", flags.format, "Form of tables.");
}

Json eval_config_schema() { return schema_of<EvalFlags>(SchemaForm::partial); }

namespace {

constexpr uint64_t kMaxWindow = 1'000'000;
constexpr uint64_t kMaxFrames = 10'000'000;
constexpr uint64_t kMaxPairs = 1'000'000;  // per query
constexpr const char* kWindowFlag = "--rows-are-windows-of";
constexpr const char* kMetricGroup = "Metrics";

void check_range(const char* flag, uint64_t value, uint64_t most) {
  if (value == 0 || value > most)
    throw Error(ErrorKind::usage, "{} must be 1 to {}, found {}", flag, most, value);
}

// Numbers between separators, each in the range.
std::vector<double> read_numbers(const std::string& flag, const std::string& text, char separator,
                                 size_t count, std::pair<double, double> range) {
  std::vector<double> numbers;
  for (const std::string_view part : split(text, separator))
    if (const auto number = parse_number<double>(part);
        number && *number >= range.first && *number <= range.second)
      numbers.push_back(*number);
  if (numbers.size() != count ||
      static_cast<size_t>(std::ranges::count(text, separator)) + 1 != count)
    throw Error(ErrorKind::usage,
                "{} needs {} numbers from {} to {}, separated by {}, found \"{}\"", flag, count,
                range.first, range.second, separator, shortened(text));
  return numbers;
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

void add_file_flags(const Command& command, EvalFlags& flags) {
  command.add_option("--expect", flags.expected,
                     "compare with a vpr.expected/5 file (numbers, with \"tolerance\", or \"min\" "
                     "and \"max\") or an earlier report; exit code 5 if they differ",
                     kFileGroup, "FILE");
  command.add_flag("--update", flags.update,
                   "replace the values in the file of --expect; tolerances and bounds that are met "
                   "stay. Without the file, write the report there",
                   kFileGroup);
  add_setting(command, "--top-k", flags.top_k,
              "references per query in --pairs (default: 1 for a result, 10 for scores)",
              kFileGroup);
  command.add_list("--name", flags.names,
                   "name in tables and comparisons (default: the name of the file); repeat it for "
                   "several results, in their order",
                   kFileGroup);
  command.add_option("--data-set", flags.data_set,
                     "name of the data set, for tables of several (default: the query)", kFileGroup,
                     "NAME");
  add_format_flag(command, flags.format).group(kFileGroup);
}

// The flags that the evaluations of results and of scores share.
void add_evaluation_flags(Program& program, const Command& command, EvalFlags& flags,
                          bool of_scores) {
  add_truth_flags(command, flags.truth);
  for (size_t i = 0; i < flags.outputs.size(); ++i)
    if (const EvalOutput& output = eval_outputs()[i]; output.of_scores || !of_scores)
      command.add_option(std::string(output.flag), flags.outputs[i], std::string(output.help),
                         output.group, output.draw != nullptr ? "FOLDER" : "FILE");
  add_figure_flags(command, flags.figure, kPictureGroup);
  const std::string group = of_scores ? kEssentialGroup : kPictureGroup;
  const std::string without_scores =
      of_scores ? "; without SCORES, descriptors (n x d array, .npy) to compare" : "";
  command.add_option(
      "--query", flags.query,
      "query, for its images and names: a sequence, or its name in the data set" + without_scores,
      group, "SEQUENCE");
  command.add_list(
      "--train", flags.train,
      "training sequence, for its images and names; repeat it in the order of the database" +
          without_scores,
      group, "SEQUENCE");
  command.add_option("--poses", flags.by.poses,
                     "positions of the query's frames (CSV frame,x,y in meters), for gaps in "
                     "meters (default: those of the data set)",
                     kMetricGroup, "FILE");
  add_setting(
      command, "--stretch", flags.by.stretch_frames,
      fmt::format("frames per stretch of the path, for the recall achievement rate (default: {})",
                  kDefaultStretch),
      kMetricGroup);
  add_file_flags(command, flags);
  program.add_config(command, flags);
  command.add_footer(metrics_help());
}

// The order of list files, and flags that only a matrix has.
void check_scores(const ScoreInputs& inputs) {
  const bool has_descriptors = !inputs.query_array.empty();
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
           "descriptors and vpr-query --c-l N");
  }
  refuse(inputs.metric && !has_descriptors, "--metric",
         "is for descriptors. Omit SCORES, and pass them with --query and --train");
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

void add_figure_flags(const Command& command, FigureSettings& figure, const std::string& group) {
  command.add_option(
      "--plot-size",
      [&figure](const std::string& text) {
        const auto size = read_numbers("--plot-size", text, 'x', 2, {40, 1000});
        figure.size_mm = {size[0], size[1]};
      },
      "width and height of plots in mm, as in 85x60; without titles, for papers", group, "WxH");
  command.add_option(
      "--plot-limits",
      [&figure](const std::string& text) {
        figure.limits = read_numbers("--plot-limits", text, ',', 4, {0, 1});
        if (figure.limits[0] >= figure.limits[1] || figure.limits[2] >= figure.limits[3])
          throw Error(ErrorKind::usage, "--plot-limits needs limits in rising order, found \"{}\"",
                      shortened(text));
      },
      "least and greatest recall, then precision, of precision-recall plots (default: 0,1,0,1)",
      group, "R,R,P,P");
}

void add_result_flags(Program& program, const Command& command, EvalFlags& flags) {
  command.add_option("RESULT", flags.results,
                     "result of vpr-query; several make one table with one row per result");
  add_evaluation_flags(program, command, flags, false);
  command.add_option("--places", flags.by.places,
                     "CSV file of the page of --ask-places: judge each place, and its "
                     "recognitions, by your answer instead of a ground truth",
                     kGroundTruthGroup, "FILE");
  command.add_option(
      "--matrix", flags.matrix,
      "matrix that was saved with RESULT (vpr-query --save-matrix), for ranks and all pairs",
      kMetricGroup, "FILE");
  add_setting(command, "--confidence", flags.by.confidence,
              "value by which curves, metrics, plots and comparisons accept best matches: score, "
              "or margin, the difference from the best match outside the exclusion zone (default: "
              "as the result was decided); the other one is reported next to it",
              kMetricGroup);
  command.add_option(
      "--map-with", flags.map_with,
      "second result of the same query, on a map next to the first (such as FAB-MAP and FastABLE)",
      kPictureGroup, "FILE");
}

void add_matrix_flags(Program& program, const Command& command, EvalFlags& flags) {
  ScoreInputs& scores = flags.scores;
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
  add_setting(command, "--metric", scores.metric,
              "distance of descriptors: cosine (1 - cos in float64), l2 (Euclidean) or chord "
              "(Euclidean at length 1) (default: cosine); uint8 and bool: Hamming",
              kMetricGroup);
  const std::string rows = "Rows of the scores";
  add_setting(command, kWindowFlag, scores.window_length,
              "frames per row and column, each a window that is judged at its last frame (default: "
              "1)",
              rows);
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
  add_evaluation_flags(program, command, flags, true);
  command.add_option("--query-name", flags.query_name,
                     "name of the query in tables (default: of --query)", kFileGroup, "NAME");
  command
      .add_option("--recall-at", flags.by.recall_at, "K of recall@K (default: 1,5,10,20)",
                  kMetricGroup, "LIST")
      .comma_separated();
  add_setting(command, "--threshold", scores.threshold,
              "score from which best matches count as recognized (default: the threshold of recall "
              "at 100 % precision)",
              kMetricGroup);
}

EvalFlags::EvalFlags() : outputs(eval_outputs().size()) {}

void check_flags(const EvalFlags& flags) {
  constexpr const char* kTakesOne =
      "takes one result. For a page of several, use vpr-eval compare --html FILE";
  const bool is_one = flags.results.size() < 2;
  check_scores(flags.scores);
  check_evaluation(flags.by);
  for (const auto& [is_given, flag] :
       {std::pair(!flags.matrix.empty(), "--matrix"),
        std::pair(!flags.by.places.empty(), "--places"),
        std::pair(!flags.expected.empty(), "--expect"), std::pair(flags.update, "--update")})
    refuse(is_given && !is_one, flag, kTakesOne);
  for (const GivenOutput& given : given_outputs(flags)) {
    const std::string flag(given.output->flag);
    refuse(!is_one && !given.output->of_several, flag, kTakesOne);
    if (given.output->lacks == nullptr) continue;
    const std::string lacking(given.output->lacks(flags));
    refuse(!lacking.empty(), flag, lacking);
  }
  refuse(flags.update && flags.expected.empty(), "--update", kNeedsExpected);
  refuse(!flags.map_with.empty() && flags.output("--map").empty(), "--map-with",
         "needs --map FOLDER");
  refuse(!flags.by.places.empty() && !flags.truth.path.empty(), "--places",
         "replaces the ground truth. Omit --ground-truth");
  refuse(!flags.by.places.empty() && !flags.map_with.empty(), "--places",
         "has answers for one result. Omit --map-with");
  refuse(flags.top_k && flags.output("--pairs").empty(), "--top-k", "needs --pairs FILE");
  if (flags.top_k) check_range("--top-k", *flags.top_k, kMaxPairs);
  if (!flags.results.empty() && flags.matrix.empty() && flags.top_k.value_or(1) > 1)
    throw Error(ErrorKind::usage,
                "a result has one best match per query. For more, pass the matrix that was saved "
                "with it, as in --matrix D.npy (vpr-query --save-matrix)");
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

}  // namespace vpr
