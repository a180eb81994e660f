#include "bench/bench_result.h"

#include <algorithm>

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
  for (const auto& [key, value] : numbers)
    if (key == name) return fmt::format("{:.6g}", value);
  return "";
}

std::string milliseconds(double value) { return fmt::format("{:.4g}", value); }

}  // namespace

double BenchRow::parameter(const std::string& name) const {
  for (const auto& [key, value] : parameters)
    if (key == name) return value;
  return 0;
}

void add_speed_up(BenchResult& result, const std::string& work, const std::string& slower,
                  const std::string& name) {
  for (BenchRow& row : result.rows) {
    if (row.work != work) continue;
    if (const auto other = find_median(result, slower, row.parameters))
      row.values.emplace_back(name, *other / row.time.median_ms);
  }
}

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

Table paper_table(const BenchResult& result) {
  Table table;
  table.title = "The paper's numbers and ours";
  table.columns = {"table", "what"};
  std::vector<std::string> names;
  for (const PaperNumber& number : result.paper)
    for (const auto& [name, value] : number.parameters)
      if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  table.columns.insert(table.columns.end(), names.begin(), names.end());
  table.columns.insert(table.columns.end(), {"unit", "paper", "ours", "paper / ours"});
  for (const PaperNumber& number : result.paper) {
    std::vector<std::string>& cells = table.rows.emplace_back();
    cells = {number.table, number.what};
    for (const std::string& name : names) cells.push_back(cell(number.parameters, name));
    cells.insert(
        cells.end(),
        {number.unit, fmt::format("{:.4g}", number.paper), fmt::format("{:.4g}", number.ours),
         number.unit == "ms" ? fmt::format("{:.3g}", number.paper / number.ours) : ""});
  }
  return table;
}

std::optional<double> find_median(const BenchResult& result, const std::string& work,
                                  const NamedNumbers& parameters) {
  for (const BenchRow& row : result.rows)
    if (row.work == work && row.parameters == parameters) return row.time.median_ms;
  return std::nullopt;
}

}  // namespace vpr
