// The flags of vpr-eval, and one function per job.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/command.h"
#include "common/flags.h"
#include "evaluate/evaluation.h"
#include "evaluate/score_matrix.h"
#include "files/report.h"
#include "files/result_file.h"
#include "present/table.h"

namespace vpr {

/// --ground-truth and --dataset, with the flags that describe a ground truth.
struct TruthSource {
  std::string path;  ///< of --ground-truth; empty: the data set's
  std::string dataset;
  GroundTruthFlags flags;

  bool is_given() const { return !path.empty() || !dataset.empty(); }
};

void add_truth_flags(const Command& command, TruthSource& truth);

/// Scores of any program.
struct ScoreInputs {
  std::string path;  ///< a matrix (.npy) or a list of matches; empty: descriptors
  ScoreInput matrix;
  std::string query_npy;
  std::string train_npy;
  std::optional<DescriptorMetric> metric;
  std::optional<double> threshold;
  uint64_t window_length = 1;
  std::string speed;
  std::optional<uint64_t> query_frames;  ///< before --speed
  std::optional<uint64_t> train_frames;  ///< of a list of numbers

  bool is_list() const;
  /// The path of the scores or of the descriptors; empty without any.
  const std::string& source() const { return query_npy.empty() ? path : query_npy; }
};

/// The inputs of an evaluation: results, or scores. Empty strings: not given.
struct EvalInputs {
  std::vector<std::string> results;
  std::string result;    ///< the one to evaluate
  std::string matrix;    ///< that was saved with the result
  std::string row_name;  ///< its name in tables
  std::string name;      ///< in tables, set by the user
  std::vector<std::string> names;
  TruthSource truth;
  EvaluationSettings by;  ///< as set by flags; without the ground truth
  TableFormat format = TableFormat::text;
  std::optional<std::string> query;  ///< a sequence, or the name of a query in the data set
  std::vector<std::string> train;
  ScoreInputs scores;
  // Outputs
  std::string expected;
  bool update = false;
  std::string junit;
  std::string html;
  std::string plots;
  std::string map;
  std::string map_with;
  std::string saved_trajectory;
  std::string place_questions;  ///< the page that asks for them
  std::string frame_questions;  ///< the page that asks for labels of frames
  bool needs_truth = true;
  std::string pairs;
  std::optional<uint64_t> top_k;
  std::string outcomes_csv;
  std::string recognitions_csv;

  bool has_plots() const { return !html.empty() || !plots.empty(); }
  bool has_csv() const { return !outcomes_csv.empty() || !recognitions_csv.empty(); }
  bool has_expectation() const { return update || !expected.empty() || !junit.empty(); }
};

/// The flags of vpr-eval RESULT, and of vpr-eval matrix.
void add_result_flags(Program& program, const Command& command, EvalInputs& inputs);
void add_matrix_flags(Program& program, const Command& command, EvalInputs& inputs);

/// Throws Error(usage) for flags that cannot be combined, and for values out of range.
void check_inputs(const EvalInputs& inputs);

/// Throws Error(usage) for outputs that cannot be combined or lack an input, and claims the others.
void claim_outputs(const Session& session, const EvalInputs& inputs);

/// Throws Error(data) if `rows` windows do not have the frames that --query-frames or
/// `query_frames` states; if neither is known, if a window is longer than the matrix.
void check_rows(const ScoreInputs& inputs, size_t rows, std::optional<size_t> query_frames);

struct OpenedScores {
  std::shared_ptr<const StoredResult> stored;  ///< null: scores
  std::optional<ScoreMatrix> matrix;  ///< scores, or the matrix that was saved with the result
};

/// Throws Error(usage) without a result or scores, and Error(data) if --matrix was not saved with
/// the result.
OpenedScores open_inputs(const Session& session, const EvalInputs& inputs);

/// The names of query frames, and of training frames by sequence, from --query and --train or the
/// data set; empty without them.
std::vector<std::string> query_names(const EvalInputs& inputs);
std::vector<std::vector<std::string>> train_names(const EvalInputs& inputs);

struct Evaluated {
  Evaluation evaluation;
  EvaluationSettings by;
  Report report;
  std::shared_ptr<const StoredResult> stored = {};  ///< null: scores
};

/// Evaluates the result, or scores without a result. Throws as open_inputs does, and Error(usage)
/// without a ground truth if one is needed.
Evaluated evaluate(Session& session, const EvalInputs& inputs);

/// `brief` as text, followed by `tables` with -v. Other formats are `tables`.
std::string output_text(const Session& session, TableFormat format, const std::string& brief,
                        const std::string& tables);

/// Each function writes an output if its flag is given.
void write_plots(Session& session, const EvalInputs& inputs, const Evaluated& evaluated,
                 const std::string& summary);
void write_map(Session& session, const EvalInputs& inputs, const Evaluated& evaluated);
void write_questions(Session& session, const EvalInputs& inputs, const Evaluated& evaluated);
void write_trajectory(const Session& session, const EvalInputs& inputs, const Evaluated& evaluated,
                      std::optional<double> frames_per_second);
/// Pairs of the matrix, or of the result if it is null. Returns their number.
size_t write_pairs(const Session& session, const EvalInputs& inputs, const ScoreMatrix* matrix,
                   const ScoreLayout& layout, const Result* result);

/// The subcommands, except matrix.
void add_loops(Program& program);
void add_check(Program& program);
void add_convert(Program& program);
void add_compare(Program& program);

}  // namespace vpr
