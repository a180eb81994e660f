// The command line of vpr-query, and its jobs.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/flags.h"
#include "present/result_file.h"
#include "run/query.h"

namespace vpr {

struct QueryOptions {
  std::string database;  ///< empty: none, with --scores or --loop
  std::optional<std::string> query;
  std::string query_npy;  ///< descriptors instead of frames
  std::string query_bow;  ///< OpenFABMAP's BOW matrix instead of frames
  std::string dataset;
  SelectionFlags selection;
  bool follow = false;
  ScoreFlags scores;
  std::vector<std::string> train_sequences;  ///< of the score matrix: NAME=FIRST:LAST
  std::string loop_times;
  std::string loop_list;  ///< output
  std::string ground_truth;
  GroundTruthFlags ground_truth_flags;
  std::string matrix;  ///< output
  std::string fuse;    ///< FAB-MAP database of the same training sequences
  size_t memory_limit = kDefaultMemoryLimit;
  uint64_t verify_cells = 0;
  std::string posteriors;  ///< output
  std::optional<uint64_t> explained_frame;
  std::vector<std::string> train_images;  ///< [GROUP=]SEQUENCE
};

inline constexpr const char* kSequenceGroup = "FastABLE and OpenABLE";
inline constexpr const char* kScoreGroup = "Score matrix";
inline constexpr const char* kFabmapGroup = "FAB-MAP";

/// The database and the query.
void add_inputs(const Command& app, QueryOptions& options);
void add_sequence_flags(const Command& app, QueryOptions& options, SequenceQuerySettings& settings);
void add_loop_flags(const Command& app, QueryOptions& options, SequenceQuerySettings& sequence,
                    FabmapQuerySettings& fabmap);
void add_fabmap_flags(const Command& app, QueryOptions& options, FabmapQuerySettings& settings);

struct QuerySource {
  NamedSequence sequence;
  std::optional<GroundTruthArgument> ground_truth;
};

/// The query of --query, --query-npy or --dataset, with its rate and selection. A folder or camera
/// with --follow is not selected, because its frames are unknown. Throws Error(usage) without a
/// query; also throws as with_rate.
QuerySource find_query(const QueryOptions& options, const Session& session);

/// Whether a ground truth flag is given, except --query-times if it is for --fps.
bool has_ground_truth(const QueryOptions& options);

QueryResources resources_of(const QueryOptions& options, const Session& session);

/// Claims all outputs. Throws Error(usage) for --save-matrix of an unknown type.
void claim_outputs(const QueryOptions& options, const Session& session);

/// The context of a result: the run and its paths, except the query.
ResultContext make_context(const QueryOptions& options, const Session& session);

/// The JSON of the result, written to --output, if any.
Json save_result(const Session& session, const Result& result, const ResultContext& context);

/// Writes the list of --save-loops, if any.
void save_loops(const QueryOptions& options, const Result& result, const Session& session);

/// The name of the query and its selection.
std::string query_title(const Result& result);

/// Rows of the printed table.
inline constexpr size_t kTableRows = 20;

/// Matches sequences with a database, with themselves (--loop) or by a score matrix.
void query_sequences(Session& session, const QueryOptions& options,
                     const ResolvedSettings& settings);

/// Matches each frame as it arrives, and prints one line per frame.
void follow_query(Session& session, const QueryOptions& options, const ResolvedSettings& settings);

/// Matches frames with the places of a FAB-MAP database.
void query_places(Session& session, const QueryOptions& options,
                  const FabmapQuerySettings& settings);

}  // namespace vpr
