// Frame descriptors of any kind as rows of bytes, the way they are stored and compared; and the
// visual words of a frame.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "describe/ldb.h"

namespace vpr {

/// Word ids, rising, each once: what a frame or view shows.
using WordSet = std::vector<uint32_t>;

/// What a descriptor is made of, and so what it is compared by: bits, signed whole numbers of 8 or
/// of 16 bits (vectors, of which only directions count), coordinates of 16 bits (points, in one
/// unit for a whole database), grey levels of 8 bits (pictures), or nothing but a frame's number,
/// where distances are given.
enum class ElementType {
  bits,
  whole_numbers,
  wide_numbers,
  coordinates,
  grey_levels,
  frame_numbers
};

/// The longest descriptors that can be compared: distances of bits fit 16 bits, scalar products of
/// numbers 32.
inline constexpr size_t kMostBits = 65472;
inline constexpr size_t kMostNumbers = 131071;

/// The longest descriptor of an element type.
constexpr size_t most_elements(ElementType element) {
  return element == ElementType::bits ? kMostBits : kMostNumbers;
}

/// The elements of which every descriptor of a kind consists: their type and their number.
struct DescriptorShape {
  ElementType element = ElementType::bits;
  size_t length = kLdbBits;  ///< bits or whole numbers; at least 1

  bool operator==(const DescriptorShape&) const = default;

  /// Bytes of a row. Bit b is in byte b / 8, least significant first, and bits are padded with
  /// zeros to whole words of 64; a whole number or a grey level is a byte, a wide number or a
  /// coordinate two, a frame's number four, the lower first.
  constexpr size_t row_bytes() const {
    switch (element) {
      case ElementType::bits:
        return (length + 63) / 64 * 8;
      case ElementType::whole_numbers:
      case ElementType::grey_levels:
        return length;
      case ElementType::frame_numbers:
        return 4 * length;
      case ElementType::wide_numbers:
      case ElementType::coordinates:
        break;
    }
    return 2 * length;
  }
};

/// What its elements are called: "bits", "numbers", "pixels".
constexpr std::string_view element_words(const DescriptorShape& shape) {
  if (shape.element == ElementType::bits) return "bits";
  return shape.element == ElementType::grey_levels ? "pixels" : "numbers";
}

/// The shape of LDB codes.
inline constexpr DescriptorShape kLdbShape = {ElementType::bits, kLdbBits};
static_assert(kLdbShape.row_bytes() == kLdbBytes && sizeof(LdbCode) == kLdbBytes);

/// The descriptor of one frame: row_bytes() bytes.
using DescriptorRow = std::span<const uint8_t>;

/// The descriptors of frames in a row, one after the other. The bytes are somebody else's.
struct DescriptorRows {
  DescriptorShape shape = kLdbShape;
  std::span<const uint8_t> bytes;  ///< size() * shape.row_bytes()

  DescriptorRows() = default;
  DescriptorRows(const DescriptorShape& of, std::span<const uint8_t> all) : shape(of), bytes(all) {}
  /// LDB codes are rows of bits.
  DescriptorRows(std::span<const LdbCode> codes)
      : bytes(reinterpret_cast<const uint8_t*>(codes.data()), codes.size_bytes()) {}
  DescriptorRows(const std::vector<LdbCode>& codes) : DescriptorRows(std::span(codes)) {}

  size_t size() const { return bytes.empty() ? 0 : bytes.size() / shape.row_bytes(); }
  bool empty() const { return bytes.empty(); }
  DescriptorRow operator[](size_t frame) const {
    return bytes.subspan(frame * shape.row_bytes(), shape.row_bytes());
  }
  DescriptorRows subspan(size_t first, size_t count) const {
    return {shape, bytes.subspan(first * shape.row_bytes(), count * shape.row_bytes())};
  }
  DescriptorRows first(size_t count) const { return subspan(0, count); }
};

class GivenDistances;

/// The frames of one sequence as matchers take them: their descriptors, and which of them could not
/// be read. All are somebody else's.
struct DescriptorSpan {
  DescriptorRows rows;
  std::span<const size_t> unreadable;     ///< rising
  const GivenDistances* given = nullptr;  ///< of a query: its distances, which are known already
  std::span<const WordSet> words = {};    ///< that each frame shows, where FAB-MAP is asked, too
};

}  // namespace vpr
