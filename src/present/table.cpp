#include "present/table.h"

#include <algorithm>
#include <cassert>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/csv.h"
#include "base/text.h"

namespace vpr {
namespace {

// Code points, which is what takes room on a terminal for the names that occur here.
size_t width(const std::string& text) {
  return static_cast<size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return (c & 0xc0) != 0x80; }));
}

bool looks_numeric(const std::string& text) {
  return text.empty() || text == "-" || text == "- " || text.find_first_of("0123456789") == 0 ||
         (text.size() > 1 && (text[0] == '-' || text[0] == '+') && text[1] >= '0' &&
          text[1] <= '9');
}

bool is_numeric(const Table& table, size_t column) {
  return std::all_of(table.rows.begin(), table.rows.end(),
                     [&](const auto& row) { return looks_numeric(row[column]); });
}

std::string padded(const std::string& text, size_t to, bool right) {
  const std::string space(to - std::min(to, width(text)), ' ');
  return right ? space + text : text + space;
}

std::vector<size_t> column_widths(const Table& table) {
  std::vector<size_t> widths;
  for (size_t c = 0; c < table.columns.size(); ++c) {
    widths.push_back(width(table.columns[c]));
    for (const auto& row : table.rows) widths[c] = std::max(widths[c], width(row[c]));
  }
  return widths;
}

// Stars stand in a place of their own, so that digits stay below each other.
Table with_stars(Table table) {
  std::set<size_t> starred;
  for (const auto& cell : table.best) starred.insert(cell.second);
  for (const size_t column : starred)
    for (size_t row = 0; row < table.rows.size(); ++row)
      table.rows[row][column] += table.best.contains({row, column}) ? "*" : " ";
  return table;
}

std::string text_table(const Table& table) {
  const std::vector<size_t> widths = column_widths(table);
  const auto line = [&](const std::vector<std::string>& cells) {
    std::string text;
    for (size_t c = 0; c < cells.size(); ++c)
      text += (c == 0 ? "" : "  ") + padded(cells[c], widths[c], is_numeric(table, c));
    text.erase(text.find_last_not_of(' ') + 1);
    return text + "\n";
  };
  std::string text = table.title.empty() ? "" : table.title + "\n";
  text += line(table.columns);
  size_t total = 2 * (widths.empty() ? 0 : widths.size() - 1);
  for (const size_t w : widths) total += w;
  text += std::string(total, '-') + "\n";
  for (const auto& row : table.rows) text += line(row);
  return text + (table.best.empty() ? "" : "* the best\n");
}

// What stands in a cell, or is the title, stays there.
Table with_printable_text(Table table) {
  const auto print = [](std::string& text) { text = printable_line(text); };
  print(table.title);
  std::for_each(table.columns.begin(), table.columns.end(), print);
  for (auto& row : table.rows) std::for_each(row.begin(), row.end(), print);
  return table;
}

std::string csv_table(const Table& table) {
  const auto line = [](const std::vector<std::string>& cells) {
    std::vector<std::string> fields;
    for (const std::string& cell : cells) fields.push_back(csv_field(cell));
    return fmt::format("{}\n", fmt::join(fields, ","));
  };
  std::string text = line(table.columns);
  for (const auto& row : table.rows) text += line(row);
  return text;
}

std::string markdown_escaped(const std::string& text) {
  std::string escaped;
  for (const char c : text) escaped += c == '|' ? "\\|" : std::string(1, c);
  return escaped;
}

// The rows with their cells written by `escape`, and the best ones as `bold` has them.
template <class Escape, class Bold>
std::vector<std::vector<std::string>> written_rows(const Table& table, const Escape& escape,
                                                   const Bold& bold) {
  std::vector<std::vector<std::string>> rows;
  for (size_t r = 0; r < table.rows.size(); ++r) {
    auto& cells = rows.emplace_back();
    for (size_t c = 0; c < table.columns.size(); ++c) {
      const std::string cell = escape(table.rows[r][c]);
      cells.push_back(table.best.contains({r, c}) ? bold(cell) : cell);
    }
  }
  return rows;
}

std::string markdown_table(const Table& table) {
  const auto line = [](const std::vector<std::string>& cells) {
    return fmt::format("| {} |\n", fmt::join(cells, " | "));
  };
  std::vector<std::string> columns;
  for (const std::string& column : table.columns) columns.push_back(markdown_escaped(column));
  std::string text = table.title.empty() ? "" : fmt::format("**{}**\n\n", table.title);
  text += line(columns) + "|";
  for (size_t c = 0; c < table.columns.size(); ++c)
    text += is_numeric(table, c) ? " ---: |" : " --- |";
  text += "\n";
  const auto bold = [](const std::string& cell) { return "**" + cell + "**"; };
  for (const auto& row : written_rows(table, markdown_escaped, bold)) text += line(row);
  return text;
}

