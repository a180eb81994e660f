// Tables as text, CSV, Markdown and LaTeX.
#pragma once

#include <array>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "base/enum_names.h"

namespace vpr {

enum class TableFormat { text, csv, markdown, latex };
template <>
inline constexpr std::array<std::string_view, 4> kEnumNames<TableFormat> = {"text", "csv",
                                                                            "markdown", "latex"};

/// The first column of a group, and the number of its columns.
struct ColumnGroup {
  std::string name;
  size_t first = 0;
  size_t count = 0;
};

/// A column is right-aligned if all its cells look like numbers.
struct Table {
  std::string title;
  std::vector<std::string> columns;
  std::vector<std::vector<std::string>> rows;  ///< each as long as `columns`
  /// The best cells (row, column): bold, with a star in text, unmarked in CSV.
  std::set<std::pair<size_t, size_t>> best = {};
  std::string label = {};               ///< in LaTeX, after "tab:"; empty: the title
  std::vector<std::string> notes = {};  ///< below the table; comments in LaTeX, absent in CSV
  /// Names over consecutive columns, such as data sets; those after the last group have none. In
  /// Markdown and CSV, they are part of the names of the columns.
  std::vector<ColumnGroup> groups = {};
};

/// The tables side by side, with the names of their groups: a row for each name in their first
/// columns, in the order of occurrence, with "-" where a table does not have it.
Table joined_tables(const std::vector<std::pair<std::string, Table>>& tables);

void add_row(Table& table, const auto&... cells) {
  table.rows.push_back({fmt::format("{}", cells)...});
}

/// Adds a column to a table of one row.
void add_column(Table& table, std::string_view column, const auto& cell) {
  table.columns.emplace_back(column);
  table.rows.resize(1);
  table.rows[0].push_back(fmt::format("{}", cell));
}

/// The value of a cell, and the interval in brackets after it; empty without one. Where space is
/// scarce, the interval is below its value.
std::pair<std::string, std::string> value_and_interval(const std::string& text);

/// Marks the cells of a column with the best value. `values`: one per row.
void mark_best(Table& table, size_t column, const std::vector<std::optional<double>>& values,
               bool is_low_good);

/// The names, each with its number if it occurs several times, as in "a (2)".
std::vector<std::string> numbered_names(const std::vector<std::string>& names);

/// Ends with a line feed. CSV has no title. Special characters are escaped; control characters are
/// shown (printable_line) except in CSV, which is data.
std::string render_table(const Table& table, TableFormat format);

/// "80.4", or "-" without a value.
std::string percent(std::optional<double> rate);

}  // namespace vpr
