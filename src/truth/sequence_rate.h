// The frame rate of a sequence, and the selection of frames for a lower rate, recorded or live.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "base/monitor.h"
#include "sequence/live_source.h"
#include "sequence/sequence_source.h"

namespace vpr {

/// Sources of the times of frames other than the sequence itself.
struct RateSource {
  std::filesystem::path times = {};         ///< a file for read_frame_times; empty: none
  std::optional<double> recorded_fps = {};  ///< used if neither times nor sequence state it
};

/// Returns the argument with its rate, if known: from the times of `source`, from times as file
/// names, from a video, or from `recorded_fps`, which refers to all frames of the recording. Names
/// are times if they are numbers with a decimal point or at least ten digits. With `fps`, which
/// must pass check_fps, selects only the frames that Thinner keeps; warns if it is above the rate
/// of the sequence. Throws Error(usage) for `fps` without known times; Error(data) if times do not
/// increase or their number differs from the number of frames.
SequenceArgument with_rate(SequenceArgument argument, const RateSource& source,
                           std::optional<double> fps, const Monitor& monitor);

/// Whether the name of an image, without its extension, is a time.
bool is_named_by_time(const std::filesystem::path& file);

/// The times of frames at a constant rate, in nanoseconds.
std::vector<int64_t> even_times(size_t frames, double fps);

/// The frames of `source` that Thinner keeps at `fps`, which must pass check_fps. The time of a
/// frame is the name of its image (is_named_by_time, in the unit of the first one); for other
/// names, frames have the constant rate `recorded_fps`. Each frame is returned when the next one
/// has arrived. Throws Error(usage) for the first frame if neither is known; Error(data) for times
/// that do not increase.
std::unique_ptr<LiveSource> open_thinned_source(std::unique_ptr<LiveSource> source, double fps,
                                                std::optional<double> recorded_fps);

}  // namespace vpr
