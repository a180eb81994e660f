// How each matcher is checked and timed on one database and query.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "bench/bench_result.h"
#include "matching/rows.h"

namespace vpr {

/// One database and one query, as codes and as distances.
struct MatchingCase {
  std::span<const LdbCode> train_codes;  ///< none of other descriptors
  std::vector<LdbCode> query_codes;
  MatchSettings settings;
  FrameDistances distances;

  MatchingCase(const std::vector<LdbCode>& train_frames, std::vector<LdbCode> query_frames,
               const MatchSettings& match);
  /// Of descriptors of any kind, which must outlive it.
  MatchingCase(const DescriptorRows& train, const DescriptorRows& query,
               const MatchSettings& match);
  MatchingCase(const MatchingCase&) = delete;
  size_t rows() const { return distances.query_frames - settings.window_length + 1; }
};

/// A row of the table of what is timed.
struct MatchingTimer {
  std::string_view name;
  std::string_view summary;
  bool needs_codes = false;  ///< compares LDB codes only
  /// Milliseconds per query frame. Adds to values and note what there is to say.
  void (*measure)(const MatchingCase&, const Effort&, const Monitor&, BenchRow&);
};

/// All of them, in the order in which help and reports list them.
std::span<const MatchingTimer> matching_timers();
/// The timer of a name. Throws Error(usage), listing the names, for an unknown one.
const MatchingTimer& find_matching_timer(std::string_view name);

/// Standardized scores need the whole ring.
bool has_room_for_scores(const MatchingCase& example);

/// How many times faster than OpenABLE with the same kernels, where that was timed.
void add_method_speed_ups(BenchResult& result);

/// Recomputes a few hundred random cells of every exact method by the definition. Throws
/// Error(expectation) if one differs.
void check_methods(const MatchingCase& example, const std::vector<std::string>& methods,
                   const Monitor& monitor);

}  // namespace vpr
