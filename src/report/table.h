// Tables for people and papers: one table, four ways to write it.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "base/enum_names.h"

namespace vpr {

enum class TableFormat { text, csv, markdown, latex };
template <>
inline constexpr std::array<std::string_view, 4> kEnumNames<TableFormat> = {"text", "csv",
                                                                            "markdown", "latex"};

/// Cells are texts; a column is right-aligned if all its cells look like numbers.
struct Table {
  std::string title;
  std::vector<std::string> columns;
  std::vector<std::vector<std::string>> rows;  ///< each as long as `columns`
};

/// Ends with a line feed. CSV leaves the title out; special characters are escaped in each format.
std::string render_table(const Table& table, TableFormat format);

}  // namespace vpr
