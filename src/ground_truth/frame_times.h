// When the frames of a sequence were taken.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string_view>
#include <vector>

#include "base/monitor.h"
#include "ground_truth/file_location.h"
#include "ground_truth/times.h"
#include "images/sequence.h"

namespace vpr {

/// A time of a file, in nanoseconds. Throws Error(data), naming the line, for what is none.
int64_t read_time(const FileLocation& location, std::string_view text, TimeUnit unit);

/// Throws Error(data): times must rise, and `time` is not after `before`.
[[noreturn]] void refuse_time_order(const FileLocation& location, int64_t before, int64_t time);

/// Nanoseconds, one time a line in the order of the frames: the first column of a CSV (the column
/// `time` where its header has one), or the first word of a line, as KITTI's times.txt and TUM's
/// rgb.txt have it; lines that start with # are skipped. A range behind the path picks frames.
/// Throws Error(input) if it can't be read, Error(data), naming the line, for what is no time and
/// for times that do not rise.
std::vector<int64_t> read_time_list(const std::filesystem::path& path);

/// Nanoseconds, of the names of a sequence's files, without their extensions. Throws as
/// read_frame_times does.
std::vector<int64_t> times_of_names(const Sequence& sequence);

/// Nanoseconds, one a frame: of a list as read_time_list reads it, of the images of a folder by
/// their names, which must be numbers (1305031102.175304.png, 1403636579763555584.png), or of a
/// video since its first frame; a range behind the path picks frames. Throws Error(input) for what
/// can't be read, Error(data), naming the image or line, for what is no time and for times that do
/// not rise.
std::vector<int64_t> read_frame_times(const std::filesystem::path& path, const Monitor& monitor);

}  // namespace vpr
