// Tables for people and papers: one table, four ways to write it.
#pragma once

#include <array>
#include <cstdint>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/enum_names.h"

namespace vpr {

/// How a table is written.
enum class TableFormat { text, csv, markdown, latex };
template <>
inline constexpr std::array<std::string_view, 4> kEnumNames<TableFormat> = {"text", "csv",
                                                                            "markdown", "latex"};

/// Cells are texts; a column is right-aligned if all its cells look like numbers.
struct Table {
  std::string title;
  std::vector<std::string> columns;
  std::vector<std::vector<std::string>> rows;  ///< each as long as `columns`
  /// Cells (row, column) that are the best of something: bold, in text with a star, in CSV as all.
  std::set<std::pair<size_t, size_t>> best = {};
};

/// Adds a column to a table of one row.
void add_column(Table& table, std::string_view column, std::string cell);
void add_column(Table& table, std::string_view column, uint64_t count);
/// Adds the columns of another table of one row.
void add_columns(Table& table, const Table& more);

/// The rows of all tables below each other, under every column that any of them has, in the order
/// in which they first occur; cells are empty where a table lacks the column. A first column `key`
/// holds `names`, one a row. The title is the first table's, or none where titles differ.
Table stack_tables(const std::vector<Table>& tables, const std::string& key,
                   const std::vector<std::string>& names);

/// Ends with a line feed. CSV leaves the title out; special characters are escaped in each format,
/// and control characters are shown (printable_line) but in CSV, which is data.
std::string render_table(const Table& table, TableFormat format);

}  // namespace vpr
