#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <set>

#include <fmt/format.h>

#include "recordings/decode.h"

namespace vpr {
namespace {

/// Reads numbers of a file; 0 beyond its end.
struct ByteReader {
  std::string_view file;
  bool is_little = false;

  uint64_t number(uint64_t at, size_t bytes) const {
    uint64_t value = 0;
    if (at > file.size() || bytes > file.size() - at) return 0;
    for (size_t i = 0; i < bytes; ++i) {
      const size_t k = is_little ? bytes - 1 - i : i;
      value = value << 8 | static_cast<uint8_t>(file[at + k]);
    }
    return value;
  }
};

// Calls use(tag, value) for the entries of the first directory; "II*" or "MM*" begins the file.
// Like libtiff, reads values of 8 bytes, and the first of two entries with one tag.
template <class Use>
void for_each_tag(std::string_view file, Use&& use) {
  constexpr std::array<uint64_t, 18> kBytes = {4, 1, 1, 2, 4, 8, 1, 1, 2,
                                               4, 8, 4, 8, 4, 4, 4, 8, 8};
  const ByteReader reader{file, file.starts_with("II")};
  const uint64_t directory = reader.number(4, 4);
  const uint64_t entries = reader.number(directory, 2);
  std::set<uint64_t> tags;
  for (uint64_t i = 0; i < entries; ++i) {
    const uint64_t at = directory + 2 + 12 * i;
    const uint64_t bytes = kBytes[reader.number(at + 2, 2) % kBytes.size()];
    const bool is_inside = reader.number(at + 4, 4) <= 4 / bytes;
    const uint64_t where = is_inside ? at + 8 : reader.number(at + 8, 4);
    const uint64_t tag = reader.number(at, 2);
    if (tags.insert(tag).second) use(tag, reader.number(where, bytes));
  }
}

// Whether a second page follows that is not a smaller copy or a mask of the first one.
bool has_pages(std::string_view file) {
  constexpr uint64_t kSubfileType = 254;
  constexpr uint64_t kCopyOrMask = 1 | 4;
  const ByteReader reader{file, file.starts_with("II")};
  const uint64_t first = reader.number(4, 4);
  const uint64_t second = reader.number(first + 2 + 12 * reader.number(first, 2), 4);
  if (second == 0 || reader.number(second, 2) == 0) return false;
  const uint64_t entry = second + 2;
  const bool has_type = reader.number(entry, 2) == kSubfileType;  // the lowest tag
  return !has_type || (reader.number(entry + 8, 4) & kCopyOrMask) == 0;
}

ImageHeader tiff_header(std::string_view file) {
  constexpr std::array kFormats = {"", "", "signed", "floating-point", "", "complex", "complex"};
  ImageHeader header;
  uint64_t format = 1;
  uint64_t bits = 1;
  uint64_t samples = 1;
  uint64_t photometric = 0;
  uint64_t extra = 0;  // of a channel besides gray or color
  for_each_tag(file, [&](uint64_t tag, uint64_t value) {
    if (tag == 258) bits = value;
    if (tag == 262) photometric = value;
    if (tag == 277) samples = value;
    if (tag == 322) header.tile_width = value;
    if (tag == 323) header.tile_height = value;
    if (tag == 338) extra = value;
    if (tag == 339) format = value;
  });
  if (format < kFormats.size()) header.unread = kFormats[format];
  if (header.unread.empty() && bits > 16) header.unread = fmt::format("{}-bit", bits);
  if (header.unread.empty() && bits > 8 && samples == 1 && photometric == 0)
    header.unread = "inverted (MINISWHITE)";
  if (header.unread.empty() && bits > 8 && samples == 2) header.unread = "transparent gray";
  header.has_alpha = extra == 2;
  header.has_pages = has_pages(file);
  header.kind = fmt::format("TIFF of {} bits and {} channels", bits, samples);
  header.is_16_bit = bits == 16 && header.unread.empty();
  return header;
}

// The orientation in the chunk EXIF, which holds a TIFF file, after "RIFF", a size and "WEBP".
int webp_orientation(std::string_view file) {
  constexpr std::string_view kExifStart("Exif\0\0", 6);
  const ByteReader reader{file, true};
  int orientation = 1;
  for (uint64_t at = 12; at + 8 <= file.size();) {
    const uint64_t size = reader.number(at + 4, 4);
    std::string_view chunk = file.substr(at + 8, size);
    if (file.substr(at, 4) == "EXIF") {
      if (chunk.starts_with(kExifStart)) chunk.remove_prefix(kExifStart.size());
      for_each_tag(chunk, [&](uint64_t tag, uint64_t value) {
        if (tag == 274 && value >= 1 && value <= 8) orientation = static_cast<int>(value);
      });
    }
    at += 8 + size + size % 2;
  }
  return orientation;
}

// The largest value, after "P2", "P3", "P5" or "P6", width and height, separated by blanks and
// comments; 0 if damaged.
uint64_t largest_of_pnm(std::string_view file) {
  size_t at = 2;
  uint64_t value = 0;
  for (int field = 0; field < 3; ++field) {
    while (at < file.size() &&
           (std::isspace(static_cast<uint8_t>(file[at])) != 0 || file[at] == '#'))
      at = file[at] == '#' ? std::min(file.find('\n', at), file.size()) : at + 1;
    const auto [end, error] = std::from_chars(file.data() + at, file.data() + file.size(), value);
    if (error != std::errc{}) return 0;
    at = static_cast<size_t>(end - file.data());
  }
  return value;
}

// Whether a PNG is an animation: its chunk "acTL", before its pixels, counts several frames.
bool is_animated(std::string_view file) {
  const ByteReader reader{file};
  for (uint64_t at = 8; at + 8 <= file.size(); at += 12 + reader.number(at, 4)) {
    const std::string_view type = file.substr(at + 4, 4);
    if (type == "acTL" || type == "IDAT") return type == "acTL" && reader.number(at + 8, 4) > 1;
  }
  return false;
}

}  // namespace

ImageHeader read_image_header(std::string_view file) {
  ImageHeader header;
  const ByteReader reader{file};
  if (file.starts_with("II*") || file.starts_with("MM")) {
    header = tiff_header(file);
  } else if (file.starts_with("\x89PNG")) {
    header.is_16_bit = reader.number(24, 1) == 16;
    header.has_pages = is_animated(file);
  } else if (file.starts_with("P2") || file.starts_with("P3") || file.starts_with("P5") ||
             file.starts_with("P6")) {
    const uint64_t largest = largest_of_pnm(file);
    header.is_16_bit = largest > 255;
    if (largest > 0 && largest < 255 && file[1] >= '5') header.largest = static_cast<int>(largest);
  } else if (file.starts_with("RIFF")) {
    header.orientation = webp_orientation(file);
  }
  return header;
}

}  // namespace vpr
