// Inputs of vpr-eval, and one step per group of flags: scores, lists, outputs and their checks.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/json.h"
#include "common/command.h"
#include "common/ground_truth_flags.h"
#include "common/score_flags.h"
#include "describe/imported.h"
#include "evaluate/expectation.h"
#include "evaluate/loops.h"
#include "evaluate/score_matrix.h"
#include "present/evaluation_report.h"
#include "present/exports.h"
#include "present/result_file.h"
#include "present/table.h"
#include "run/evaluate.h"

namespace vpr {

struct CsvInputs {
  std::string outcomes;  ///< files; empty: not asked for
  std::string recognitions;

  bool any() const { return !outcomes.empty() || !recognitions.empty(); }
};

struct ExpectInputs {
  std::string expected;  ///< a file; empty: nothing is expected
  bool update = false;   ///< the file takes over what is found
  std::string junit;     ///< a file; empty: not asked for

  bool any() const { return update || !expected.empty() || !junit.empty(); }
};

struct PairInputs {
  std::string path;              ///< empty: not asked for
  std::optional<uint64_t> most;  ///< K of --top-k

  bool any() const { return most || !path.empty(); }
};

struct LoopInputs {
  std::string path;   ///< of the list
  std::string times;  ///< of a trajectory without times
  std::string gap;
  LoopFrames frames = LoopFrames::automatic;
};

struct PictureInputs {
  std::string html;
  std::string plots;
  std::optional<std::string> query;  ///< a sequence, or a query's name in the data set
  std::vector<std::string> train;
};

struct ScoreInputs {
  ScoreFlags matrix;
  std::string query_npy;      ///< descriptors that scores are computed of; empty: none
  std::string reference_npy;  ///< of the references
  DescriptorMetric metric = DescriptorMetric::cosine;
  std::string predictions;  ///< lists of what a program found; empty: none
  std::vector<uint64_t> recall_at;
  uint64_t stretch_frames = kRouteStretch;  ///< of the recall achievement rate
  std::optional<double> threshold;
  uint64_t window_length = 1;            ///< frames per row of --scores
  std::string warp;                      ///< how the query was replayed; empty: it was not
  std::optional<uint64_t> query_frames;  ///< of the query, before --warp
  std::string name;                      ///< for tables; empty: the file's, or the method
  std::string poses;                     ///< of the query, for meters

  /// Whether there are scores, read or computed.
  bool any() const { return !source().empty(); }
  /// Where they come from.
  const std::string& source() const {
    if (!matrix.path.empty()) return matrix.path;
    return query_npy.empty() ? predictions : query_npy;
  }
};

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
  std::string map;       ///< a folder; empty: not asked for
  std::string map_with;  ///< a second result
  std::string fixes;     ///< a file of --fixes-tum; empty: not asked for
  LoopInputs loops;

  /// Whether an output is asked for that shows one result under one ground truth.
  bool shows_one() const {
    return !pictures.html.empty() || !pictures.plots.empty() || !map.empty() || !fixes.empty() ||
           pairs.any();
  }
};

/// An evaluation and its report.
struct Evaluated {
  Evaluation evaluation;
  JudgedBy by;
  Report report;
};

/// Rows of one result or several, below one header.
struct CsvRows {
  std::string outcomes = outcomes_csv_header();
  std::string recognitions = recognitions_csv_header();
};

void add_csv_options(const Command& app, CsvInputs& inputs);

/// Claims the outputs. Throws Error(usage) for recognitions where there is no result.
/// Call it before long work.
void claim_csv_outputs(const Session& session, const CsvInputs& inputs, bool has_result);

/// Adds the rows that are asked for.
void add_rows(CsvRows& rows, const CsvInputs& inputs, const Evaluation& evaluation,
              const std::string& name);

void write_csv_rows(const Session& session, const CsvInputs& inputs, const CsvRows& rows);

void add_expect_options(const Command& app, ExpectInputs& inputs);

/// Reads what is expected, and claims what is written; null where nothing is. Throws Error(usage)
/// for --update or --junit without --expect, and Error(input) for a file that can't be read, unless
/// --update makes it. Call it before long work.
Json read_expected(const Session& session, const ExpectInputs& inputs);

/// The values that are expected, compared with the report. Writes what is asked for.
std::vector<CheckedValue> check_expected(const Session& session, const ExpectInputs& inputs,
                                         const Json& expected, const Json& report);

