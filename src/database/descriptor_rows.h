// Frame descriptors of any kind as rows of bytes, as stored and compared.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace vpr {

/// Bits per code of LDB: 3 for every pair of cells of the grids 2x2 to 5x5.
inline constexpr size_t kLdbBits = 1386;

/// A code of LDB: bit b is in byte b / 8, least significant first; the last 22 bits are 0.
inline constexpr size_t kLdbBytes = 176;
using LdbCode = std::array<uint8_t, kLdbBytes>;

/// Values of a HOG vector: 3 x 3 blocks of 2 x 2 cells with 8 directions.
inline constexpr size_t kHogLength = size_t{3} * 3 * 4 * 8;
using HogVector = std::array<int8_t, kHogLength>;

/// A code of LDB and the HOG vector of the same frame.
using LdbHogRow = std::array<uint8_t, kLdbBytes + kHogLength>;

/// The element type of a descriptor, which determines the distance: bits; signed integers of 8 or
/// 16 bits (vectors, compared by direction only); points with 16-bit coordinates (one unit for a
/// whole database); gray levels of 8 bits (images); or a code of LDB followed by a HOG vector.
enum class ElementType { bits, int8, int16, points16, gray_levels, ldb_hog };

/// The longest descriptors that can be compared: distances of bits must fit 16 bits, scalar
/// products of integers 32 bits.
inline constexpr size_t kMaxBits = 65472;
inline constexpr size_t kMaxIntegers = 131071;

constexpr size_t max_elements(ElementType element) {
  return element == ElementType::bits ? kMaxBits : kMaxIntegers;
}

/// The element type and the number of elements of a descriptor.
struct DescriptorShape {
  ElementType element = ElementType::bits;
  size_t length = kLdbBits;  ///< bits or integers; at least 1

  bool operator==(const DescriptorShape&) const = default;

  /// Bytes per row. Bit b is in byte b / 8, least significant first, and rows of bits are padded
  /// with zeros to multiples of 64 bits. Integers of 8 bits and gray levels take one byte, integers
  /// and coordinates of 16 bits two, in little-endian order.
  constexpr size_t row_bytes() const {
    if (element == ElementType::bits) return (length + 63) / 64 * 8;
    return element == ElementType::int16 || element == ElementType::points16 ? 2 * length : length;
  }
};

/// The name of the elements in messages: "bits", "numbers", "pixels".
constexpr std::string_view element_noun(const DescriptorShape& shape) {
  if (shape.element == ElementType::bits) return "bits";
  return shape.element == ElementType::gray_levels ? "pixels" : "numbers";
}

inline constexpr DescriptorShape kLdbShape = {ElementType::bits, kLdbBits};
static_assert(kLdbShape.row_bytes() == sizeof(LdbCode));
inline constexpr DescriptorShape kHogShape = {ElementType::int8, kHogLength};
inline constexpr DescriptorShape kLdbHogShape = {ElementType::ldb_hog,
                                                 std::tuple_size_v<LdbHogRow>};

/// The descriptor of one frame: row_bytes() bytes.
using DescriptorRow = std::span<const uint8_t>;

/// The descriptors of consecutive frames; a view of bytes owned elsewhere.
struct DescriptorRows {
  DescriptorShape shape = kLdbShape;
  std::span<const uint8_t> bytes;         ///< from the first row to the end of the last one
  size_t stride = kLdbShape.row_bytes();  ///< bytes from a row to the next one

  DescriptorRows() = default;
  DescriptorRows(const DescriptorShape& of, std::span<const uint8_t> all)
      : DescriptorRows(of, all, of.row_bytes()) {}
  DescriptorRows(const DescriptorShape& of, std::span<const uint8_t> all, size_t bytes_per_row)
      : shape(of), bytes(all), stride(bytes_per_row) {}
  /// LDB codes are rows of bits.
  DescriptorRows(std::span<const LdbCode> codes)
      : bytes(reinterpret_cast<const uint8_t*>(codes.data()), codes.size_bytes()) {}
  DescriptorRows(const std::vector<LdbCode>& codes) : DescriptorRows(std::span(codes)) {}

  size_t size() const {
    return bytes.empty() ? 0 : (bytes.size() - shape.row_bytes()) / stride + 1;
  }
  bool empty() const { return bytes.empty(); }
  DescriptorRow operator[](size_t frame) const {
    return bytes.subspan(frame * stride, shape.row_bytes());
  }
  DescriptorRows subspan(size_t first, size_t count) const {
    if (count == 0) return {shape, {}, stride};
    return {shape, bytes.subspan(first * stride, (count - 1) * stride + shape.row_bytes()), stride};
  }
  DescriptorRows first(size_t count) const { return subspan(0, count); }
};

/// The LDB codes of rows that also have a HOG vector; other rows are unchanged.
inline DescriptorRows codes_of(const DescriptorRows& rows) {
  return rows.shape.element == ElementType::ldb_hog
             ? DescriptorRows(kLdbShape, rows.bytes, rows.stride)
             : rows;
}

/// The frames of one sequence as input of matchers: their descriptors and the unreadable frames.
/// Owns nothing.
struct DescribedFrames {
  DescriptorRows rows;
  std::span<const size_t> unreadable;  ///< increasing
};

}  // namespace vpr
