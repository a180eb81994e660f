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

/// Empty lines are left out; a byte order mark, and lines in front of the first row that begin with
/// #, are skipped. `where` names the file in errors.
/// Throws Error(data) for a quote that does not end or stands inside an unquoted field.
std::vector<CsvRow> parse_csv(std::string_view text, const std::string& where);

/// A field as CSV: quoted where it has to be.
std::string csv_field(const std::string& text);

}  // namespace vpr
