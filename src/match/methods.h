// The table of sequence matchers (help texts, --method and the contract tests read it), and
// OpenABLE, which computes every cell by definition.
#pragma once

#include <span>
#include <string_view>

#include "match/rows.h"

namespace vpr {

/// A way to compute the matrix of sequence distances. All but those with paths give the same cells.
struct SequenceMethod {
  std::string_view name;
  std::string_view summary;
  bool has_scores;  ///< also takes distances that come in order, as standardized ones
  bool has_rates;   ///< also takes windows of several rates
  bool has_paths;  ///< takes only these; windows are of one frame, and cells what is believed of it
  void (*match)(const FrameDistances&, const MatchSettings&, const Monitor&, const RowConsumer&);
};

/// All methods, in the order in which help lists them.
std::span<const SequenceMethod> sequence_methods();

/// The method of a name. Throws Error(usage), listing the names, for an unknown one.
const SequenceMethod& find_sequence_method(std::string_view name);

/// Of a method of that name; false for an unknown one.
bool has_paths(std::string_view method);

/// Every cell costs window_length frame distances, which must not come in order. Rows are computed
/// in parallel. Nothing is produced where a sequence is shorter than a window.
void match_openable(const FrameDistances& distances, const MatchSettings& settings,
                    const Monitor& monitor, const RowConsumer& consume);

}  // namespace vpr
