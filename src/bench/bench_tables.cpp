#include "bench/bench_tables.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include <fmt/format.h>

namespace vpr {
namespace {

std::vector<std::string> names_of(const std::vector<BenchRow>& rows,
                                  NamedNumbers BenchRow::*numbers) {
  std::vector<std::string> names;
  for (const BenchRow& row : rows)
    for (const auto& [name, value] : row.*numbers)
      if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  return names;
}

std::string cell(const NamedNumbers& numbers, const std::string& name) {
  const std::optional<double> value = find_number(numbers, name);
  if (!value) return "";
  return fmt::format(fmt::runtime(*value == std::floor(*value) ? "{:.0f}" : "{:.6g}"), *value);
}

std::string milliseconds(double value) { return fmt::format("{:.4g}", value); }

// Values that people don't miss: the share of a core at 10 Hz is the time in milliseconds, the
// others concern who works on the method. CSV and JSON have them.
bool is_shown(const std::string& name) {
  static const std::set<std::string> kHidden = {"cpu_at_10_hz_percent", "ring", "statistics_s",
                                                "learned_share"};
  return kHidden.count(name) == 0;
}

std::string short_number(double value) {
  return fmt::format(fmt::runtime(std::abs(value) >= 1000 ? "{:.0f}" : "{:.4g}"), value);
}

// What a table for people calls a value.
std::string label(const std::string& name) {
  static const std::map<std::string, std::string> kLabels = {
      {"c_l", "c_l"},
      {"cpu_percent", "CPU %"},
      {"peak_mib", "peak MiB"},
      {"share_of_fastable_speed", "x FastABLE"},
      {"times_openable", "x OpenABLE"},
      {"build_s", "build s"},
      {"latency_50_ms", "50 %"},
      {"latency_95_ms", "95 %"},
      {"latency_99_ms", "99 %"},
      {"latency_max_ms", "latest"}};
  const auto found = kLabels.find(name);
  if (found != kLabels.end()) return found->second;
  std::string words = name;
  std::replace(words.begin(), words.end(), '_', ' ');
  return words;
}

// Rows that fit one table: of the same unit, and with the same parameters.
bool is_alike(const BenchRow& a, const BenchRow& b) {
  const auto same_name = [](const auto& x, const auto& y) { return x.first == y.first; };
  return a.per == b.per && std::equal(a.parameters.begin(), a.parameters.end(),
                                      b.parameters.begin(), b.parameters.end(), same_name);
}

std::vector<std::vector<BenchRow>> alike_rows(const std::vector<BenchRow>& rows) {
  std::vector<std::vector<BenchRow>> groups;
  for (const BenchRow& row : rows) {
    const auto group = std::find_if(groups.begin(), groups.end(), [&](const auto& other) {
      return is_alike(other.front(), row);
    });
    (group == groups.end() ? groups.emplace_back() : *group).push_back(row);
  }
  return groups;
}

// Splits the parameters of alike rows: those that differ get a column, the others go into words.
std::vector<std::string> differing(const std::vector<BenchRow>& rows, std::string& common) {
  std::vector<std::string> names;
  for (const auto& [name, value] : rows.front().parameters) {
    const std::string first = cell(rows.front().parameters, name);
    const bool same = std::all_of(rows.begin(), rows.end(), [&, &key = name](const BenchRow& row) {
      return cell(row.parameters, key) == first;
    });
    if (same)
      common += fmt::format(", {} {}", label(name), first);
    else
      names.push_back(name);
  }
  return names;
}

// Values that at least half of the rows have.
std::vector<std::string> usual_values(const std::vector<BenchRow>& rows) {
  std::vector<std::string> names = names_of(rows, &BenchRow::values);
  std::erase_if(names, [&](const std::string& name) {
    const auto has = [&](const BenchRow& row) { return !cell(row.values, name).empty(); };
    return !is_shown(name) ||
           2 * std::count_if(rows.begin(), rows.end(), has) < static_cast<ptrdiff_t>(rows.size());
  });
  return names;
}

// The other values of a row, and its note.
std::string remark(const BenchRow& row, const std::vector<std::string>& shown) {
  std::string text = row.note;
  for (const auto& [name, value] : row.values)
    if (is_shown(name) && std::find(shown.begin(), shown.end(), name) == shown.end())
      text += fmt::format("{}{} {:.3g}", text.empty() ? "" : ", ", label(name), value);
  return text;
}

Table readable_table(const std::string& bench, const std::vector<BenchRow>& rows) {
  Table table;
  std::string common;
  const std::vector<std::string> parameters = differing(rows, common);
  const std::vector<std::string> values = usual_values(rows);
  table.title = fmt::format("{}: milliseconds per {}{}", bench, rows.front().per, common);
  table.columns = {"work"};
  for (const std::string& name : parameters) table.columns.push_back(label(name));
  table.columns.insert(table.columns.end(), {"median", "quartiles", "runs"});
  for (const std::string& name : values) table.columns.push_back(label(name));
  bool any_remark = false;
  for (const BenchRow& row : rows) any_remark |= !remark(row, values).empty();
  if (any_remark) table.columns.emplace_back("");
  for (const BenchRow& row : rows) {
    std::vector<std::string>& cells = table.rows.emplace_back();
    cells.push_back(row.work);
    for (const std::string& name : parameters) cells.push_back(cell(row.parameters, name));
    cells.insert(cells.end(), {milliseconds(row.time.median_ms),
                               fmt::format("{} to {}", milliseconds(row.time.lower_quartile_ms),
                                           milliseconds(row.time.upper_quartile_ms)),
                               std::to_string(row.time.repetitions)});
    for (const std::string& name : values) {
      const std::optional<double> value = find_number(row.values, name);
      cells.push_back(value ? short_number(*value) : "");
    }
    if (any_remark) cells.push_back(remark(row, values));
  }
  return table;
}

}  // namespace

Table rows_table(const BenchResult& result) {
  Table table;
  table.title = fmt::format("{}: milliseconds", result.bench);
  const auto parameters = names_of(result.rows, &BenchRow::parameters);
  const auto values = names_of(result.rows, &BenchRow::values);
  table.columns = {"work"};
  table.columns.insert(table.columns.end(), parameters.begin(), parameters.end());
  table.columns.insert(table.columns.end(),
                       {"per", "median", "lower quartile", "upper quartile", "repetitions"});
  table.columns.insert(table.columns.end(), values.begin(), values.end());
  table.columns.emplace_back("note");
  for (const BenchRow& row : result.rows) {
    std::vector<std::string>& cells = table.rows.emplace_back();
    cells.push_back(row.work);
    for (const std::string& name : parameters) cells.push_back(cell(row.parameters, name));
    cells.insert(
        cells.end(),
        {row.per, milliseconds(row.time.median_ms), milliseconds(row.time.lower_quartile_ms),
         milliseconds(row.time.upper_quartile_ms), std::to_string(row.time.repetitions)});
    for (const std::string& name : values) cells.push_back(cell(row.values, name));
    cells.push_back(row.note);
  }
  return table;
}

std::vector<Table> readable_tables(const BenchResult& result) {
  std::vector<Table> tables;
  for (const std::vector<BenchRow>& rows : alike_rows(result.rows))
    tables.push_back(readable_table(result.bench, rows));
  return tables;
}

}  // namespace vpr
