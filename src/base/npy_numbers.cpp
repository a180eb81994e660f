#include "base/npy_numbers.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <limits>
#include <type_traits>
#include <utility>

#include "base/error.h"

namespace vpr {
namespace {

constexpr int64_t kMostExact = int64_t{1} << 53;

/// IEEE 754's 16-bit format.
struct Half {
  uint16_t bits;
};

// The bits of the 32-bit format have the same meaning, but for the width of its two fields.
double number(Half half) {
  const uint32_t sign = uint32_t{half.bits} >> 15 << 31;
  const uint32_t exponent = half.bits >> 10 & 31U;
  const uint32_t fraction = half.bits & 1023U;
  if (exponent == 0) {
    const double size = fraction * 0x1p-24;
    return sign != 0 ? -size : size;
  }
  const uint32_t wide = exponent == 31 ? 255 : exponent + 112;
  return static_cast<double>(std::bit_cast<float>(sign | wide << 23 | fraction << 13));
}

template <class T>
double number(T value) {
  if constexpr (std::is_integral_v<T> && sizeof(T) == 8) {
    if (!std::cmp_less_equal(value, kMostExact) || !std::cmp_greater_equal(value, -kMostExact))
      throw Error(ErrorKind::data,
                  "the file holds integers beyond 2^53, which are not told apart as float64; scale "
                  "them down first");
  }
  return static_cast<double>(value);
}

template <class T>
void read_numbers(const std::byte* from, size_t stride, size_t count, double* out,
                  size_t out_stride) {
  for (size_t i = 0; i < count; ++i) {
    T value;
    std::memcpy(&value, from + i * stride, sizeof(T));
    out[i * out_stride] = number(value);
  }
}

template <class T>
constexpr NumberType row(std::string_view name) {
  return {name, sizeof(T), std::is_integral_v<T>, read_numbers<T>};
}

constexpr std::array<NumberType, 12> kTypes = {
    row<Half>("<f2"),     row<float>("<f4"),   row<double>("<f8"),   row<uint8_t>("|b1"),
    row<uint8_t>("|u1"),  row<int8_t>("|i1"),  row<uint16_t>("<u2"), row<int16_t>("<i2"),
    row<uint32_t>("<u4"), row<int32_t>("<i4"), row<uint64_t>("<u8"), row<int64_t>("<i8")};

}  // namespace

const NumberType* find_number_type(std::string_view name) {
  const auto found = std::find_if(kTypes.begin(), kTypes.end(),
                                  [&](const NumberType& type) { return type.name == name; });
  return found == kTypes.end() ? nullptr : &*found;
}

}  // namespace vpr
