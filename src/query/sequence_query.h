// A query by a sequence method as in vpr-query: with a database, or with its own past.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "database/sequence_database.h"
#include "query/result_file.h"
#include "query/run_query.h"
#include "query/train_sequences.h"

namespace vpr {

/// A database with the query as the only training sequence, without training statistics.
SequenceDatabase own_database(const DescriptorSet& query, const std::string& name);

/// The frames of a query, and the training frames that they are matched with.
struct QueryData {
  std::string name;  ///< of the query
  std::shared_ptr<SequenceDatabase> database = {};
  DescriptorSet query = {};
  std::vector<int64_t> times_ns = {};  ///< for loops with a gap in seconds
};

/// Frames to match, before they are read.
struct QueryInputs {
  NamedArgument query = {};
  /// With what the settings need (open_database); null: the query is matched with its own past.
  std::shared_ptr<SequenceDatabase> database = {};
  /// A file with the times of a loop query with a gap in seconds; empty: the names of its frames.
  std::string frame_times = {};
};

/// Describes the frames like those of the database, or by the settings. Adds paths and fingerprints
/// to the context. Throws as describe_query and describe_frames do, Error(usage) for frames whose
/// names are not times, and Error(data) for another number of times than frames.
QueryData open_query(const QueryInputs& inputs, const SequenceQuerySettings& settings,
                     ResultContext& context, const Monitor& monitor);

/// Sinks of the rows of a planned query, in addition to its result.
using Observers = std::function<Sinks(const QueryPlan& plan)>;

/// Plans and runs the query, adds its times to the context, and warns if it recognizes nearly
/// everything (excess_advice). Throws as plan_query and run_query do.
QueryRun run_query(const QueryData& data, const SequenceQuerySettings& settings,
                   const QueryResources& resources, const Observers& observers,
                   ResultContext& context, const Monitor& monitor);

}  // namespace vpr
