// A query by a sequence method, resolved before any distance is computed.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "decide/choices.h"
#include "decide/exclusion_zones.h"
#include "decide/result.h"
#include "match/match.h"
#include "match/zscores.h"
#include "store/sequence_database.h"

namespace vpr {

/// Resources of a query. Only the method lsh has other results for another seed.
struct QueryResources {
  RowKernels kernels;
  size_t memory_limit = kDefaultMemoryLimit;  ///< bytes for rings and recognitions
  size_t verify_cells = 0;                    ///< number of cells to recompute by definition
  uint64_t seed = 1;                          ///< of lsh, these cells and intervals
};

/// The frames to compare, the stages, and the decision of a query. Points into its database and its
/// query.
struct QueryPlan {
  Sequence query_sequence;
  DescribedFrames query;
  size_t query_windows = 0;
  std::vector<DescribedFrames> train;          ///< all sequences, also those that are not searched
  std::vector<ComparedSequence> sequences;     ///< the same, with thresholds and margins
  MatchSettings match;                         ///< the window stage
  bool is_approximate = false;                 ///< windows are searched by LSH (lsh.h)
  std::shared_ptr<const ScoreBasis> basis;     ///< z-scores from training statistics; or null
  std::vector<uint32_t> past;                  ///< for a loop query (FrameDistances::past)
  std::optional<ZScoreSettings> past_zscores;  ///< z-scores of a loop query
  std::optional<ExclusionZones> exclusion_zones;  ///< nullopt: no margins
  /// For keyframes: the mean distance of training frames, nullopt if unknown.
  std::optional<double> typical_distance;
  std::optional<UsedStatistics> statistics;
  SequenceQuerySettings settings;

  /// The difference between the sums of rows and the scores of a result.
  int64_t score_offset() const { return score_kind(settings.score).offset(match.window_length); }
};

/// Throws Error(usage) if sums over a window may exceed the signed 32-bit integers of files.
void check_sums(const DescriptorStore& descriptors, uint64_t window_length);

/// Adds the initial statistics of z-scores: the components of the training frames, which are not
/// stored, and statistics by default settings if the database has none.
void ensure_statistics(SequenceDatabase& database, const Monitor& monitor);

/// Adds the exclusion radius of each sequence and the pairs of overlapping sequences, unless the
/// database has them.
void ensure_exclusion_zones(SequenceDatabase& database, const RowKernels& kernels,
                            const Monitor& monitor);

/// The basis of z-scores of all sequences of a database; nullopt for a score without statistics,
/// and for a loop query. `statistics`: the statistics of the database, with components, or null.
/// Throws Error(usage) if they are needed and missing.
std::optional<ScoreBasis> score_basis(const TrainStatistics* statistics,
                                      const SequenceQuerySettings& settings);

/// Reads the database at `path` as the settings need it: with statistics for z-scores, and fused
/// with the FAB-MAP database at `fabmap` unless this is empty. Throws what read_sequence_database,
/// read_fabmap_database, check_automatic and fuse_views throw, Error(usage) for fused scores
/// without a FAB-MAP database, and Error(data) for a database of imported descriptors that cannot
/// describe frames as they arrive.
SequenceDatabase open_database(const std::string& path, const ResolvedSettings& settings,
                               const std::string& fabmap, const Monitor& monitor);

/// Warns of the first searched training sequence whose frame rate differs from the query's by more
/// than a tenth: windows then have different durations. Only for windows of several frames at the
/// same rate.
void warn_of_rates(const SequenceDatabase& database, std::optional<double> query_fps,
                   const SequenceQuerySettings& settings, const Monitor& monitor);

/// Describes the frames of a query like frames of the database, and warns (warn_of_rates).
DescriptorSet describe_query(const SequenceArgument& query, const SequenceDatabase& database,
                             const ResolvedSettings& settings, const Monitor& monitor);

/// Computes automatic thresholds that the database lacks. Throws Error(usage) for an unknown
/// sequence name, and for a query or training sequences that are all shorter than a window,
/// Error(data) for descriptors of different kinds. Database and query must outlive the plan.
QueryPlan plan_query(const SequenceDatabase& database, const DescriptorSet& query,
                     const std::string& query_name, const ResolvedSettings& settings,
                     const QueryResources& resources, const Monitor& monitor);

/// The same plan with the threshold or margin of `settings`, which may differ in nothing else.
QueryPlan with_limit(const QueryPlan& plan, const SequenceDatabase& database,
                     const ResolvedSettings& settings, const Monitor& monitor);

/// Plans the query of a sequence against its own past; `database` is own_database() of it.
/// `times_ns`: non-decreasing times of its frames, for a gap in seconds; otherwise empty.
QueryPlan plan_loop(const SequenceDatabase& database, const DescriptorSet& query,
                    const std::string& query_name, const ResolvedSettings& settings,
                    std::span<const int64_t> times_ns, const QueryResources& resources,
                    const Monitor& monitor);

/// Plans one window of a query whose frames are not known yet and are described like the database.
QueryPlan plan_window(const SequenceDatabase& database, const std::string& query_name,
                      const ResolvedSettings& settings, const QueryResources& resources,
                      const Monitor& monitor);

/// The frame distances of the query to all training frames; windows lie in the sequences that are
/// searched.
FrameDistances searched_distances(const QueryPlan& plan);

/// Applies the score stage of a plan. Throws what start_zscores throws.
FrameDistances scored(FrameDistances distances, const QueryPlan& plan, const Monitor& monitor);

/// Whether thresholds are relative to the largest distance of each sequence.
bool needs_maxima(const QueryPlan& plan);

/// Sets the limits of these thresholds; `maxima`: the largest distances, by sequence.
void set_relative_limits(QueryPlan& plan, const std::vector<uint32_t>& maxima);

/// The settings of a scan for recognitions below the limits of a plan.
RecognitionScanSettings scan_settings(const QueryPlan& plan, const QueryResources& resources);

/// A cell of a planned query, as in results.
Match match_of(const Cell& cell, const QueryPlan& plan);

/// The result of a plan without clusters: recognitions, best matches and their margins. The
/// recognitions of a decision by margin are best matches.
Result make_result(const QueryPlan& plan, const RecognitionScanResult& found = {},
                   const std::vector<std::optional<uint32_t>>& margins = {});

}  // namespace vpr
