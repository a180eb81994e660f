// Comma-separated values (RFC 4180): quoted fields, \n or \r\n.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace vpr {

/// One row of a CSV file: its fields as text, without quotes.
struct CsvRow {
  size_t line = 0;  ///< one-based, where the row starts
  std::vector<std::string> fields;
};

/// Skips empty lines, a byte order mark, and lines before the first row that begin with #. `where`
/// names the file in errors. Throws Error(data) for an unterminated quote or a quote inside an
/// unquoted field.
std::vector<CsvRow> parse_csv(std::string_view text, const std::string& where);

/// A field as CSV, quoted if necessary.
std::string csv_field(const std::string& text);

}  // namespace vpr
