// Names of columns in the headers of tables: what other programs call them, and their units.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace vpr {

/// A name in a header.
struct ColumnName {
  std::optional<double> unit = {};  ///< in nanoseconds, meters or degrees; unset: not stated
  size_t rank = 0;                  ///< 0: a usual name; of others, the lowest one counts
};

/// Nullopt if a cell of a header does not name the column, in any case, with or without a unit.
std::optional<ColumnName> parse_column_name(const std::string& cell, std::string_view column);

/// Whether all words are names of columns, as in "# image x y z".
bool are_columns(std::span<const std::string_view> words);

/// Whether a header names all of these columns.
bool has_columns(const std::vector<std::string>& header,
                 const std::vector<std::string_view>& columns);

}  // namespace vpr
