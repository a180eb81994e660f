// What the command line of vpr-query names.
#pragma once

#include <map>
#include <optional>
#include <string>

#include "common/command.h"
#include "common/ground_truth_flags.h"
#include "ground_truth/dataset.h"
#include "recognition/query_settings.h"
#include "report/result_file.h"

namespace vpr {

struct QueryInputs {
  std::string database;
  std::optional<std::string> query;
  std::string query_npy;  ///< its descriptors instead
  bool follow = false;    ///< frames as they come
  std::string dataset;
  std::string warp;  ///< how the query is replayed; empty: as it is
  std::string ground_truth;
  GroundTruthFlags flags;  ///< of the ground truth
  std::string matrix;
  size_t memory_limit = kDefaultMemoryLimit;
  uint64_t verify_cells = 0;
  std::string query_bow;   ///< FAB-MAP: OpenFABMAP's BOW matrix instead of frames
  std::string posteriors;  ///< FAB-MAP: where to write them
  std::optional<uint64_t> explained_frame;
  std::vector<std::string> train_images;  ///< [GROUP=]SEQUENCE
};

struct QuerySource {
  NamedSequence sequence;
  std::optional<GroundTruthArgument> ground_truth;
};

/// The query of --query or --dataset. Throws Error(usage) if there is none.
QuerySource find_query(const QueryInputs& inputs);

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
                        const SequenceQuerySettings& settings);

/// The same, as frames come: a line for each.
void follow_query(Session& session, const QueryInputs& inputs,
                  const SequenceQuerySettings& settings);

/// A query against a FAB-MAP database.
void run_fabmap_query(Session& session, const QueryInputs& inputs,
                      const FabmapQuerySettings& settings);

}  // namespace vpr
