// The command line of vpr-query, and its commands.
#pragma once

#include <optional>
#include <string>

#include "common/flags.h"
#include "query/result_file.h"
#include "query/sequence_query.h"

namespace vpr {

struct QueryOptions {
  std::string database;  ///< empty: none, for loops
  std::optional<std::string> query;
  std::string dataset;
  SelectionSettings selection;
  std::string query_times;  ///< times of the frames, for --fps
  std::string frame_times;  ///< of a loop query with a gap in seconds
  std::string loop_list;    ///< output
  std::string matrix;       ///< output
  size_t memory_limit = kDefaultMemoryLimit;
  std::string posteriors;  ///< output
};

/// The keys of both families of methods, before the family of the database chooses one.
struct AllSettings {
  SequenceKeys sequence;
  FabmapQuerySettings fabmap;
};

template <class Visitor>
void visit_fields(AllSettings& settings, Visitor&& visit) {
  visit_fields(settings.sequence, visit);
  visit_fields(settings.fabmap, visit);
}

/// The flags of each command, without common options.
void add_match_flags(const Command& command, QueryOptions& options, AllSettings& settings);
void add_live_flags(const Command& command, QueryOptions& options, AllSettings& settings);
void add_loop_flags(const Command& command, QueryOptions& options, AllSettings& settings);

/// The query of --query or --dataset, with its rate and selection, except a camera.
/// Throws Error(usage) without a query; also throws as selected.
NamedSequence find_query(const QueryOptions& options, const Session& session);

QueryResources resources_of(const QueryOptions& options, const Session& session);

/// Claims all outputs. Throws Error(usage) for --save-matrix of an unknown type.
void claim_outputs(const QueryOptions& options, const Session& session);

/// The context of a result: the run and its paths, except the query.
ResultContext make_context(const QueryOptions& options, const Session& session);

/// The JSON of the result, written to --output, if any.
Json save_result(const Session& session, const Result& result, const ResultContext& context);

/// Writes the list of --save-loops, if any.
void save_loops(const QueryOptions& options, const Result& result, const Session& session);

/// A few lines about the recognitions of a query: a headline, ranges, the settings in force.
std::string summary_text(const Result& result, const QueryOptions& options, const Session& session);

/// Matches sequences with a database or with themselves.
void query_sequences(Session& session, const QueryOptions& options,
                     const SequenceQuerySettings& settings);

/// Matches each frame as it arrives, and prints one line per frame.
void query_live(Session& session, const QueryOptions& options,
                const SequenceQuerySettings& settings);

/// Matches frames with the places of a FAB-MAP database.
void query_places(Session& session, const QueryOptions& options,
                  const FabmapQuerySettings& settings);

}  // namespace vpr
