// JPEG files that have EXIF tags and no picture, byte by byte.
#pragma once

#include <array>
#include <cstdint>
#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

namespace vpr::test {

/// Degrees, minutes and seconds, each as a quotient.
using ExifAngle = std::array<std::array<uint32_t, 2>, 3>;

/// What an image says; empty texts are left out.
struct ExifFields {
  ExifAngle latitude{};
  ExifAngle longitude{};
  std::string latitude_ref = "N";
  std::string longitude_ref = "E";
  std::string status = {};
  std::string taken = {};
  std::string fraction = {};
  std::string zone = {};
  bool has_place = true;
};

inline std::string little_endian(uint32_t value, size_t bytes) {
  std::string text;
  for (size_t i = 0; i < bytes; ++i) text += static_cast<char>(value >> (8 * i) & 0xff);
  return text;
}

struct ExifField {
  uint32_t tag = 0;
  uint32_t type = 2;  ///< 2: text, 4: 32 bits, 5: quotients
  uint32_t count = 0;
  std::string value;
};

/// A directory of tags that stands at `offset` of the segment, with its values behind it.
inline std::string exif_directory(const std::vector<ExifField>& fields, size_t offset) {
  std::string entries = little_endian(static_cast<uint32_t>(fields.size()), 2);
  std::string values;
  const size_t values_at = offset + 2 + 12 * fields.size() + 4;
  for (const ExifField& field : fields) {
    entries +=
        little_endian(field.tag, 2) + little_endian(field.type, 2) + little_endian(field.count, 4);
    std::string inline_value = field.value;
    if (field.value.size() > 4) {
      inline_value = little_endian(static_cast<uint32_t>(values_at + values.size()), 4);
      values += field.value;
    }
    inline_value.resize(4);
    entries += inline_value;
  }
  return entries + little_endian(0, 4) + values;
}

inline ExifField exif_text(uint32_t tag, const std::string& text) {
  return {tag, 2, static_cast<uint32_t>(text.size() + 1), text + '\0'};
}

inline ExifField exif_angle(uint32_t tag, const ExifAngle& angle) {
  ExifField field{tag, 5, 3, ""};
  for (const auto& quotient : angle)
    for (const uint32_t number : quotient) field.value += little_endian(number, 4);
  return field;
}

inline std::string jpeg_with_exif(const ExifFields& fields) {
  std::vector<ExifField> camera;
  if (!fields.taken.empty()) camera.push_back(exif_text(0x9003, fields.taken));
  if (!fields.zone.empty()) camera.push_back(exif_text(0x9011, fields.zone));
  if (!fields.fraction.empty()) camera.push_back(exif_text(0x9291, fields.fraction));
  std::vector<ExifField> gps;
  if (fields.has_place) {
    if (!fields.latitude_ref.empty()) gps.push_back(exif_text(1, fields.latitude_ref));
    gps.push_back(exif_angle(2, fields.latitude));
    if (!fields.longitude_ref.empty()) gps.push_back(exif_text(3, fields.longitude_ref));
    gps.push_back(exif_angle(4, fields.longitude));
    if (!fields.status.empty()) gps.push_back(exif_text(9, fields.status));
  }
  constexpr size_t kHeader = 8;
  const size_t camera_at = kHeader + 2 + 2 * 12 + 4;
  const std::string camera_bytes = exif_directory(camera, camera_at);
  const size_t gps_at = camera_at + camera_bytes.size();
  const std::string tiff =
      std::string("II*\0\x08\0\0\0", kHeader) +
      exif_directory({{0x8769, 4, 1, little_endian(static_cast<uint32_t>(camera_at), 4)},
                      {0x8825, 4, 1, little_endian(static_cast<uint32_t>(gps_at), 4)}},
                     kHeader) +
      camera_bytes + exif_directory(gps, gps_at);
  const size_t length = 2 + 6 + tiff.size();
  std::string jpeg = "\xff\xd8\xff\xe1";
  jpeg += static_cast<char>(length >> 8);
  jpeg += static_cast<char>(length & 0xff);
  return jpeg + std::string("Exif\0\0", 6) + tiff + "\xff\xd9";
}

}  // namespace vpr::test
