// Frames as they come, thinned to a rate.
#pragma once

#include <memory>
#include <optional>

#include "images/live_source.h"

namespace vpr {

/// The frames of `source` that Thinner keeps at `fps`, a rate that check_fps takes. When a frame
/// was taken, the name of its image says (is_named_by_time, in the unit of the first); of other
/// names, they come evenly, `recorded_fps` a second. Each frame is given when the next one is
/// there. Throws Error(usage) for the first frame if neither says it, Error(data) for times that do
/// not rise.
std::unique_ptr<LiveSource> open_thinned_source(std::unique_ptr<LiveSource> source, double fps,
                                                std::optional<double> recorded_fps);

}  // namespace vpr
