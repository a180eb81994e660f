#include "present/table.h"

#include <algorithm>
#include <cassert>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/text.h"

namespace vpr {
namespace {

// Code points, for lack of the width of characters.
size_t width(const std::string& text) {
  return static_cast<size_t>(std::ranges::count_if(text, starts_letter));
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

// Cells without a star end in a blank, so that digits stay aligned.
Table with_stars(Table table) {
  std::set<size_t> starred;
  for (const auto& cell : table.best) starred.insert(cell.second);
  for (const size_t column : starred)
    for (size_t row = 0; row < table.rows.size(); ++row)
      table.rows[row][column] += table.best.contains({row, column}) ? "*" : " ";
  return table;
}

std::string text_table(const Table& table) {
  const size_t columns = table.columns.size();
  std::vector<size_t> widths;
  for (size_t c = 0; c < columns; ++c) {
    widths.push_back(width(table.columns[c]));
    for (const auto& row : table.rows) widths[c] = std::max(widths[c], width(row[c]));
  }
  const auto line = [&](const std::vector<std::string>& cells) {
    std::string text;
    for (size_t c = 0; c < columns; ++c) {
      const std::string space(widths[c] - width(cells[c]), ' ');
      text += (c == 0 ? "" : "  ") + (is_numeric(table, c) ? space + cells[c] : cells[c] + space);
    }
    text.erase(text.find_last_not_of(' ') + 1);
    return text + "\n";
  };
  std::string text = table.title.empty() ? "" : table.title + "\n";
  if (!table.groups.empty()) {
    std::string names;
    size_t at = 0;  // the left end of a column
    for (size_t c = 0; c < columns; ++c) {
      const auto group = std::ranges::find(table.groups, c, &ColumnGroup::first);
      if (group != table.groups.end()) {
        if (width(names) + 1 > at && c > 0) names += "  ";
        names += std::string(at > width(names) ? at - width(names) : 0, ' ') + group->name;
      }
      at += widths[c] + 2;
    }
    text += names + "\n";
  }
  text += line(table.columns);
  size_t total = 2 * (widths.empty() ? 0 : widths.size() - 1);
  for (const size_t w : widths) total += w;
  text += std::string(total, '-') + "\n";
  for (const auto& row : table.rows) text += line(row);
  if (!table.best.empty()) text += "* the best\n";
  for (const std::string& note : table.notes) text += wrapped_line(note, 80, 2) + "\n";
  return text;
}

// No cell and no title breaks its line.
Table with_printable_text(Table table) {
  const auto print = [](std::string& text) { text = printable_line(text); };
  print(table.title);
  std::for_each(table.columns.begin(), table.columns.end(), print);
  for (auto& row : table.rows) std::for_each(row.begin(), row.end(), print);
  std::for_each(table.notes.begin(), table.notes.end(), print);
  for (ColumnGroup& group : table.groups) print(group.name);
  return table;
}

// "corridor R@1": for formats without groups of columns.
std::vector<std::string> full_columns(const Table& table) {
  std::vector<std::string> columns = table.columns;
  for (const ColumnGroup& group : table.groups)
    for (size_t c = group.first; c < group.first + group.count; ++c)
      columns[c] = group.name + " " + columns[c];
  return columns;
}

std::string csv_table(const Table& table) {
  const auto line = [](const std::vector<std::string>& cells) {
    std::vector<std::string> fields;
    for (const std::string& cell : cells) fields.push_back(csv_field(cell));
    return fmt::format("{}\n", fmt::join(fields, ","));
  };
  std::string text = line(full_columns(table));
  for (const auto& row : table.rows) text += line(row);
  return text;
}

std::string markdown_escaped(const std::string& text) {
  std::string escaped;
  for (const char c : text) escaped += c == '|' ? "\\|" : std::string(1, c);
  return escaped;
}

// The rows with escaped cells; `bold` marks the best.
template <class Escape, class Bold>
std::vector<std::vector<std::string>> marked_rows(const Table& table, const Escape& escape,
                                                  const Bold& bold) {
  std::vector<std::vector<std::string>> rows = table.rows;
  for (size_t r = 0; r < rows.size(); ++r)
    for (size_t c = 0; c < rows[r].size(); ++c) {
      rows[r][c] = escape(rows[r][c]);
      if (table.best.contains({r, c})) rows[r][c] = bold(rows[r][c]);
    }
  return rows;
}

std::string markdown_table(const Table& table) {
  const auto line = [](const std::vector<std::string>& cells) {
    return fmt::format("| {} |\n", fmt::join(cells, " | "));
  };
  std::vector<std::string> columns;
  for (const std::string& column : full_columns(table)) columns.push_back(markdown_escaped(column));
  std::string text = table.title.empty() ? "" : fmt::format("**{}**\n\n", table.title);
  text += line(columns) + "|";
  for (size_t c = 0; c < table.columns.size(); ++c)
    text += is_numeric(table, c) ? " ---: |" : " --- |";
  text += "\n";
  const auto bold = [](const std::string& cell) { return "**" + cell + "**"; };
  for (const auto& row : marked_rows(table, markdown_escaped, bold)) text += line(row);
  for (const std::string& note : table.notes) text += "\n" + note + "\n";
  return text;
}

std::string latex_escaped(const std::string& text) {
  std::string escaped;
  for (size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    const auto is_one_of = [&](std::string_view some, size_t at) {
      return at < text.size() && some.find(text[at]) != std::string_view::npos;
    };
    if (c == '-' && (i == 0 || is_one_of(" ([", i - 1)) && is_one_of("0123456789", i + 1))
      escaped += "$-$";
    else if (is_one_of("&%$#_{}", i))
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

// Letters and digits of the title, with a hyphen for other characters, at most 40 characters.
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

// A row of names over their columns, with lines below.
std::string latex_groups(const Table& table) {
  if (table.groups.empty()) return "";
  std::string cells;
  std::string lines;
  size_t at = 0;
  for (const ColumnGroup& group : table.groups) {
    for (; at < group.first; ++at) cells += at == 0 ? "" : " & ";
    cells += fmt::format("{}\\multicolumn{{{}}}{{c}}{{{}}}", group.first == 0 ? "" : " & ",
                         group.count, latex_escaped(group.name));
    lines += fmt::format("\\cmidrule(lr){{{}-{}}}", group.first + 1, group.first + group.count);
    at = group.first + group.count;
  }
  return cells + " \\\\\n" + lines + "\n";
}

// An interval in brackets is below its value, in small letters.
std::string latex_cell(const std::string& text) {
  const auto [value, interval] = value_and_interval(text);
  if (interval.empty()) return latex_escaped(value);
  return fmt::format("\\shortstack[r]{{{}\\\\{{\\scriptsize {}}}}}", latex_escaped(value),
                     latex_escaped(interval));
}

std::string latex_table(const Table& table) {
  const auto line = [](const std::vector<std::string>& cells) {
    return fmt::format("{} \\\\\n", fmt::join(cells, " & "));
  };
  std::vector<std::string> names;
  for (const std::string& column : table.columns) names.push_back(latex_escaped(column));
  std::string columns;
  for (size_t c = 0; c < table.columns.size(); ++c) columns += is_numeric(table, c) ? 'r' : 'l';
  std::string text = "% \\usepackage{booktabs}\n";
  for (const std::string& note : table.notes) text += "% " + note + "\n";
  text += "\\begin{table}\n\\centering\n";
  if (!table.title.empty())
    text += fmt::format("\\caption{{{}}}\n\\label{{tab:{}}}\n", latex_escaped(table.title),
                        table.label.empty() ? latex_label(table.title) : table.label);
  text += fmt::format("\\begin{{tabular}}{{{}}}\n\\toprule\n{}{}\\midrule\n", columns,
                      latex_groups(table), line(names));
  const auto bold = [](const std::string& cell) { return "\\textbf{" + cell + "}"; };
  const auto has_interval = [](const std::string& cell) {
    return cell.find("\\shortstack") != std::string::npos;
  };
  const std::vector<std::vector<std::string>> rows = marked_rows(table, latex_cell, bold);
  for (const auto& row : rows) {
    if (&row != &rows.front() && std::ranges::any_of(row, has_interval))
      text += "\\addlinespace[3pt]\n";
    // After the end of a row, a bracket begins an argument, and a star a variant.
    if (row.front().starts_with('[') || row.front().starts_with('*')) text += "{}";
    text += line(row);
  }
  return text + "\\bottomrule\n\\end{tabular}\n\\end{table}\n";
}

}  // namespace

std::pair<std::string, std::string> value_and_interval(const std::string& text) {
  const size_t bracket = text.find(" [");
  if (bracket == std::string::npos || !text.ends_with(']')) return {text, ""};
  return {text.substr(0, bracket), text.substr(bracket + 1)};
}

void mark_best(Table& table, size_t column, const std::vector<std::optional<double>>& values,
               bool is_low_good) {
  std::optional<double> best;
  for (const auto& value : values)
    if (value && (!best || (is_low_good ? *value < *best : *value > *best))) best = value;
  for (size_t row = 0; row < values.size(); ++row)
    if (best && (is_low_good || *best != 0) && values[row] == best)
      table.best.insert({row, column});
}

std::vector<std::string> numbered_names(const std::vector<std::string>& names) {
  std::vector<std::string> numbered = names;
  for (size_t i = 0; i < names.size(); ++i)
    if (std::ranges::count(names, names[i]) > 1) numbered[i] += fmt::format(" ({})", i + 1);
  return numbered;
}

Table joined_tables(const std::vector<std::pair<std::string, Table>>& tables) {
  Table joined = tables.front().second;
  joined.columns.resize(1);
  joined.rows.clear();
  joined.best.clear();
  joined.title.clear();
  joined.notes.clear();
  std::set<std::string_view> parts;  // of the title, each once
  for (const auto& [name, table] : tables)
    for (const auto& row : table.rows)
      if (std::ranges::none_of(joined.rows, [&](const auto& one) { return one[0] == row[0]; }))
        joined.rows.push_back({row[0]});
  for (const auto& [name, table] : tables) {
    const size_t first = joined.columns.size();
    joined.groups.push_back({name, first, table.columns.size() - 1});
    joined.columns.insert(joined.columns.end(), table.columns.begin() + 1, table.columns.end());
    for (size_t r = 0; r < joined.rows.size(); ++r) {
      auto& row = joined.rows[r];
      const auto found =
          std::ranges::find_if(table.rows, [&](const auto& one) { return one[0] == row[0]; });
      if (found == table.rows.end()) {
        row.resize(joined.columns.size(), "-");
        continue;
      }
      row.insert(row.end(), found->begin() + 1, found->end());
      const auto own = static_cast<size_t>(found - table.rows.begin());
      for (size_t c = 1; c < table.columns.size(); ++c)
        if (table.best.contains({own, c})) joined.best.insert({r, first + c - 1});
    }
    for (const std::string_view part : split(table.title, ';'))
      if (parts.insert(part).second) {
        if (!joined.title.empty()) joined.title += part.starts_with(' ') ? ";" : "; ";
        joined.title += part;
      }
    for (const std::string& note : table.notes)
      joined.notes.push_back(fmt::format("{}: {}", name, note));
  }
  return joined;
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

std::string percent(std::optional<double> rate) {
  return rate ? fmt::format("{:.1f}", 100 * *rate) : "-";
}

}  // namespace vpr
