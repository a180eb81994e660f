// Trials of different settings on queries with ground truth, the setting to use, and their report
// (vpr.tuning/5).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/json_fwd.h"
#include "evaluate/evaluation.h"
#include "fabmap/place_query.h"
#include "present/table.h"
#include "query/run_info.h"
#include "tune/sweep.h"

namespace vpr {

/// One setting on all queries.
struct Trial {
  std::string name;  ///< for tables: "z-score windows, c_l 40"
  QuerySettings settings;
  bool is_tuned = false;            ///< its threshold is chosen by the ground truth
  std::vector<FrameCounts> counts;  ///< by query
  double seconds = 0;               ///< matching and decision, without the description of frames

  /// Counts of all queries; the first recognition is the latest one, unset if a query has none.
  FrameCounts total() const;
};

/// The trials of all settings, and the choice.
struct Trials {
  std::vector<Sequence> queries;
  std::vector<Trial> all;  ///< the simplest and most general rule first
  uint64_t max_incorrect = 0;
  /// best_counts() of the totals of trials that are not tuned, or else of tuned ones, whose counts
  /// are too high; nullopt without a correct frame, or if all trials with one have more incorrect
  /// ones.
  std::optional<size_t> chosen;
};

/// Tries a setting on all queries.
Trial try_setting(const SequenceDatabase& database, const std::vector<LabeledQuery>& queries,
                  const SequenceQuerySettings& settings, const QueryResources& resources,
                  const Monitor& monitor);

/// Tries the filter, z-score windows by margin, and FastABLE's raw distances by t_r, each at
/// its best cell of a small grid (best_counts). Windows are omitted if no c_l of the grid fits, or,
/// with a warning, if their recognitions exceed the memory. `base`: skip_unreadable and the
/// training sequences to search. The database has statistics (ensure_statistics). Throws what
/// plan_query and sweep_sequences throw.
Trials try_sequences(const SequenceDatabase& database, const std::vector<LabeledQuery>& queries,
                     const SequenceQuerySettings& base, uint64_t max_incorrect,
                     const QueryResources& resources, const Monitor& monitor);

/// Tries FAB-MAP at its best cell of a small grid of c_w and t_p. Throws what sweep_fabmap throws.
Trial try_fabmap(const FabmapDatabase& database, const std::vector<LabeledWords>& queries,
                 const FabmapQuerySettings& base, uint64_t max_incorrect, uint64_t seed,
                 const Monitor& monitor);

/// Sets the choice.
void choose(Trials& trials);

/// Those of `lengths` with a window in every query and in a training sequence.
std::vector<uint64_t> fitting_lengths(std::vector<uint64_t> lengths,
                                      const SequenceDatabase& database,
                                      const std::vector<const DescriptorSet*>& queries);

/// "settings": those of the choice, a configuration for vpr-query --config, or null.
Json trials_json(const Trials& trials, const RunInfo& run, double seconds);
/// Its schema, for docs/schemas.
Json trials_schema();

/// A row per setting, or per setting and query: frames recognized correctly and incorrectly, the
/// first correctly recognized frame, and the time per frame.
Table trials_table(const Trials& trials, bool by_query);

/// The choice and the number of frames that it rests on, or the reason why there is none. `advice`:
/// filter_advice of a query without a recognized frame; empty if frames are recognized. Ends with a
/// line feed.
std::string choice_text(const Trials& trials, const std::string& advice);

}  // namespace vpr
