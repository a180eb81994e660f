#include "ground_truth/numpy_number.h"

#include <cmath>
#include <cstring>

namespace vpr {
namespace {

template <class T>
int64_t load_integer(const char* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof(T));
  return static_cast<int64_t>(value);
}

}  // namespace

std::optional<int64_t> whole_number_of(double value) {
  constexpr double kLimit = 9007199254740992.0;  // 2^53: beyond it not every whole number is real
  if (!(std::abs(value) <= kLimit) || value != std::floor(value)) return std::nullopt;
  return static_cast<int64_t>(value);
}

std::optional<int64_t> load_numpy_number(std::string_view type, const char* bytes) {
  if (type == "i8") return load_integer<int64_t>(bytes);
  if (type == "i4") return load_integer<int32_t>(bytes);
  if (type == "i2") return load_integer<int16_t>(bytes);
  if (type == "i1") return load_integer<int8_t>(bytes);
  if (type == "u4") return load_integer<uint32_t>(bytes);
  if (type == "u2") return load_integer<uint16_t>(bytes);
  if (type == "u1" || type == "b1") return load_integer<uint8_t>(bytes);
  if (type == "u8") {
    const int64_t value = load_integer<uint64_t>(bytes);
    return value < 0 ? std::nullopt : std::optional(value);
  }
  if (type == "f8") {
    double value = 0;
    std::memcpy(&value, bytes, sizeof(value));
    return whole_number_of(value);
  }
  return std::nullopt;
}

size_t numpy_number_size(std::string_view type) {
  constexpr std::string_view kTypes = "i8 i4 i2 i1 u8 u4 u2 u1 b1 f8";
  if (type.size() != 2 || kTypes.find(type) == std::string_view::npos) return 0;
  return static_cast<size_t>(type[1] - '0');
}

}  // namespace vpr
