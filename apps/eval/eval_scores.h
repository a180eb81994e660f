// Score matrices on the command line of vpr-eval.
#pragma once

#include <optional>
#include <string>

#include "base/json_fwd.h"
#include "common/command.h"
#include "evaluation/judgement.h"
#include "ground_truth/dataset.h"
#include "report/result_file.h"

namespace vpr {

struct ScoreInputs {
  std::string path;  ///< empty: none
  bool is_distance = false;
  bool is_similarity = false;
  bool references_first = false;
  std::optional<double> missing;
  std::optional<double> threshold;
  uint64_t window_length = 1;
  std::string name;   ///< for tables; empty: the file's, or the method
  std::string poses;  ///< of the query, for metres
};

/// A report without "machine" and "timing", and what it was made from.
struct Evaluation {
  Json report;
  GroundTruthArgument ground_truth;
  GroundTruth truth;
  Judgement judgement;
  std::optional<ScoreMatrix> matrix;
  std::string summary = {};       ///< in one sentence
  std::string recognitions = {};  ///< rows of --recognitions-csv, where they are asked for
};

void add_score_options(const Command& app, ScoreInputs& inputs);

/// What the metrics are, for --help.
std::string metrics_help();

/// Throws Error(usage) for flags that need --scores, or that a result answers already.
void check_score_inputs(const ScoreInputs& inputs, bool has_result);

/// The matrix of --scores alone. Throws Error(usage) unless its kind is known.
ScoreMatrix open_scores(const ScoreInputs& inputs);

/// The matrix that was saved with a result; `missing` stands where it has no score.
ScoreMatrix open_saved_scores(const ScoreInputs& inputs, double missing);

/// What --poses says; nothing without it.
std::vector<double> travelled_way(const ScoreInputs& inputs, size_t query_frames,
                                  const Monitor& monitor);

/// Evaluates --scores alone. `query`: its name for the report.
Evaluation evaluate_scores(Session& session, const ScoreInputs& inputs, const std::string& query,
                           const GroundTruthArgument& ground_truth);

/// A result's judgement, with --scores if there are any: the matrix that was saved with it.
Judgement judge_result(Session& session, const ScoreInputs& inputs,
                       const std::optional<ScoreMatrix>& matrix, const Result& result,
                       const GroundTruth& truth);

}  // namespace vpr
