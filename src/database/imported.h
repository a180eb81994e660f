// Descriptors of other programs, read from .npy files with numbers of any type and order: vectors,
// points, directions or bits.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "base/enum_names.h"
#include "base/json_fwd.h"
#include "base/monitor.h"
#include "base/npy.h"
#include "database/descriptor_rows.h"
#include "recordings/frames.h"
#include "recordings/sequence_source.h"

namespace vpr {

/// The arrays of a sequence of descriptors: one file with one row per frame, or one file per frame.
/// Reads lazily and trusts no length that a file states.
class ArrayRows {
 public:
  /// Throws Error(input) for a file that cannot be read; Error(data) for a file that is not an
  /// array of n x d values (d or 1 x d with one file per frame), has an unknown type, or is empty;
  /// Error(usage) for a range that exceeds the array.
  explicit ArrayRows(const SequenceSource& sequence);

  size_t count() const { return count_; }
  /// Values per row.
  size_t length() const { return length_; }
  /// The array in memory, if its rows are used in place: all of them, in C order.
  std::shared_ptr<const NpyArray> array_in_memory() const;
  /// NumPy's name of their type: "<f4".
  std::string_view type() const { return type_->name; }
  /// The name of a frame: "#12", or the name of the file.
  std::string name(size_t row) const;
  /// The place of a row in errors: "db.npy: row 12", or the file.
  std::string where(size_t row) const;

  /// Reads rows [first, first + count) in order. Thread-safe. Throws as the constructor does, and
  /// Error(data) for a file of another length or type.
  void read(size_t first, size_t count, std::span<double> out) const;

 private:
  size_t recorded(size_t row) const;

  SequenceSource sequence_;
  std::shared_ptr<const NpyArray> array_;  ///< if there is a single one
  size_t count_ = 0;
  size_t length_ = 0;
  const NumberType* type_ = nullptr;
};

/// The number of rows that the argument's range selects from `all` rows of its file. Throws
/// Error(usage) if the range exceeds them.
size_t rows_in_range(const SequenceArgument& argument, size_t all);

struct DescriptorSet;

/// The distance between vectors: 1 - cos; Euclidean; or Euclidean after scaling to length 1, which
/// has the same order as 1 - cos and a finer resolution for nearly equal vectors.
enum class DescriptorMetric { cosine, l2, chord };
template <>
inline constexpr std::array<std::string_view, 3> kEnumNames<DescriptorMetric> = {"cosine", "l2",
                                                                                 "chord"};

/// The names of imported kinds: vectors of 16-bit or 8-bit integers, and bits.
inline constexpr std::string_view kVectorKind = "vectors";
inline constexpr std::string_view kNarrowVectorKind = "vectors8";
inline constexpr std::string_view kPointKind = "points";          ///< vectors with their lengths
inline constexpr std::string_view kDirectionKind = "directions";  ///< points of length 1
inline constexpr std::string_view kBitKind = "bits";

/// The comparison of imported vectors, by the names of flags.
struct ImportSettings {
  DescriptorMetric metric = DescriptorMetric::cosine;
  uint64_t value_bits = 16;  ///< or 8
};
VPR_FIELDS(ImportSettings, (metric), (value_bits))

/// The kind of imported descriptors: bits, or vectors with these settings. Throws Error(usage) for
/// another number of bits, and for settings without effect.
std::string_view imported_kind(bool are_bits, const ImportSettings& settings);

/// The same for the arrays of a sequence: uint8 and bool are bits, with a warning for uint8. Throws
/// also as ArrayRows does.
std::string_view imported_kind(const SequenceSource& sequence, const ImportSettings& settings,
                               const Monitor& monitor);

/// Upper bound of the squared length of a vector of 16-bit integers: scalar products of two vectors
/// fit 32 bits, for any order of summation.
inline constexpr int64_t kMaxSquaredLength = int64_t{46340} * 46340;

/// Upper bound of a point's distance to the origin: distances of two points fit 16 bits.
inline constexpr int kLongestPoint = 32767;

/// Warns that uint8 values are bits, for callers that were not told so.
void warn_of_bytes(const SequenceSource& sequence, const ArrayRows& rows, const Monitor& monitor);

/// Whether all values are NaN, which marks a missing frame.
bool is_missing_vector(std::span<const double> vector);
/// Throws Error(data), beginning with `where`, for a value that is not finite.
void check_numbers(std::span<const double> vector, const std::string& where);
/// As check_numbers, and also for a vector of zeros.
void check_vector(std::span<const double> vector, const std::string& where);

/// The vector as integers with a largest absolute value of 127: x / max |x| * 127, each rounded to
/// nearest, ties to even. The vector is finite and not zero.
void quantize_numbers(std::span<const double> vector, std::span<int8_t> out);

/// The vector as integers, scaled as large as 16 bits and a sum of squares of at most
/// kMaxSquaredLength allow: with y = x / max |x| and d values, y * min(32767, (46340 - sqrt(d) / 2)
/// / |y|).
void quantize_numbers(std::span<const double> vector, std::span<int16_t> out);

/// The value of a stored coordinate of 1. For points, it is chosen such that vectors twice as long
/// as the longest one in the sequences are stored with a length of at most kLongestPoint; 1 if all
/// are zero. This reads all rows and throws as import_descriptors does. For directions, a length of
/// 1 is stored with a length of at most kLongestPoint. The kind is one of these two.
double coordinate_unit(std::string_view kind, std::span<const SequenceSource> sequences,
                       const Monitor& monitor);

/// The rows of a sequence as descriptors of one of the kinds above. Vectors are float16, float32 or
/// float64 and are compared by direction only; bits are uint8 (8 bits per value) or bool (one bit
/// per value). Points are vectors in multiples of `unit`, directions are vectors of length 1 in
/// these multiples; each coordinate is rounded to nearest. With Unreadable::skip, a row of NaN
/// keeps its index and is unreadable. Memory: the result, and one block of rows per thread; uint8
/// rows of an array in memory are not copied if they are multiples of 8 bytes. Throws as ArrayRows
/// does, and Error(data) with the first such row for values that are not finite, vectors of zeros
/// without a direction, points longer than kLongestPoint, rows that are too long, and arrays of
/// another type.
DescriptorSet import_descriptors(const SequenceSource& source, std::string_view kind,
                                 Unreadable unreadable, const Monitor& monitor, double unit = 0);

}  // namespace vpr
