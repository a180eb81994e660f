// NumPy's .npy files (format 1.0 to 3.0, little-endian), and conversion of numbers of any type to
// double.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "base/mapped_file.h"

namespace vpr {

/// NumPy's name of an arithmetic type other than bool: "|u1", "<i4", ...
template <class T>
std::string_view npy_type() {
  static constexpr char kName[] = {
      sizeof(T) == 1 ? '|' : '<',
      std::is_floating_point_v<T> ? 'f' : (std::is_signed_v<T> ? 'i' : 'u'), '0' + sizeof(T)};
  return {kName, 3};
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

/// The bytes before the values; their number is a multiple of 64.
std::string npy_header(std::string_view type, const std::vector<size_t>& shape,
                       bool is_column_major = false);

/// A memory-mapped array of a type of find_number_type, or a view of one in memory. The header is
/// not trusted: the size of the file must fit the shape. Throws Error(input) if the file cannot be
/// read, Error(data) if it is not a supported array.
class NpyArray {
 public:
  NpyArray() = default;
  explicit NpyArray(const std::filesystem::path& path);
  /// A view of `values`, which must outlive it and have the size of the header's shape. `name`:
  /// in messages. Throws Error(data) for an unsupported type.
  NpyArray(const std::string& name, NpyHeader header, std::span<const std::byte> values);

  const std::string& type() const { return header_.type; }
  const std::vector<size_t>& shape() const { return header_.shape; }
  bool is_column_major() const { return header_.is_column_major; }
  /// The whole file with its header, as checksums cover it; empty for an array in memory.
  std::span<const std::byte> file_bytes() const { return file_.bytes(); }
  /// The bytes of the file before the values; for an array in memory, as numpy.save writes them.
  std::string header_bytes() const;

  /// The raw bytes of the values, of any type and order.
  std::span<const std::byte> value_bytes() const { return values_; }
  /// Releases the memory of values; the system reads them from the file again if needed.
  void forget_values(size_t first_byte, size_t size) const {
    if (!file_.bytes().empty()) file_.forget(header_.offset + first_byte, size);
  }

  /// The values. Throws Error(data) if the type or the number of dimensions differs, or if the
  /// order is Fortran's.
  template <class T>
  std::span<const T> values(size_t dimensions) const {
    require(npy_type<T>(), dimensions);
    return {reinterpret_cast<const T*>(values_.data()), count_};
  }

 private:
  void require(std::string_view type, size_t dimensions) const;

  std::string name_;
  MappedFile file_;
  NpyHeader header_;
  std::span<const std::byte> values_;  ///< of the file, or of the owner of the view
  size_t count_ = 0;                   ///< of values
};

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

/// The entry of the type in a header. Throws Error(data) for other types, with the way to save the
/// array of `name` right, and without a header.
const NumberType& number_type_of(const std::string& name, const std::optional<NpyHeader>& header);

}  // namespace vpr
