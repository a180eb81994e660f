// The command lines of vpr-tune: queries with ground truth, and grids of settings.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/flags.h"
#include "evaluate/evaluation.h"

namespace vpr {

/// Lists of values on the command line; empty: the default.
struct GridFlags {
  std::string windows;     ///< c_l or c_w
  std::string thresholds;  ///< t_r or t_p
  std::string margins;     ///< instead of t_r, with --decide margin
};

struct TuneOptions {
  std::string database;
  std::string query;
  std::string ground_truth;
  std::string fabmap;  ///< FAB-MAP database of the same training sequences, to try FAB-MAP
  SelectionSettings selection;
  GroundTruthFlags ground_truth_flags;
  std::vector<std::string> datasets;
  GridFlags grid;
  std::string validate;
  std::string validate_ground_truth;
  std::string save_config;
  std::string plots;
  std::string heat_map;
  size_t memory_limit = kDefaultMemoryLimit;
  TableFormat format = TableFormat::text;
};

/// A query and its ground truth.
struct Source {
  NamedSequence sequence;
  GroundTruthArgument ground_truth;
};

/// DB, --query, --ground-truth and the flags that describe them. Returns the flag of DB.
Flag add_query_flags(const Command& command, TuneOptions& options);

/// The queries that settings are chosen on, by paths or by their names in data sets. Throws
/// Error(usage) without a query or ground truth.
std::vector<Source> find_queries(const TuneOptions& options, DatabaseFamily family,
                                 const Session& session);

/// The query of --validate, if any; warns if it has frames of `queries`.
std::optional<Source> find_validation(const TuneOptions& options, DatabaseFamily family,
                                      const std::vector<Source>& queries, const Session& session);

/// The ground truth of a source, which may name frames of the query and the database; null: a
/// FAB-MAP database, whose frames have no names. The arguments must outlive it.
EvaluationSettings evaluation_of(const Source& source, const SequenceDatabase* database);

/// The command of vpr-query with the settings, or with the file of --save-config, on the query of a
/// data set (by index) or of --query. Lines of at most 80 columns, for a shell.
std::string query_command(const TuneOptions& options, const CommonOptions& common,
                          const QuerySettings& settings, size_t index = 0);

/// Parses "2,5,10", "10:50:10", "1:5" (in steps of 1), or a mixture, without duplicates, as
/// integers from 1 to 1e9. Throws Error(usage), which names the flag.
std::vector<uint64_t> parse_counts(const std::string& text, const std::string& flag);

/// The commands of the program.
void add_fastable(Program& program);
void add_fabmap(Program& program);
void add_threshold(Program& program);

}  // namespace vpr
