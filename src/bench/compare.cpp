#include "bench/compare.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/error.h"
#include "base/json.h"

namespace vpr {
namespace {

std::string row_name(const std::string& work, const NamedNumbers& parameters) {
  std::string name = work;
  for (const auto& [key, value] : parameters) name += fmt::format(", {} {:g}", key, value);
  return name;
}

// Whether a median is more than `factor` times the old one, and the spread agrees: the lower
// quartile ratio is above 1 (above the factor, if that is smaller). Both strict.
bool is_slower(const BenchRatio& row, double factor) {
  return row.ratio > factor && row.low > std::min(factor, 1.0);
}

// In words: a large ratio whose spread reaches down to the old time proves nothing.
std::string verdict(const BenchRatio& row, double factor) {
  if (is_slower(row, factor)) return "slower";
  return row.ratio > factor ? "unsure" : "";
}

// Of times that may be 0: the clock's least step apart, nothing is faster than nothing.
double quotient(double a, double b) { return b > 0 ? a / b : a > 0 ? 1e9 : 1; }

}  // namespace

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
