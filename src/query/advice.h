// Advice for a query that recognizes nothing, or everything.
#pragma once

#include <optional>
#include <string>

#include "query/run_query.h"

namespace vpr {

/// The filter with default settings, on the same frames and training sequences as `settings`.
SequenceQuerySettings default_filter(const SequenceQuerySettings& settings);

/// A sentence if more than a fifth of the window pairs of a training sequence are recognitions.
std::optional<std::string> excess_advice(const Result& result);

/// Whether a result deserves advice: windows without a recognition, or a filter that recognizes
/// less than two thirds of the frames, or with default settings less than nine tenths of a query of
/// which at most three quarters are keyframes, because fewer frames might do better.
bool needs_advice(const Result& result);

/// A sentence about a loop query without recognitions, from its settings alone.
std::string no_recognition_advice(const Result& result);

/// A sentence about a query that needs advice: the number of its frames that default_filter
/// recognizes, and the speed of its longest path, or the number of frames that walk in the opposite
/// direction, or with every second or further frame of both sides or of one. `known`: the result
/// with `settings`, if there is one; if these are the default and nothing else helps, the answer is
/// empty. `images`: the query, for the step of its range, and to try the middle of its images, and
/// of the training images, if these are not many; null: unknown. The database has statistics
/// (ensure_statistics).
std::string filter_advice(const SequenceDatabase& database, const DescriptorSet& query,
                          const SequenceQuerySettings& settings, const QueryResources& resources,
                          const Monitor& monitor, const Result* known = nullptr,
                          const SequenceArgument* images = nullptr);

}  // namespace vpr
