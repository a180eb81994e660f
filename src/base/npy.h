// NumPy's .npy files (format 1.0 to 3.0, little-endian), and conversion of numbers of any type to
// double.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "base/mapped_file.h"
#include "base/output.h"

namespace vpr {

/// NumPy's name of an element type: "|u1", "<i4", ...
template <class T>
std::string_view npy_type();
template <>
inline std::string_view npy_type<uint8_t>() {
  return "|u1";
}
template <>
inline std::string_view npy_type<uint16_t>() {
  return "<u2";
}
template <>
inline std::string_view npy_type<int32_t>() {
  return "<i4";
}
template <>
inline std::string_view npy_type<uint32_t>() {
  return "<u4";
}
template <>
inline std::string_view npy_type<uint64_t>() {
  return "<u8";
}
template <>
inline std::string_view npy_type<float>() {
  return "<f4";
}
template <>
inline std::string_view npy_type<double>() {
  return "<f8";
}

/// The header of a .npy file.
struct NpyHeader {
  std::string type;
  std::vector<size_t> shape;
  bool is_column_major = false;  ///< Fortran order: the first index changes fastest
  size_t offset = 0;             ///< of the first value, in bytes
};

/// An upper bound of the length of a header, in bytes.
inline constexpr size_t kMaxNpyHeader = 65536 + 12;

/// `file` may be the beginning of a file (kMaxNpyHeader bytes are enough). Returns nullopt unless
/// it begins as a .npy file does. Does not check that the values fit the shape.
std::optional<NpyHeader> parse_npy_header(std::string_view file);

/// Bytes per value of a little-endian type ("<f4": 4, "|b1": 1); nullopt for other types.
std::optional<size_t> npy_value_size(std::string_view type);

/// The bytes before the values; their number is a multiple of 64.
std::string npy_header(std::string_view type, const std::vector<size_t>& shape);

/// A memory-mapped array. The header is not trusted: the size of the file must fit the shape.
/// Throws Error(input) if the file cannot be read, Error(data) if it is not a supported array.
class NpyArray {
 public:
  NpyArray() = default;
  explicit NpyArray(const std::filesystem::path& path);

  const std::string& type() const { return type_; }
  const std::vector<size_t>& shape() const { return shape_; }
  /// Fortran order: the first index changes fastest.
  bool is_column_major() const { return is_column_major_; }
  /// The whole file with its header, as checksums cover it.
  std::span<const std::byte> file_bytes() const { return file_.bytes(); }

  /// The raw bytes of the values, of any type and order.
  std::span<const std::byte> value_bytes() const { return file_.bytes().subspan(offset_); }
  /// Releases the memory of values; the system reads them from the file again if needed.
  void forget_values(size_t first_byte, size_t size) const {
    file_.forget(offset_ + first_byte, size);
  }

  /// The values. Throws Error(data) if the type or the number of dimensions differs, or if the
  /// order is Fortran's.
  template <class T>
  std::span<const T> values(size_t dimensions) const {
    require(npy_type<T>(), dimensions);
    return {reinterpret_cast<const T*>(file_.bytes().data() + offset_), count_};
  }

 private:
  void require(std::string_view type, size_t dimensions) const;

  std::string name_;
  MappedFile file_;
  std::string type_;
  std::vector<size_t> shape_;
  bool is_column_major_ = false;
  size_t offset_ = 0;
  size_t count_ = 0;
};

/// Writes header and values to an open file; the caller commits.
template <class T>
void write_npy(Output& file, std::span<const T> values, const std::vector<size_t>& shape) {
  file.write(npy_header(npy_type<T>(), shape));
  file.write(std::as_bytes(values));
}

/// How to read numbers of one type.
struct NumberType {
  std::string_view name;  ///< NumPy's name: "<f4"
  size_t bytes = 0;       ///< per number
  bool is_whole = false;
  /// Reads `count` numbers that are `stride` bytes apart, and writes them as doubles that are
  /// `out_stride` values apart. Throws Error(data) for a 64-bit integer beyond 2^53, which double
  /// cannot represent exactly.
  void (*read)(const std::byte* from, size_t stride, size_t count, double* out,
               size_t out_stride) = nullptr;
};

/// The entry of a little-endian type: float16, float32, float64, bool, or integers of 8 to 64 bits.
/// Null for other types.
const NumberType* find_number_type(std::string_view name);

}  // namespace vpr
