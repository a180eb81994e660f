// The driver: takes a query through a window stage, and hands its rows to those who read them.
#pragma once

#include <span>
#include <string_view>

#include "match/rows.h"

namespace vpr {

/// A row of the table of window stages (help texts, --method and the contract tests read it). All
/// but those with paths give the same cells.
struct SequenceMethod {
  std::string_view name;
  std::string_view summary;
  bool has_scores;  ///< also takes distances that come in order, as standardized ones
  bool has_rates;   ///< also takes windows of several rates
  bool has_paths;  ///< takes only these; windows are of one frame, and cells what is believed of it
  bool has_strips;  ///< may take the whole query at once (strips.h)
  WindowStage (*stage)(const FrameDistances&, std::span<const size_t> window_lengths,
                       const MatchSettings&);
};

/// All methods, in the order in which help lists them.
std::span<const SequenceMethod> sequence_methods();

/// The method of a name. Throws Error(usage), listing the names, for an unknown one.
const SequenceMethod& find_sequence_method(std::string_view name);

/// Of a method of that name; false for an unknown one.
bool has_paths(std::string_view method);

/// Gives a row to all who read it.
void hand_on(const Sinks& sinks, std::span<const ScoreRow> row);

/// Windows of one length, and who reads their rows.
struct Pass {
  size_t window_length = 0;
  Sinks sinks;
};

/// The stage of settings.method for windows of these lengths; settings.window_length does not
/// matter. Throws Error(usage) where its memory exceeds the limit.
WindowStage window_stage(const FrameDistances& distances, std::span<const size_t> window_lengths,
                         const MatchSettings& settings);

/// The rows of all passes, with the distances of each frame computed once. Nothing comes where a
/// sequence is shorter than a window. Throws what window_stage throws.
void match(const FrameDistances& distances, const MatchSettings& settings,
           std::span<const Pass> passes, const Monitor& monitor);

/// The rows of windows of settings.window_length.
void match(const FrameDistances& distances, const MatchSettings& settings, const Sinks& sinks,
           const Monitor& monitor);

}  // namespace vpr
