#include "ground_truth/exif.h"

#include <algorithm>
#include <array>
#include <limits>
#include <memory>
#include <string>

#include <fmt/format.h>
#include <libexif/exif-data.h>

#include "base/mapped_file.h"

namespace vpr {
namespace {

constexpr std::string_view kJpegStart = "\xff\xd8";
/// Of the directory of GPS tags, whose numbers mean something else in others.
constexpr auto kLatitudeRef = static_cast<ExifTag>(1);
constexpr auto kLatitude = static_cast<ExifTag>(2);
constexpr auto kLongitudeRef = static_cast<ExifTag>(3);
constexpr auto kLongitude = static_cast<ExifTag>(4);
constexpr auto kStatus = static_cast<ExifTag>(9);
constexpr auto kDirection = static_cast<ExifTag>(17);

using Tags = std::unique_ptr<ExifData, decltype(&exif_data_unref)>;

Tags parse(std::string_view bytes) {
  Tags tags(exif_data_new(), exif_data_unref);
  if (!tags) throw std::bad_alloc();
  // As the file has them: nothing is added that the standard wants.
  exif_data_unset_option(tags.get(), EXIF_DATA_OPTION_FOLLOW_SPECIFICATION);
  if (bytes.size() <= std::numeric_limits<unsigned>::max())
    exif_data_load_data(tags.get(), reinterpret_cast<const unsigned char*>(bytes.data()),
                        static_cast<unsigned>(bytes.size()));
  return tags;
}

std::string text_of(const Tags& tags, ExifIfd directory, ExifTag tag) {
  const ExifEntry* entry = exif_content_get_entry(tags->ifd[directory], tag);
  if (entry == nullptr || entry->format != EXIF_FORMAT_ASCII || entry->data == nullptr) return "";
  std::string text(reinterpret_cast<const char*>(entry->data), entry->size);
  text.erase(std::min(text.find('\0'), text.size()));
  while (text.ends_with(' ')) text.pop_back();
  return text;
}

/// The quotients of a tag; nothing unless there are so many, all with a divisor.
template <size_t kCount>
std::optional<std::array<double, kCount>> quotients(const Tags& tags, ExifTag tag) {
  const ExifEntry* entry = exif_content_get_entry(tags->ifd[EXIF_IFD_GPS], tag);
  if (entry == nullptr || entry->format != EXIF_FORMAT_RATIONAL || entry->data == nullptr ||
      entry->components < kCount || entry->size < 8 * kCount)
    return std::nullopt;
  std::array<double, kCount> values{};
  const ExifByteOrder order = exif_data_get_byte_order(tags.get());
  for (size_t i = 0; i < kCount; ++i) {
    const ExifRational quotient = exif_get_rational(entry->data + 8 * i, order);
    if (quotient.denominator == 0) return std::nullopt;
    values[i] = static_cast<double>(quotient.numerator) / static_cast<double>(quotient.denominator);
  }
  return values;
}

/// Which of the two letters of a hemisphere, as a sign: +1 for the first.
int sign_of(const FileLocation& image, const std::string& letter, std::string_view letters) {
  if (letter.size() == 1 && letter[0] == letters[0]) return 1;
  if (letter.size() == 1 && letter[0] == letters[1]) return -1;
  image.fail(fmt::format("its GPS position does not say whether it is {} or {}, but \"{}\"",
                         letters[0], letters[1], letter));
}

std::optional<Geographic> read_place(const Tags& tags, const FileLocation& image) {
  const auto latitude = quotients<3>(tags, kLatitude);
  const auto longitude = quotients<3>(tags, kLongitude);
  if (!latitude || !longitude || text_of(tags, EXIF_IFD_GPS, kStatus) == "V") return std::nullopt;
  const auto degrees = [](const std::array<double, 3>& parts) {
    return parts[0] + parts[1] / 60 + parts[2] / 3600;
  };
  Geographic place{degrees(*latitude), degrees(*longitude)};
  if (place.latitude_deg == 0 && place.longitude_deg == 0) return std::nullopt;
  if (!(place.latitude_deg <= 90) || !(place.longitude_deg <= 180))
    image.fail(fmt::format("its GPS position, {} and {} degrees, is not on the globe",
                           place.latitude_deg, place.longitude_deg));
  place.latitude_deg *= sign_of(image, text_of(tags, EXIF_IFD_GPS, kLatitudeRef), "NS");
  place.longitude_deg *= sign_of(image, text_of(tags, EXIF_IFD_GPS, kLongitudeRef), "EW");
  return place;
}

std::optional<CalendarTime> read_time_taken(const Tags& tags) {
  std::string text = text_of(tags, EXIF_IFD_EXIF, EXIF_TAG_DATE_TIME_ORIGINAL);
  const std::string fraction = text_of(tags, EXIF_IFD_EXIF, EXIF_TAG_SUB_SEC_TIME_ORIGINAL);
  if (!fraction.empty()) text += "." + fraction;
  text += text_of(tags, EXIF_IFD_EXIF, EXIF_TAG_OFFSET_TIME_ORIGINAL);
  return parse_calendar_time(text);
}

}  // namespace

ImageTags read_exif(std::string_view bytes, const FileLocation& image) {
  const Tags tags = parse(bytes);
  ImageTags found;
  found.place = read_place(tags, image);
  if (const auto direction = quotients<1>(tags, kDirection); direction && (*direction)[0] <= 360)
    found.heading_deg = (*direction)[0];
  found.taken = read_time_taken(tags);
  return found;
}

ImageTags read_image_tags(const std::filesystem::path& image) {
  const MappedFile file(image);
  return read_exif(file.text(), {image.string()});
}

bool is_jpeg_file(const std::filesystem::path& image) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(image, error)) return false;
  return MappedFile(image).text().starts_with(kJpegStart);
}

}  // namespace vpr
