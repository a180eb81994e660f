// The rows of a .npy matrix, one after the other.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/npy.h"
#include "base/zip_file.h"
#include "ground_truth/file_location.h"

namespace vpr {

/// Matrix rows as they stand in the file: of a Fortran-ordered matrix, its columns.
class NpyStream {
 public:
  /// A .npy file of its own. Throws Error(input) or Error(data).
  explicit NpyStream(const std::filesystem::path& path);
  /// A file of an archive, which must live as long.
  NpyStream(ZipFile& archive, size_t index, const std::string& where);

  size_t rows() const { return rows_; }
  size_t cols() const { return cols_; }
  /// The first index of the matrix counts columns here.
  bool is_transposed() const { return header_.is_column_major; }
  /// Writes the next row's values, 0 or 1. Throws Error(data) for another value, or where the file
  /// ends early.
  void next_row(std::span<uint8_t> values);
  /// Throws Error(data) if more bytes follow.
  void require_end();

 private:
  using Fill = std::function<size_t(std::span<std::byte>)>;
  void open();
  void read_bytes(std::span<std::byte> bytes);

  FileLocation location_;
  Fill fill_;
  NpyHeader header_;
  size_t rows_ = 0;
  size_t cols_ = 0;
  std::vector<std::byte> row_;
  size_t row_number_ = 0;
};

}  // namespace vpr
