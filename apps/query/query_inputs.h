// What the command line of vpr-query names.
#pragma once

#include <map>
#include <optional>
#include <string>

#include "common/command.h"
#include "common/ground_truth_flags.h"
#include "common/score_flags.h"
#include "common/selection_flags.h"
#include "decide/choices.h"
#include "present/result_file.h"
#include "run/train.h"
#include "truth/dataset.h"

namespace vpr {

/// A matrix of scores of any program, instead of a database and a query.
struct QueryScores {
  ScoreFlags matrix;
  std::vector<std::string> train_sequences;  ///< NAME=FIRST:LAST
};

/// What a walk against its own past needs besides settings.
struct QueryLoop {
  std::string times;  ///< of its frames
  std::string list;   ///< where its loops are written to
};

struct QueryInputs {
  std::string database;  ///< empty: none, with --scores or --loop
  std::optional<std::string> query;
  std::string query_npy;  ///< its descriptors instead
  bool follow = false;    ///< frames as they come
  QueryScores scores;
  QueryLoop loop;
  std::string dataset;
  SelectionFlags selection;
  std::string ground_truth;
  GroundTruthFlags flags;  ///< of the ground truth
  std::string matrix;
  size_t memory_limit = kDefaultMemoryLimit;
  uint64_t verify_cells = 0;
  std::string fuse;        ///< FAB-MAP's database of the same training sequences
  std::string query_bow;   ///< FAB-MAP: OpenFABMAP's BOW matrix instead of frames
  std::string posteriors;  ///< FAB-MAP: where to write them
  std::optional<uint64_t> explained_frame;
  std::vector<std::string> train_images;  ///< [GROUP=]SEQUENCE
};

struct QuerySource {
  NamedSequence sequence;
  std::optional<GroundTruthArgument> ground_truth;
};

/// The query of --query or --dataset, with its rate, and thinned to --fps; not so a folder or
/// camera that is followed, whose frames are not known. Throws Error(usage) if there is none, and
/// what `rated` throws.
QuerySource find_query(const QueryInputs& inputs, const Session& session);

/// Whether any flag of the ground truth is given, but for --query-times where --fps needs it.
bool asks_for_truth(const QueryInputs& inputs);

/// The query of --scores: its name, and the ground truth of --ground-truth.
QuerySource find_scored_query(const QueryInputs& inputs);

/// The training sequences that --train-sequence names. Throws Error(usage) for anything but
/// NAME=FIRST:LAST.
std::vector<NamedArgument> scored_sequences(const QueryScores& scores);

/// What a result file says of the run: machine, paths, fingerprints and seconds.
ResultContext context_of(const Session& session, const QueryInputs& inputs,
                         const std::string& query_path,
                         const std::map<std::string, double>& seconds);

/// The result as JSON, written where --output says so.
Json keep_result(const Session& session, const Result& result, const ResultContext& context);

/// The query's name, and how it was replayed.
std::string query_title(const Result& result);

/// A query against a database of sequences.
void run_sequence_query(Session& session, const QueryInputs& inputs,
                        const ResolvedSettings& settings);

/// The same, as frames come: a line for each.
void follow_query(Session& session, const QueryInputs& inputs, const ResolvedSettings& settings);

/// A query against a FAB-MAP database.
void run_fabmap_query(Session& session, const QueryInputs& inputs,
                      const FabmapQuerySettings& settings);

}  // namespace vpr
