// Text files: locations for errors, strict numbers, the cells of a line, and CSV rows by column.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/csv.h"
#include "base/mapped_file.h"

namespace vpr {

/// A file and a line or row of it, for errors.
struct FileLocation {
  std::string file;
  std::string_view unit = {};  ///< "line" or "row"; empty: the file as a whole
  size_t number = 0;

  void at(std::string_view new_unit, size_t new_number) {
    unit = new_unit;
    number = new_number;
  }
  /// "poses.csv, line 3".
  std::string text() const;
  /// Throws Error(data): "poses.csv, line 3: WHAT".
  [[noreturn]] void fail(std::string_view what) const;
};

/// The frame that `text` names: digits, maybe after a minus. Nothing if it is no whole number.
struct FrameText {
  bool in_range = false;  ///< neither negative nor too large for 64 bits
  size_t value = 0;
};
std::optional<FrameText> parse_frame(std::string_view text);

/// A finite number with a decimal point, for every locale; a leading + is allowed. Nothing
/// otherwise.
std::optional<double> parse_real(std::string_view text);

/// The cells of a line, divided by commas, blanks around them left out, or by blanks where the line
/// has no comma.
std::vector<std::string_view> cells_of(std::string_view line);

/// The names of the columns of a CSV by its first line, without quotes.
std::vector<std::string> header_names(std::string_view line);

/// Columns may stand in any order; those that nobody asks for are not looked at.
class NamedRows {
 public:
  /// `name`: the file in errors. Throws Error(input) if the file can't be read, Error(data) if it
  /// is no CSV or its header lacks one of the columns in `needed`.
  NamedRows(const std::filesystem::path& path, const std::string& name,
            const std::vector<std::string>& needed);

  /// Rows below the header.
  size_t size() const { return rows_.size() - 1; }
  /// Makes `row` the present one. Throws Error(data) if it has not as many fields as the header.
  void go_to(size_t row);
  bool has(std::string_view column) const;
  /// The names of the columns.
  const std::vector<std::string>& header() const { return rows_[0].fields; }
  /// The present row.
  const FileLocation& location() const { return location_; }
  /// Where the present row starts in the file, counted from 1.
  size_t line() const { return row_->line; }
  /// A field of the present row; empty without such a column.
  const std::string& text(std::string_view column) const;
  /// A finite number. Throws Error(data), naming the line, for anything else.
  double real(std::string_view column) const;
  /// Throws Error(data), naming the present line.
  [[noreturn]] void fail(std::string_view what) const { location_.fail(what); }

 private:
  MappedFile file_;
  FileLocation location_;
  std::vector<CsvRow> rows_;
  const CsvRow* row_ = nullptr;
};

}  // namespace vpr
