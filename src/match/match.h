// The driver of matching: passes a query through a window stage and its rows to sinks.
#pragma once

#include <span>
#include <string_view>

#include "match/rows.h"

namespace vpr {

/// An entry of the table of window stages (used by help texts, --method and the contract tests).
/// All stages without paths yield the same cells.
struct SequenceMethod {
  std::string_view name;
  std::string_view summary;
  bool has_scores;  ///< also supports distances in order, such as z-scores
  bool has_rates;   ///< also supports windows of several rates
  /// supports only distances in order; windows have one frame, and cells are the filter's values
  bool has_paths;
  bool has_strips;  ///< can process the whole query at once (strips.h)
  WindowStage (*stage)(const FrameDistances&, std::span<const size_t> window_lengths,
                       const MatchSettings&);
};

/// All methods, in the order of the help text.
std::span<const SequenceMethod> sequence_methods();

/// The method with this name. Throws Error(usage), which lists the names, for an unknown name.
const SequenceMethod& find_sequence_method(std::string_view name);

/// Whether the method with this name has paths; false for an unknown name.
bool has_paths(std::string_view method);

/// Passes a row to all sinks.
void hand_on(const Sinks& sinks, std::span<const ScoreRow> row);

/// Windows of one length, and the sinks of their rows.
struct Pass {
  size_t window_length = 0;
  Sinks sinks;
};

/// The stage of settings.method for windows of these lengths; settings.window_length is not used.
/// Throws Error(usage) if its memory exceeds the limit.
WindowStage window_stage(const FrameDistances& distances, std::span<const size_t> window_lengths,
                         const MatchSettings& settings);

/// Computes the rows of all passes, with the distances of each frame computed once. There are no
/// rows if a sequence is shorter than a window. Throws as window_stage does.
void match(const FrameDistances& distances, const MatchSettings& settings,
           std::span<const Pass> passes, const Monitor& monitor);

/// Computes the rows of windows of settings.window_length.
void match(const FrameDistances& distances, const MatchSettings& settings, const Sinks& sinks,
           const Monitor& monitor);

}  // namespace vpr
