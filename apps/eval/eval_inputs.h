// What vpr-eval is told, and the evaluation of one result or one matrix of scores.
#pragma once

#include <string>
#include <vector>

#include "base/json.h"
#include "common/command.h"
#include "common/ground_truth_flags.h"
#include "eval_csv.h"
#include "eval_expect.h"
#include "eval_lists.h"
#include "eval_loops.h"
#include "eval_map.h"
#include "eval_pictures.h"
#include "eval_scores.h"
#include "eval_trajectory.h"
#include "pipeline/evaluate.h"
#include "report/result_file.h"
#include "report/table.h"

namespace vpr {

struct EvalInputs {
  std::vector<std::string> results;
  std::string result;    ///< the one that is evaluated
  std::string row_name;  ///< what its rows are called
  std::vector<std::string> names;
  std::string ground_truth;
  std::string dataset;
  GroundTruthFlags flags;
  std::string protocols;
  ExpectInputs expect;
  TableFormat format = TableFormat::text;
  std::optional<Confidence> confidence;
  CsvInputs csv;
  ScoreInputs scores;
  PairInputs pairs;
  PictureInputs pictures;
  MapInputs map;
  TrajectoryInputs trajectory;
  LoopInputs loops;
};

/// An evaluation and its report, without "machine" and "timing".
struct Evaluated {
  Evaluation evaluation;
  JudgedBy by;
  Json report;
};

/// Of result i alone, or of the scores.
EvalInputs inputs_of(const EvalInputs& inputs, size_t i);

/// What is read of a result, or of scores alone.
struct OpenedScores {
  std::optional<StoredResult> stored;
  std::optional<ScoreMatrix> matrix;  ///< none of a result without --scores
};

/// Opens what is named. Throws Error(usage) where nothing is, and as evaluate does.
OpenedScores open_inputs(const Session& session, const EvalInputs& inputs);

/// Evaluates the result, or scores alone. Throws Error(usage) where neither is given, or no ground
/// truth and more than pictures of a result is asked for; Error(data) if --scores is not the matrix
/// that was saved with the result.
Evaluated evaluate(Session& session, const EvalInputs& inputs);

/// Names of rows: what the user gave with --name, else the files' own names, with a number where
/// two are equal. `given`: empty, or one for each.
std::vector<std::string> row_names(const std::vector<std::string>& given,
                                   const std::vector<std::string>& paths);

}  // namespace vpr
