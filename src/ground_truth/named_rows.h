// A CSV file as rows whose fields are asked for by the names of their columns.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "base/csv.h"
#include "base/mapped_file.h"
#include "ground_truth/file_location.h"

namespace vpr {

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
