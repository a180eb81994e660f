// Rows of numbers from .npy files, whatever their type and order.
#pragma once

#include <span>
#include <string>

#include "base/npy.h"
#include "images/sequence.h"

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

}  // namespace vpr
