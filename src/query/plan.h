// A query by a sequence method, resolved before any distance is computed.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "database/sequence_database.h"
#include "match/match.h"
#include "query/prepare.h"
#include "query/result.h"
#include "query/scores.h"
#include "query/witness.h"

namespace vpr {

/// Recognizes all pairs of windows whose score is below the limit of their training sequence;
/// without limits, there are only best matches.
struct ByThreshold {};

/// Recognizes best matches with the margin of their training sequence.
struct ByMargin {};

/// Recognizes the matches of paths with this margin, in units of the filter's values.
struct ByPath {
  uint32_t least_margin = 0;
  std::optional<WitnessStage> witness = {};  ///< before the first frame
};

using QueryDecision = std::variant<ByThreshold, ByMargin, ByPath>;

/// The frames to compare, the stages of their scores and windows, and the decision of a query.
/// Points into its database and its query.
struct QueryPlan {
  Result result;  ///< without matches: frames, thresholds and margins, and the settings to record
  DescribedFrames query;
  std::vector<DescribedFrames> train;  ///< all sequences, also those that are not searched
  ScoreStages scores;
  MatchSettings match;                            ///< the window stage, and its resources
  std::optional<ExclusionZones> exclusion_zones;  ///< nullopt: no margins
  QueryDecision decision;
  /// For keyframes: the mean distance of training frames, nullopt if unknown.
  std::optional<double> typical_distance;
  FeatureLookup features_of = {};  ///< of the query, with a witness
};

/// Throws Error(data) for descriptors of different kinds or lengths.
void check_descriptors(const DescriptorStore& trained, const DescriptorStore& queried);

/// Plans a query of a database that is prepared for its settings. For a loop query, the database is
/// own_database() of the query, and `times_ns` has the non-decreasing times of its frames for a gap
/// in seconds. Throws Error(usage) for a query or training sequences that are all shorter than a
/// window, Error(data) for descriptors of different kinds. Database and query must outlive the
/// plan.
QueryPlan plan_query(const PreparedDatabase& database, const DescriptorSet& query,
                     const std::string& query_name, const SequenceQuerySettings& settings,
                     const QueryResources& resources, const Monitor& monitor,
                     std::span<const int64_t> times_ns = {});

/// The same plan with the threshold or margin of `settings`, which may differ in nothing else.
QueryPlan with_limit(const QueryPlan& plan, const PreparedDatabase& database,
                     const SequenceQuerySettings& settings, const Monitor& monitor);

/// Plans one window of a query whose frames are not known yet and are described like the database.
QueryPlan plan_window(const PreparedDatabase& database, const std::string& query_name,
                      const SequenceQuerySettings& settings, const QueryResources& resources,
                      const Monitor& monitor);

/// Whether thresholds are relative to the largest distance of each sequence.
bool needs_maxima(const QueryPlan& plan);

/// Sets the limits of these thresholds; `maxima`: the largest distances, by sequence.
void set_relative_limits(QueryPlan& plan, const std::vector<uint32_t>& maxima);

}  // namespace vpr
