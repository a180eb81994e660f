#include "bench/bench_result.h"

namespace vpr {

std::optional<double> find_number(const NamedNumbers& numbers, const std::string& name) {
  for (const auto& [key, value] : numbers)
    if (key == name) return value;
  return std::nullopt;
}

double BenchRow::parameter(const std::string& name) const {
  return find_number(parameters, name).value_or(0);
}

void add_speed_up(BenchResult& result, const std::string& work, const std::string& slower,
                  const std::string& name) {
  for (BenchRow& row : result.rows) {
    if (row.work != work) continue;
    if (const BenchRow* other = find_row(result, slower, row.parameters))
      row.values.emplace_back(name, other->time.median_ms / row.time.median_ms);
  }
}

const BenchRow* find_row(const BenchResult& result, const std::string& work,
                         const NamedNumbers& parameters) {
  for (const BenchRow& row : result.rows)
    if (row.work == work && row.parameters == parameters) return &row;
  return nullptr;
}

}  // namespace vpr
