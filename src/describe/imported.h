// Descriptors that another program computed, from .npy files: rows of numbers of any type and
// order, as vectors, points, directions or bits.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "base/enum_names.h"
#include "base/monitor.h"
#include "base/npy.h"
#include "describe/descriptor_rows.h"
#include "sequence/frames.h"
#include "sequence/sequence.h"

namespace vpr {

/// The arrays of a sequence of descriptors: one file with a row a frame, or a file a frame. Nothing
/// is read before it is asked for, and no length that a file states is trusted.
class ArrayRows {
 public:
  /// Throws Error(input) for a file that can't be read; Error(data) for one that is no array of
  /// n x d numbers (a file a frame: d, or 1 x d), of an unknown type, or empty; Error(usage) for a
  /// range that it does not have.
  explicit ArrayRows(const Sequence& sequence);

  size_t count() const { return count_; }
  /// Numbers of a row.
  size_t length() const { return length_; }
  /// NumPy's name of their type: "<f4".
  const std::string& type() const { return type_; }
  /// What frames are called: "#12", or the file's name.
  std::string name(size_t row) const;
  /// Where a row is, for errors: "db.npy: row 12", or the file.
  std::string where(size_t row) const;

  /// Rows [first, first + count), one after the other. May be called from several threads at once;
  /// throws as the constructor does, and Error(data) for a file of another length or type.
  void read(size_t first, size_t count, std::span<double> out) const;

 private:
  size_t recorded(size_t row) const;

  Sequence sequence_;
  NpyArray array_;  ///< of a single file
  size_t count_ = 0;
  size_t length_ = 0;
  std::string type_;
};

struct DescriptorSet;

/// What vectors are compared by: their directions, by 1 - cos; where they lie; or where they lie at
/// length 1, which orders them as 1 - cos does and is finer where they are nearly alike.
enum class DescriptorMetric { cosine, l2, chord };
template <>
inline constexpr std::array<std::string_view, 3> kEnumNames<DescriptorMetric> = {"cosine", "l2",
                                                                                 "chord"};

/// The names of what is imported: vectors, in whole numbers of 16 or of 8 bits, and bits.
inline constexpr std::string_view kVectorKind = "vectors";
inline constexpr std::string_view kNarrowVectorKind = "vectors8";
inline constexpr std::string_view kPointKind = "points";  ///< vectors whose lengths count, too
inline constexpr std::string_view kDirectionKind = "directions";  ///< points of length 1
inline constexpr std::string_view kBitKind = "bits";

/// The squared length of no vector of 16-bit numbers is larger: scalar products of two fit 32 bits,
/// whatever the order of their sums.
inline constexpr int64_t kMostWideSquare = int64_t{46340} * 46340;

/// No point is farther from the origin, so that distances of two fit 16 bits.
inline constexpr int kLongestPoint = 32767;

/// Whether all numbers are NaN: a frame that is not there.
bool is_missing_vector(std::span<const double> vector);
/// Throws Error(data), beginning with `where`, for a number that is not finite.
void check_numbers(std::span<const double> vector, const std::string& where);
/// The same, and for zeros only.
void check_vector(std::span<const double> vector, const std::string& where);

/// The vector as whole numbers, the largest of which is 127 or -127: x / max |x| * 127, each
/// rounded to the nearest, a half to the even one. The vector is finite and not zero.
void quantise_numbers(std::span<const double> vector, std::span<int8_t> out);

/// The vector as whole numbers whose squares sum up to kMostWideSquare at most, as large as that
/// and 16 bits allow: with y = x / max |x| and d numbers, y * min(32767, (46340 - sqrt(d) / 2) /
/// |y|).
void quantise_numbers(std::span<const double> vector, std::span<int16_t> out);

/// What 1 is of the coordinates of these sequences. Of points it is so much that vectors of twice
/// the length of the longest one there are at most kLongestPoint long, 1 where all are zero: reads
/// all rows, and throws as import_descriptors does. Of directions, that length 1 is. The
/// kind is one of these two.
double coordinate_unit(std::string_view kind, std::span<const Sequence> sequences,
                       const Monitor& monitor);

/// The rows of a sequence as descriptors of a kind of those above. Vectors are float16, float32 or
/// float64, and only their directions count; bits are uint8 (8 bits a number) or bool (a bit a
/// number). Points are vectors in multiples of `unit`, and directions vectors of length 1 in them,
/// each coordinate rounded to the nearest. With Unreadable::skip, a row all of whose numbers are
/// NaN keeps its index and can't be read. Memory: what comes out, and a block of rows for each
/// thread. Throws what ArrayRows does, and Error(data), naming the first such row, for numbers that
/// are not finite, vectors of zeros that have no direction, points that are more than kLongestPoint
/// long, rows that are too long, and arrays of another type.
DescriptorSet import_descriptors(const Sequence& sequence, std::string_view kind,
                                 Unreadable unreadable, const Monitor& monitor, double unit = 0);

}  // namespace vpr
