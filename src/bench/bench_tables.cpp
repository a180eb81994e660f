// Benchmark results as tables, and the comparison of two runs.
#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "base/error.h"
#include "base/json_schema.h"
#include "bench/bench_result.h"

namespace vpr {
namespace {

std::vector<std::string> names_of(const std::vector<BenchRow>& rows,
                                  NamedNumbers BenchRow::*numbers) {
  std::vector<std::string> names;
  for (const BenchRow& row : rows)
    for (const auto& [name, value] : row.*numbers)
      if (std::ranges::count(names, name) == 0) names.push_back(name);
  return names;
}

std::string cell(const NamedNumbers& numbers, const std::string& name) {
  const std::optional<double> value = find_number(numbers, name);
  if (!value) return "";
  return fmt::format(fmt::runtime(*value == std::floor(*value) ? "{:.0f}" : "{:.6g}"), *value);
}

std::string milliseconds(double value) { return fmt::format("{:.4g}", value); }

std::string short_number(double value) {
  return fmt::format(fmt::runtime(std::abs(value) >= 1000 ? "{:.0f}" : "{:.4g}"), value);
}

// The column title of a value. Empty: only for developers of a method, or derived (the share of a
// core at 10 Hz equals the time in milliseconds), and so only in CSV and JSON.
std::string label(const std::string& name) {
  static const std::map<std::string, std::string> kLabels = {
      {"cpu_at_10_hz_percent", ""},
      {"learned_share", ""},
      {"ring", ""},
      {"statistics_s", ""},
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

// Groups rows that fit one table: they have the same unit and parameters of the same names.
std::vector<std::vector<BenchRow>> alike_rows(const std::vector<BenchRow>& rows) {
  const auto is_alike = [](const BenchRow& a, const BenchRow& b) {
    return a.per == b.per && std::ranges::equal(a.parameters, b.parameters, {}, &NamedNumber::name,
                                                &NamedNumber::name);
  };
  std::vector<std::vector<BenchRow>> groups;
  for (const BenchRow& row : rows) {
    const auto group = std::ranges::find_if(
        groups, [&](const auto& other) { return is_alike(other.front(), row); });
    (group == groups.end() ? groups.emplace_back() : *group).push_back(row);
  }
  return groups;
}

// Values of at least half of the rows.
std::vector<std::string> usual_values(const std::vector<BenchRow>& rows) {
  std::vector<std::string> names = names_of(rows, &BenchRow::values);
  std::erase_if(names, [&](const std::string& name) {
    const auto has = [&](const BenchRow& row) { return !cell(row.values, name).empty(); };
    return label(name).empty() ||
           2 * std::count_if(rows.begin(), rows.end(), has) < static_cast<ptrdiff_t>(rows.size());
  });
  return names;
}

// The other values of a row, and its note.
std::string remark(const BenchRow& row, const std::vector<std::string>& shown) {
  std::string text = row.note;
  for (const auto& [name, value] : row.values)
    if (!label(name).empty() && std::ranges::count(shown, name) == 0)
      text += fmt::format("{}{} {:.3g}", text.empty() ? "" : ", ", label(name), value);
  return text;
}

Table readable_table(const std::string& bench, const std::vector<BenchRow>& rows) {
  Table table;
  table.title = fmt::format("{}: milliseconds per {}", bench, rows.front().per);
  std::vector<std::string> parameters;  // those that differ; the others go into the title
  for (const std::string& name : names_of(rows, &BenchRow::parameters)) {
    const std::string first = cell(rows.front().parameters, name);
    if (std::ranges::all_of(
            rows, [&](const BenchRow& row) { return cell(row.parameters, name) == first; }))
      table.title += fmt::format(", {} {}", label(name), first);
    else
      parameters.push_back(name);
  }
  const std::vector<std::string> values = usual_values(rows);
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

std::string row_name(const std::string& work, const NamedNumbers& parameters) {
  std::string name = work;
  for (const auto& [key, value] : parameters) name += fmt::format(", {} {:g}", key, value);
  return name;
}

// Whether the median is more than `factor` times the old one, and the quartiles confirm it: the
// lower quartile ratio is above 1, or above the factor if that is smaller. Both bounds are strict.
bool is_slower(const BenchRatio& row, double factor) {
  return row.ratio > factor && row.low > std::min(factor, 1.0);
}

// The ratio of times that may be 0 because of the clock's resolution; 0 / 0 is 1.
double quotient(double a, double b) { return b > 0 ? a / b : a > 0 ? 1e9 : 1; }

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

BenchComparison compare_benches(const BenchResult& older, const BenchResult& newer) {
  if (older.bench != newer.bench)
    throw Error(ErrorKind::data, "one is a benchmark of {}, the other of {}", older.bench,
                newer.bench);
  BenchComparison comparison;
  for (const BenchRow& row : older.rows) {
    const BenchRow* other = find_row(newer, row.work, row.parameters);
    if (other == nullptr) {
      comparison.only_in_one.push_back(row_name(row.work, row.parameters) +
                                       ": only in the old run");
      continue;
    }
    const TimeSummary& before = row.time;
    const TimeSummary& after = other->time;
    comparison.ratios.push_back({row.work, row.parameters, before.median_ms, after.median_ms,
                                 quotient(after.median_ms, before.median_ms),
                                 quotient(after.lower_quartile_ms, before.upper_quartile_ms),
                                 quotient(after.upper_quartile_ms, before.lower_quartile_ms)});
  }
  for (const BenchRow& row : newer.rows)
    if (find_row(older, row.work, row.parameters) == nullptr)
      comparison.only_in_one.push_back(row_name(row.work, row.parameters) +
                                       ": only in the new run");
  if (comparison.ratios.empty())
    throw Error(ErrorKind::data,
                "the two runs have no row in common; compare runs with the same settings");
  return comparison;
}

Table comparison_table(const BenchComparison& comparison, double factor) {
  Table table;
  table.title =
      fmt::format("New against old; slower: above {:g}, and from quartile to quartile above {:g}",
                  factor, std::min(factor, 1.0));
  table.columns = {"work", "old ms", "new ms", "new / old", "from", "to", ""};
  for (const BenchRatio& row : comparison.ratios)
    table.rows.push_back({row_name(row.work, row.parameters), fmt::format("{:.4g}", row.old_ms),
                          fmt::format("{:.4g}", row.new_ms), fmt::format("{:.3f}", row.ratio),
                          fmt::format("{:.3f}", row.low), fmt::format("{:.3f}", row.high),
                          is_slower(row, factor) ? "slower"
                          : row.ratio > factor   ? "unsure"
                                                 : ""});
  return table;
}

namespace {

/// The file of a comparison.
struct ComparisonFile {
  BenchComparison& comparison;
  double factor = 0;
};

template <class Visitor>
void visit_fields(ComparisonFile& file, Visitor&& visit) {
  visit("schema", Derived{schema_name("bench-comparison")});
  visit("factor", file.factor, "Allowed ratio of medians (--factor).");
  visit("rows",
        NestedList{file.comparison.ratios,
                   [&](BenchRatio& row, auto&& inner) {
                     inner("work", row.work, "Name of the work.");
                     inner("parameters", numbers_field(row.parameters), "Names of the row.",
                           kAs<NumbersByName>);
                     inner("old_ms", row.old_ms, "Median of the old run.", at_least(0));
                     inner("new_ms", row.new_ms, "Median of the new run.", at_least(0));
                     inner("ratio", row.ratio, "New median / old median.", at_least(0));
                     inner("low", row.low, "New lower quartile / old upper one.", at_least(0));
                     inner("high", row.high, "New upper quartile / old lower one.", at_least(0));
                     inner("slower", Derived{is_slower(row, file.factor)},
                           "Ratio is above factor, and the quartiles agree.");
                   }},
        "Times that both runs have, in the order of the old run.");
  visit("only_in_one", file.comparison.only_in_one, "Rows that only one run has.");
  visit("slower", Derived{count_slower(file.comparison, file.factor)}, "Slower rows.");
}

}  // namespace

Json comparison_json(const BenchComparison& comparison, double factor) {
  BenchComparison visited = comparison;
  return value_to_json(ComparisonFile{visited, factor}, kDataForm);
}

Json bench_comparison_schema() {
  BenchComparison comparison;
  ComparisonFile file{comparison};
  return field_schema(file, SchemaForm::data);
}

size_t count_slower(const BenchComparison& comparison, double factor) {
  return static_cast<size_t>(std::ranges::count_if(
      comparison.ratios, [&](const BenchRatio& row) { return is_slower(row, factor); }));
}

}  // namespace vpr
