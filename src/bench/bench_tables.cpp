#include "bench/bench_tables.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include <fmt/format.h>

#include "base/error.h"
#include "base/json.h"

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

// Values for developers of a method, or derived ones: the share of a core at 10 Hz equals the time
// in milliseconds. CSV and JSON include them.
bool is_shown(const std::string& name) {
  static const std::set<std::string> kHidden = {"cpu_at_10_hz_percent", "ring", "statistics_s",
                                                "learned_share"};
  return kHidden.count(name) == 0;
}

std::string short_number(double value) {
  return fmt::format(fmt::runtime(std::abs(value) >= 1000 ? "{:.0f}" : "{:.4g}"), value);
}

// The column title of a value.
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

// Whether two rows fit one table: they have the same unit and parameters of the same names.
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

// Splits the parameters of rows with equal names: those that differ become columns, the others
// become text.
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

// Values of at least half of the rows.
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

// A large ratio whose quartiles include the old time is not significant.
std::string verdict(const BenchRatio& row, double factor) {
  if (is_slower(row, factor)) return "slower";
  return row.ratio > factor ? "unsure" : "";
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
    throw Error(ErrorKind::data,
                fmt::format("one is a benchmark of {}, the other of {}", older.bench, newer.bench));
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
                "the two runs have no row in common; compare runs with the same "
                "settings");
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
                          verdict(row, factor)});
  return table;
}

Json comparison_json(const BenchComparison& comparison, double factor) {
  Json json = {{"schema", "vpr.bench-comparison/1"}, {"factor", factor}};
  json["rows"] = Json::array();
  for (const BenchRatio& row : comparison.ratios) {
    Json parameters = Json::object();
    for (const auto& [name, value] : row.parameters) parameters[name] = value;
    json["rows"].push_back({{"work", row.work},
                            {"parameters", parameters},
                            {"old_ms", row.old_ms},
                            {"new_ms", row.new_ms},
                            {"ratio", row.ratio},
                            {"low", row.low},
                            {"high", row.high},
                            {"slower", is_slower(row, factor)}});
  }
  json["only_in_one"] = comparison.only_in_one;
  json["slower"] = count_slower(comparison, factor);
  return json;
}

size_t count_slower(const BenchComparison& comparison, double factor) {
  return static_cast<size_t>(
      std::count_if(comparison.ratios.begin(), comparison.ratios.end(),
                    [&](const BenchRatio& row) { return is_slower(row, factor); }));
}

}  // namespace vpr