/// "expected.json: all 12 expected values are met."; nothing where nothing is expected.
std::string met_sentence(const ExpectInputs& inputs, const std::vector<CheckedValue>& values);

/// Throws Error(expectation) with a line for each value that is not met, unless it was updated.
void require_met(const ExpectInputs& inputs, const std::vector<CheckedValue>& values);

void add_list_options(const Command& app, EvalInputs& inputs);

/// Throws Error(usage) for flags that do not go together; claims the output. Call it before long
/// work.
void check_lists(const Session& session, const EvalInputs& inputs);

/// Frames of --query or of the data set's query; none where neither is given, or it is not a
/// sequence of images. Throws as open_sequence does.
std::optional<size_t> query_frames(const EvalInputs& inputs);

/// How a ground truth may name frames: as --query and --train do, or the data set, whose query is
/// the one of this name. It is looked for when a name is needed.
void add_names(JudgedBy& by, const EvalInputs& inputs,
               const std::optional<std::string>& query_name);

/// The scores of --predictions. Throws as prediction_scores does.
ScoreMatrix open_predictions(const EvalInputs& inputs);

/// Writes --pairs, if it is asked for: of the matrix, or of a result without one. Returns how many.
size_t write_pairs(const Session& session, const EvalInputs& inputs, const ScoreMatrix* matrix,
                   const ScoreLayout& layout, const Result* result);

/// Whether pairs are all that is asked for: there is no ground truth to judge by.
bool only_lists(const EvalInputs& inputs);

/// Writes them, and says so.
void run_lists(Session& session, const EvalInputs& inputs);

/// Whether any of its flags is given.
bool is_given(const LoopInputs& inputs);

void add_loop_options(const Command& app, LoopInputs& inputs);

/// Judges the list and writes what was asked for. Throws Error(usage) for flags that belong to
/// other evaluations or are missing, and as read_loop_list and read_trajectory do.
void run_loops(Session& session, const EvalInputs& inputs);

void add_map_options(const Command& app, EvalInputs& inputs);

/// Throws Error(usage) for flags that do not go together, and as the checks of outputs do. Call it
/// before long work.
void check_map_inputs(const Session& session, const EvalInputs& inputs);

/// Draws the map, if it is asked for, of the result and that of --map-with. Throws Error(usage) if
/// the data set does not say where the query's frames were taken.
void write_map(Session& session, const EvalInputs& inputs, const Evaluated& evaluated);

void add_picture_options(const Command& app, PictureInputs& inputs);

/// Whether pictures of an evaluation are to be written.
bool wants_pictures(const PictureInputs& inputs);

/// Throws as the checks of outputs do. Call it before long work.
void check_picture_outputs(const Session& session, const PictureInputs& inputs);

/// Writes what was asked for; the page opens with the sentence `summary`. Throws Error(usage) if
/// sequences do not have as many frames as the evaluation.
void write_pictures(Session& session, const EvalInputs& inputs, const Evaluated& evaluated,
                    const std::string& summary);

void add_score_options(const Command& app, ScoreInputs& inputs);

/// What the metrics are, for --help.
std::string metrics_help();

/// Throws Error(usage) for flags that need --scores, or that a result answers already.
void check_score_inputs(const ScoreInputs& inputs, bool has_result);

/// Throws Error(data) if `rows` windows do not have the frames that --query-frames or
/// `query_frames` states, or, where neither is known, if a window is longer than the matrix.
void check_rows(const ScoreInputs& inputs, size_t rows, std::optional<size_t> query_frames);

/// K of recall@K, rising, 1 among them; none where the flag was not given. Throws Error(usage) for
/// a K out of range.
std::vector<size_t> recall_at_of(const ScoreInputs& inputs);

/// Throws Error(usage) for a --stretch out of range.
size_t stretch_of(const ScoreInputs& inputs);

void add_trajectory_options(const Command& app, EvalInputs& inputs);

/// Claims the output. Throws Error(usage) unless the data set or --ground-truth-reference has
/// positions of training frames. Call it before long work.
void claim_trajectory(const Session& session, const EvalInputs& inputs);

/// Positions are of the data set's poses, or of the ground truth's, in any format of trajectories.
/// Times are those of --query-times, where the query is judged by them and is not replayed. Throws
/// Error(usage) if nothing has positions of training frames, and as read_train_poses and
/// read_frame_times do.
void write_trajectory(const Session& session, const EvalInputs& inputs, const Evaluated& evaluated,
                      std::optional<double> frames_per_second);

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

}  // namespace vpr
