// What a camera writes into its JPEG images: where and when.
#pragma once

#include <filesystem>
#include <optional>
#include <string_view>

#include "ground_truth/calendar_time.h"
#include "ground_truth/file_location.h"
#include "ground_truth/geodesy.h"

namespace vpr {

/// Of one image; nothing for what its EXIF does not say.
struct ImageTags {
  std::optional<Geographic> place;    ///< none either where the receiver says that it had no fix
  std::optional<double> heading_deg;  ///< GPSImgDirection, clockwise from north, 0 to 360
  std::optional<CalendarTime> taken;  ///< DateTimeOriginal with its fraction and zone
};

/// The tags of a JPEG's bytes, or of the bytes of its EXIF segment; none of anything else. A
/// position of exactly 0 N 0 E, or of numbers whose divisor is 0, is none: cameras without a fix
/// write it. Throws Error(data), at `image`, for a latitude or longitude beyond the globe, or one
/// that does not say its hemisphere.
ImageTags read_exif(std::string_view bytes, const FileLocation& image);

/// The same of a file. Throws Error(input) if it can't be read.
ImageTags read_image_tags(const std::filesystem::path& image);

/// Whether a file starts as a JPEG does.
bool is_jpeg_file(const std::filesystem::path& image);

}  // namespace vpr
