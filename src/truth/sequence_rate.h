// The rate of a sequence, and the frames that another rate keeps, of a recording or as they arrive.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "base/monitor.h"
#include "sequence/live_source.h"
#include "sequence/sequence_argument.h"

namespace vpr {

/// What says when the frames of a sequence were taken, beside itself.
struct RateSource {
  std::filesystem::path times = {};         ///< as read_frame_times takes them; empty: none
  std::optional<double> recorded_fps = {};  ///< of a sequence that doesn't say it itself
};

/// The argument with its rate, where something tells it: the times of `source`, else those that its
/// files are named by, or a video, else `recorded_fps`, which counts the frames of the whole
/// recording. Names are times if they are numbers with a decimal point, or of at least ten digits.
/// With `fps`, a rate that check_fps takes, only the frames that Thinner keeps; one that is above
/// the sequence's own is warned of. Throws Error(usage) for an `fps` where nothing tells the times,
/// Error(data) for times that do not rise, or are of another number of frames.
SequenceArgument with_rate(SequenceArgument argument, const RateSource& source,
                           std::optional<double> fps, const Monitor& monitor);

/// Whether the name of an image, without its extension, says when it was taken.
bool is_named_by_time(const std::filesystem::path& file);

/// The times of frames that are taken at an even rate, in nanoseconds.
std::vector<int64_t> even_times(size_t frames, double fps);

/// The frames of `source` that Thinner keeps at `fps`, a rate that check_fps takes. When a frame
/// was taken, the name of its image says (is_named_by_time, in the unit of the first); of other
/// names, they come evenly, `recorded_fps` a second. Each frame is given when the next one is
/// there. Throws Error(usage) for the first frame if neither says it, Error(data) for times that do
/// not rise.
std::unique_ptr<LiveSource> open_thinned_source(std::unique_ptr<LiveSource> source, double fps,
                                                std::optional<double> recorded_fps);

}  // namespace vpr
