// The flags of vpr-eval, and one function per job.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/command.h"
#include "common/flags.h"
#include "evaluate/evaluation.h"
#include "evaluate/expectation.h"
#include "evaluate/report.h"
#include "evaluate/score_matrix.h"
#include "present/chart.h"
#include "present/table.h"
#include "query/result_file.h"

namespace vpr {

inline constexpr const char* kPictureGroup = "Page and plots";
inline constexpr const char* kFileGroup = "Other outputs";
inline constexpr const char* kMoreGroup = "More options";
inline constexpr const char* kNeedsExpected = "needs --expect, the file of expected values";

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
  std::string query_array;  ///< descriptors without SCORES
  std::string train_array;
  std::optional<DescriptorMetric> metric;
  std::optional<double> threshold;
  uint64_t window_length = 1;
  std::string speed;
  std::optional<uint64_t> query_frames;  ///< before --speed
  std::optional<uint64_t> train_frames;  ///< of a list of numbers

  bool is_list() const;
  /// The path of the scores or of the descriptors; empty without any.
  const std::string& source() const { return query_array.empty() ? path : query_array; }
};

/// The flags of vpr-eval RESULT and of vpr-eval matrix, const after parsing. Empty strings: not
/// given.
struct EvalFlags {
  std::vector<std::string> results;
  std::string matrix;              ///< that was saved with the result
  std::vector<std::string> names;  ///< in tables, set by the user
  TruthSource truth;
  EvaluationSettings by;  ///< without the ground truth
  TableFormat format = TableFormat::text;
  std::optional<std::string> query;  ///< a sequence, or the name of a query in the data set
  std::vector<std::string> train;
  ScoreInputs scores;
  std::string expected;
  bool update = false;
  std::string map_with;
  FigureSettings figure;
  std::optional<uint64_t> top_k;
  std::string query_name;  ///< of scores
  std::string data_set;
  std::vector<std::string> outputs;  ///< paths by eval_outputs(); empty: not given

  EvalFlags();
  /// The path of an output by its flag.
  const std::string& output(std::string_view flag) const;
};

/// --plot-size and --plot-limits.
void add_figure_flags(const Command& command, FigureSettings& figure, const std::string& group);

/// A result, or the scores of the flags.
struct EvalRow {
  std::string result = {};  ///< empty: scores
  std::string matrix = {};  ///< that was saved with it; empty: none
  std::string name = {};    ///< in tables
  bool is_named = false;    ///< by the user
  bool needs_truth = true;
};

void add_result_flags(Program& program, const Command& command, EvalFlags& flags);
void add_matrix_flags(Program& program, const Command& command, EvalFlags& flags);

/// Without SCORES, the query and the training sequence of the flags or the data set are the arrays
/// to compare, and --query-images and --train-images their images. Throws Error(usage) if one is
/// missing.
void compare_arrays(EvalFlags& flags);

/// Throws Error(usage) for flags that cannot be combined or lack another one, and for values out of
/// range.
void check_flags(const EvalFlags& flags);

/// Throws Error(data) if `rows` windows do not have the frames that --query-frames or
/// `query_frames` states; if neither is known, if a window is longer than the matrix.
void check_rows(const ScoreInputs& inputs, size_t rows, std::optional<size_t> query_frames);

struct OpenedScores {
  std::shared_ptr<const StoredResult> stored;  ///< null: scores
  std::optional<ScoreMatrix> matrix;  ///< scores, or the matrix that was saved with the result
};

/// Throws Error(usage) without a result or scores, and Error(data) if --matrix was not saved with
/// the result.
OpenedScores open_inputs(const Session& session, const EvalFlags& flags, const EvalRow& row);

/// The data set's query of this name, or else --query; nullopt without both.
std::optional<SequenceArgument> query_argument(const EvalFlags& flags,
                                               const std::optional<std::string>& name);

