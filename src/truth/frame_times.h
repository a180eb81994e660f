// The times of the frames of a sequence, its frame rate, and the selection of frames for a lower
// rate.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/json_fwd.h"
#include "base/monitor.h"
#include "recordings/sequence_source.h"

namespace vpr {

struct LiveSource;

/// Times in nanoseconds, one per row in the order of the frames: the first cell, as in KITTI's
/// times.txt and TUM's rgb.txt, or the column `time` of a header. A range after the
/// path selects frames. Throws Error(input) if it cannot be read; Error(data), with the line, for
/// invalid times, times that do not increase, a first line that is neither a time nor such a
/// header, two columns without a header of which the first counts frames, and a first line that
/// seems to be pandas' header "0". If the column `image`, the second one without a header, names
/// some of the frames `names`, each frame has the time of the line with its name; Error(data) if
/// one has none or two. `names` is called only for a column `image`; warns if its images are gone.
std::vector<int64_t> read_time_list(const std::filesystem::path& path, const NameReader& names = {},
                                    const Monitor& monitor = {});

/// Times in nanoseconds, one per frame: from a list (read_time_list), from the names of the images
/// of a folder, which must be numbers (1305031102.175304.png, 1403636579763555584.png), or from a
/// video, relative to its first frame. A range after the path selects frames. Throws Error(input)
/// if the path cannot be read; Error(data), with the image or line, for invalid times and times
/// that do not increase. `names`: of the frames, for read_time_list.
std::vector<int64_t> read_frame_times(const std::filesystem::path& path, const NameReader& names,
                                      const Monitor& monitor);

/// Whether the name of an image, without its extension, is a time: a number with a decimal point or
/// at least ten digits.
bool is_named_by_time(const std::filesystem::path& file);

/// Whether a video or the names of images have times of their own.
bool states_times(const SequenceSource& sequence);

/// The number of frames of a sequence other than a video.
size_t count_frames(const SequenceSource& sequence);

/// Times in nanoseconds of frames at a constant rate, from 0 on.
std::vector<int64_t> even_times(size_t frames, double fps);

/// The times of the frames of a sequence: from `file`, if not empty (read_frame_times), from the
/// sequence (states_times), or at the constant rate of the whole recording; nullopt if unknown.
std::optional<std::vector<int64_t>> find_times(const SequenceSource& sequence,
                                               const std::filesystem::path& file,
                                               std::optional<double> recorded_fps,
                                               const Monitor& monitor);

/// The selection of frames of a sequence, by the names of flags.
struct SelectionSettings {
  std::string speed;                   ///< simulated speed; empty: as recorded
  std::optional<double> fps;           ///< rate of the selected frames; nullopt: all frames
  std::optional<double> recorded_fps;  ///< rate of sequences that do not state it
  std::optional<double> fallback_fps;  ///< rate of sequences without any other source; not a flag
};
VPR_FIELDS(SelectionSettings, (speed), (fps), (recorded_fps))

/// Throws Error(usage) for rates out of range.
void check_rates(const SelectionSettings& settings);

/// Returns the argument with its rate, if known: from `times` (a file for read_frame_times; empty:
/// none), from times as file names (is_named_by_time), from a video, or from the stated rates,
/// which refer to all frames of the recording. With settings.fps, selects only the frames that
/// Thinner keeps, all of them above the rate of the sequence. `seed`: of the speed, which is
/// checked when the frames are known. Throws Error(usage) for rates out of range, and for
/// settings.fps without known times; Error(data) if times do not increase or their number differs
/// from the number of frames.
SequenceArgument selected(SequenceArgument argument, const SelectionSettings& settings,
                          const std::filesystem::path& times, uint64_t seed,
                          const Monitor& monitor);

/// The frames of `source` that Thinner keeps at `fps`, which must pass check_fps. The time of a
/// frame is the name of its image (is_named_by_time); for other names, frames have the constant
/// rate `recorded_fps`. Each frame is returned when the next one has arrived. Throws Error(usage)
/// for the first frame if neither is known; Error(data) for times that do not increase.
LiveSource open_resampled_source(LiveSource source, double fps, std::optional<double> recorded_fps);

}  // namespace vpr
