#include <algorithm>

#include <fmt/format.h>

#include "base/error.h"
#include "base/text.h"
#include "common/selection_flags.h"
#include "eval_inputs.h"
#include "evaluate/metrics.h"
#include "sequence/sequence_source.h"

namespace vpr {
namespace {

constexpr uint64_t kMostWindow = 1'000'000;
constexpr uint64_t kMostFrames = 10'000'000;
constexpr const char* kWindowFlag = "--rows-are-windows-of";

void check_frames(const ScoreInputs& inputs) {
  if (inputs.query_frames && (*inputs.query_frames == 0 || *inputs.query_frames > kMostFrames))
    throw Error(ErrorKind::usage, fmt::format("--query-frames must be 1 to {}, found {}",
                                              kMostFrames, *inputs.query_frames));
  if (inputs.window_length == 0 || inputs.window_length > kMostWindow)
    throw Error(ErrorKind::usage, fmt::format("{} must be 1 to {}, found {}", kWindowFlag,
                                              kMostWindow, inputs.window_length));
  if (inputs.warp.empty()) return;
  check_warp(inputs.warp);
  if (!inputs.query_frames)
    throw Error(ErrorKind::usage, "--warp needs the number of recorded frames: --query-frames N");
}

}  // namespace

void add_score_options(const Command& app, ScoreInputs& inputs) {
  const std::string group = "Scores";
  add_score_flags(
      app, inputs.matrix,
      "query x reference matrix of any program (.npy); with RESULT: the matrix that was "
      "saved with it",
      group);
  app.add_option("--query-npy", inputs.query_npy,
                 "descriptors of the query (n x d numbers, .npy) instead of scores: 1 - cos in "
                 "float64 to all of --reference-npy, of uint8 and bool the bits that differ")
      .group(group)
      .type_name("FILE");
  app.add_option("--reference-npy", inputs.reference_npy, "descriptors of the references")
      .group(group)
      .type_name("FILE");
  add_setting(app, "--metric", inputs.metric, "of descriptors: cosine (default), or l2 (Euclidean)")
      .group(group);
  app.add_option("--recall-at", inputs.recall_at,
                 "K of recall@K of scores, as in 1,5,10,100 (default 1,5,10,20)")
      .group(group)
      .comma_separated()
      .type_name("K");
  add_setting(
      app, kWindowFlag, inputs.window_length,
      "rows and columns of --scores are windows of N frames, not frames; a window is judged "
      "at its last frame (default: 1). vpr-query --scores --c-l N computes windows")
      .type_name("N")
      .group(group);
  add_setting(app, "--threshold", inputs.threshold,
              "best matches from this score on count as recognized along the path (default: that "
              "of recall at 100 % precision)")
      .group(group);
  add_warp_flag(app, inputs.warp,
                "rows of --scores are of a query that was replayed so, with --seed and "
                "--query-frames; results say it themselves (below)")
      .group(group);
  app.add_option("--query-frames", inputs.query_frames,
                 "frames of the query, before --warp: required by it, otherwise checked")
      .group(group)
      .type_name("NUMBER");
  app.add_option(
         "--poses", inputs.poses,
         "positions of the query's frames (CSV frame,x,y in meters): gaps in meters, too (default: "
         "those that the data set names); of --loops the trajectory, as TUM, KITTI, EuRoC or CSV")
      .group(group)
      .type_name("FILE");
}

std::string metrics_help() {
  std::string text = "Metrics (best matches, all pairs of a matrix, and along the path):\n";
  for (const Metric& metric : metrics()) {
    const char* parameter = metric.of_ranks != nullptr       ? "K"
                            : metric.of_stretches != nullptr ? "r"
                                                             : "";
    text +=
        fmt::format("  {:<32}{}\n", fmt::format("{}{}", metric.symbol, parameter), metric.meaning);
  }
  return text;
}

size_t stretch_of(const ScoreInputs& inputs) {
  if (inputs.stretch_frames == 0 || inputs.stretch_frames > kMostFrames)
    throw Error(ErrorKind::usage, fmt::format("--stretch must be 1 to {}, found {}", kMostFrames,
                                              inputs.stretch_frames));
  return inputs.stretch_frames;
}

void check_score_inputs(const ScoreInputs& inputs, bool has_result) {
  const std::string without = "describes a matrix; give it with --scores";
  const std::string beside = "does not go with a result, whose matrix and thresholds are known";
  const bool has_scores = inputs.any();
  if (inputs.query_npy.empty() != inputs.reference_npy.empty())
    throw Error(ErrorKind::usage, "--query-npy and --reference-npy go together");
  if (!inputs.predictions.empty()) {
    if (!inputs.matrix.path.empty() || !inputs.query_npy.empty() || has_result)
      throw Error(ErrorKind::usage,
                  "--predictions are evaluated by themselves, without a result and other scores");
    for (const auto& [is_given, flag] :
         {std::pair(inputs.matrix.references_first, "--references-first"),
          std::pair(inputs.matrix.missing.has_value(), "--missing"),
          std::pair(inputs.window_length != 1, kWindowFlag)})
      refuse(is_given, flag, "is for --scores; pairs that --predictions do not list have none");
  }
  if (!inputs.query_npy.empty()) {
    if (!inputs.matrix.path.empty() || has_result)
      throw Error(ErrorKind::usage,
                  "descriptors (--query-npy) are evaluated by themselves, without a result and "
                  "without --scores");
    refuse_format(inputs.matrix, "is for --scores; distances of descriptors are computed");
    refuse(
        inputs.window_length != 1, kWindowFlag,
        "is for --scores; rows of descriptors are frames. For windows of N frames, use vpr-train "
        "descriptors and vpr-query --query-npy --c-l N");
  }
  if (!has_scores && !has_result) refuse_format(inputs.matrix, without);
  refuse(inputs.metric != DescriptorMetric::cosine && inputs.query_npy.empty(), "--metric",
         "compares descriptors; give it with --query-npy");
  for (const auto& [is_given, flag] : {std::pair(inputs.matrix.is_distance, "--distance"),
                                       std::pair(inputs.matrix.is_similarity, "--similarity"),
                                       std::pair(inputs.threshold.has_value(), "--threshold"),
                                       std::pair(!inputs.warp.empty(), "--warp"),
                                       std::pair(inputs.query_frames.has_value(), "--query-frames"),
                                       std::pair(!inputs.recall_at.empty(), "--recall-at"),
                                       std::pair(inputs.window_length != 1, kWindowFlag)}) {
    refuse(is_given && has_result, flag, beside);
    refuse(is_given && !has_scores, flag, without);
  }
  check_frames(inputs);
}

std::vector<size_t> recall_at_of(const ScoreInputs& inputs) {
  if (inputs.recall_at.empty()) return {};
  std::vector<size_t> all = {1};
  for (const uint64_t k : inputs.recall_at) {
    if (k < 1 || k > kMostFrames)
      throw Error(ErrorKind::usage,
                  fmt::format("--recall-at takes 1 to {}, found {}", kMostFrames, k));
    all.push_back(k);
  }
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

void check_rows(const ScoreInputs& inputs, size_t rows, std::optional<size_t> query_frames) {
  if (inputs.warp.empty() && inputs.query_frames) query_frames = *inputs.query_frames;
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
          : fmt::format("{}: its {} rows are fewer than the frames of one window, {}. Give "
                        "the number of query frames with --query-frames, or correct {}",
                        inputs.source(), rows, inputs.window_length, kWindowFlag));
}

}  // namespace vpr