/// The names of query frames, and of training frames by sequence, from --query and --train or the
/// data set; empty without them. `query` and `searched`: names of the evaluated sequences, by which
/// those of a data set are chosen; `searched` is empty for scores, whose columns are all of them.
std::vector<std::string> query_names(const EvalFlags& flags,
                                     const std::optional<std::string>& query = {});
std::vector<std::vector<std::string>> train_names(const EvalFlags& flags,
                                                  const std::vector<std::string>& searched = {});
/// The names of all training sequences in one list, as the columns of scores are one sequence.
std::vector<std::string> joined(const std::vector<std::vector<std::string>>& names);

/// The number of frames of a sequence; nullopt if it is unknown, as of a video. Images of a list
/// need not exist.
std::optional<size_t> known_frames(const SequenceArgument& argument);

struct Evaluated {
  Evaluation evaluation;
  EvaluationSettings by;
  Report report;
  std::shared_ptr<const StoredResult> stored = {};  ///< null: scores
};

/// Throws as open_inputs does, and Error(usage) without a ground truth if one is needed.
Evaluated evaluate(Session& session, const EvalFlags& flags, const EvalRow& row);

/// The inputs of an output, next to the evaluation.
struct EvalRun {
  Session& session;
  const EvalFlags& flags;
  std::optional<double> recorded_fps;  ///< constant rate of the query's recording
  std::string summary;
  std::vector<CheckedValue> checked;  ///< by --expect
};

/// An output of vpr-eval: its flag, and one of two functions.
struct EvalOutput {
  std::string_view flag;
  std::string_view help;
  const char* group = nullptr;
  bool of_scores = false;         ///< also of vpr-eval matrix
  bool of_several = false;        ///< several results fill one file
  bool needs_truth = true;        ///< if it is an output of scores
  std::string_view answers = {};  ///< to the questions of a page: their flag and file
  std::string_view header = {};   ///< of the file
  /// The missing flag, in words; empty: none. Null: the output needs no other flag.
  std::string_view (*lacks)(const EvalFlags& flags) = nullptr;
  std::string (*text)(const EvalRun& run, const Evaluated& evaluated) = nullptr;  ///< of a file
  void (*draw)(const EvalRun& run, const Evaluated& evaluated,
               const std::filesystem::path& folder) = nullptr;
};

/// All outputs except the report, in the order of the help.
std::span<const EvalOutput> eval_outputs();

/// An output whose flag is given.
struct GivenOutput {
  const EvalOutput* output = nullptr;
  std::string path;
  std::string text = {};  ///< of the file, from all rows so far
};

std::vector<GivenOutput> given_outputs(const EvalFlags& flags);

/// The rate of the query's selected range in frames per second, if the data set states one, and if
/// a video or the names of images do not have times of their own.
std::optional<double> constant_rate(const EvalFlags& flags, const Evaluated& evaluated);

/// Claims the report and these outputs.
void claim_outputs(const Session& session, const std::vector<GivenOutput>& given);

/// Draws folders, and adds to the texts of files.
void make_outputs(const EvalRun& run, const Evaluated& evaluated, std::vector<GivenOutput>& given);
void write_files(const Session& session, const std::vector<GivenOutput>& given);

/// `brief` as text, followed by `tables` with -v. Other formats are `tables`.
std::string output_text(const Session& session, TableFormat format, const std::string& brief,
                        const std::string& tables);

/// A list of pairs, and their number: of the matrix, or of the result if it is null.
struct PairList {
  size_t count = 0;
  std::string text;
};
PairList pair_list(const Session& session, const EvalFlags& flags, const ScoreMatrix* matrix,
                   const ScoreLayout& layout, const Result* result);

/// Schemas for docs/schemas: of configuration files, check and convert.
Json eval_config_schema();
Json check_schema();
Json conversion_schema();

/// The subcommands, except matrix.
void add_loops(Program& program);
void add_check(Program& program);
void add_convert(Program& program);
void add_compare(Program& program);

}  // namespace vpr
