// Numbers of any type from a .npy file, as doubles.
#pragma once

#include <cstddef>
#include <string_view>

namespace vpr {

/// How numbers of a type are read.
struct NumberType {
  std::string_view name;  ///< NumPy's: "<f4"
  size_t bytes = 0;       ///< of a number
  bool is_whole = false;
  /// Reads `count` numbers `stride` bytes apart, and writes them `out_stride` doubles apart. Throws
  /// Error(data) for a 64-bit integer beyond 2^53, which a double does not tell from the next.
  void (*read)(const std::byte* from, size_t stride, size_t count, double* out,
               size_t out_stride) = nullptr;
};

/// The row of a little-endian type: float16, float32, float64, bool, or integers of 8 to 64 bits.
/// Null for another.
const NumberType* find_number_type(std::string_view name);

}  // namespace vpr
