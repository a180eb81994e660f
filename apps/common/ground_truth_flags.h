// The flags that say how a ground truth is read, for every program that takes one.
#pragma once

#include <optional>
#include <string>

#include "command.h"
#include "store/archive.h"
#include "truth/dataset.h"

namespace vpr {

/// What the help calls the flags.
inline constexpr const char* kGroundTruthGroup = "Ground truth";

/// Beside --ground-truth.
struct GroundTruthFlags {
  std::optional<int> tolerance_frames;  ///< none: the data set's, or 0
  std::string format;
  GroundTruthOptions options;
};

/// For the help of --ground-truth.
std::string ground_truth_help();

/// Adds the flags, in a group of their own in the help. `format_flag`: what --ground-truth-format
/// is called.
void add_ground_truth_flags(const Command& command, GroundTruthFlags& flags,
                            const std::string& format_flag = "--ground-truth-format");

/// Whether any flag is given.
bool any_given(const GroundTruthFlags& flags);

/// What a data set says of a query, with what the flags, which win, say: matches of frames, or of
/// places. None where it says nothing.
std::optional<GroundTruthArgument> ground_truth_of(const DatasetQuery& query, DatabaseFamily family,
                                                   const GroundTruthFlags& flags);

/// The ground truth that --ground-truth names as `text`, as the flags say.
GroundTruthArgument ground_truth_argument(const std::string& text, const GroundTruthFlags& flags);

}  // namespace vpr