std::string latex_escaped(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    if (std::string_view("&%$#_{}").find(c) != std::string_view::npos)
      escaped += std::string("\\") + c;
    else if (c == '\\')
      escaped += "\\textbackslash{}";
    else if (c == '~')
      escaped += "\\textasciitilde{}";
    else if (c == '^')
      escaped += "\\textasciicircum{}";
    else
      escaped += c;
  }
  return escaped;
}

// What a reference calls the table: words of its title, at most so many characters.
std::string latex_label(const std::string& title) {
  constexpr size_t kMostCharacters = 40;
  std::string label;
  for (const char c : title) {
    const bool is_word = (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
    if (is_word)
      label += c;
    else if (!label.empty() && label.back() != '-')
      label += '-';
    if (label.size() == kMostCharacters) break;
  }
  return label.substr(0, label.find_last_not_of('-') + 1);
}

std::string latex_table(const Table& table) {
  const auto line = [](const std::vector<std::string>& cells) {
    return fmt::format("{} \\\\\n", fmt::join(cells, " & "));
  };
  std::vector<std::string> names;
  for (const std::string& column : table.columns) names.push_back(latex_escaped(column));
  std::string columns;
  for (size_t c = 0; c < table.columns.size(); ++c) columns += is_numeric(table, c) ? 'r' : 'l';
  std::string text = "% \\usepackage{booktabs}\n\\begin{table}\n\\centering\n";
  if (!table.title.empty())
    text += fmt::format("\\caption{{{}}}\n\\label{{tab:{}}}\n", latex_escaped(table.title),
                        latex_label(table.title));
  text += fmt::format("\\begin{{tabular}}{{{}}}\n\\toprule\n{}\\midrule\n", columns, line(names));
  const auto bold = [](const std::string& cell) { return "\\textbf{" + cell + "}"; };
  for (const auto& row : written_rows(table, latex_escaped, bold)) text += line(row);
  return text + "\\bottomrule\n\\end{tabular}\n\\end{table}\n";
}

}  // namespace

void add_column(Table& table, std::string_view column, std::string cell) {
  table.columns.emplace_back(column);
  if (table.rows.empty()) table.rows.emplace_back();
  table.rows[0].push_back(std::move(cell));
}

void add_column(Table& table, std::string_view column, uint64_t count) {
  add_column(table, column, std::to_string(count));
}

void add_columns(Table& table, const Table& more) {
  for (size_t c = 0; c < more.columns.size(); ++c)
    add_column(table, more.columns[c], more.rows[0][c]);
}

Table stack_tables(const std::vector<Table>& tables, const std::string& key,
                   const std::vector<std::string>& names) {
  Table stacked;
  stacked.columns = {key};
  for (const Table& table : tables) {
    for (const std::string& column : table.columns)
      if (std::count(stacked.columns.begin() + 1, stacked.columns.end(), column) == 0)
        stacked.columns.push_back(column);
    const bool is_alike = table.title == tables.front().title;
    if (is_alike && (&table == &tables.front() || !stacked.title.empty()))
      stacked.title = table.title;
    else
      stacked.title.clear();
  }
  for (const Table& table : tables) {
    for (const auto& row : table.rows) {
      auto& cells = stacked.rows.emplace_back(stacked.columns.size());
      cells[0] = names[stacked.rows.size() - 1];
      for (size_t c = 0; c < row.size(); ++c)
        cells[static_cast<size_t>(
            std::find(stacked.columns.begin() + 1, stacked.columns.end(), table.columns[c]) -
            stacked.columns.begin())] = row[c];
    }
  }
  return stacked;
}

std::string render_table(const Table& table, TableFormat format) {
  for ([[maybe_unused]] const auto& row : table.rows) assert(row.size() == table.columns.size());
  switch (format) {
    case TableFormat::text:
      return text_table(with_stars(with_printable_text(table)));
    case TableFormat::csv:
      return csv_table(table);
    case TableFormat::markdown:
      return markdown_table(with_printable_text(table));
    case TableFormat::latex:
      return latex_table(with_printable_text(table));
  }
  return {};
}

}  // namespace vpr
