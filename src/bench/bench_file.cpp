#include "bench/bench_file.h"

#include <cmath>

#include "base/error.h"
#include "base/json.h"
#include "report/json_fields.h"

namespace vpr {
namespace {

Json numbers_json(const NamedNumbers& numbers) {
  Json json = Json::object();
  for (const auto& [name, value] : numbers) json[name] = value;
  return json;
}

NamedNumbers read_numbers(const Json& json, const Fields& where) {
  if (!json.is_object()) where.fail("parameters are no object");
  NamedNumbers numbers;
  for (const auto& [name, value] : json.items()) {
    if (!value.is_number()) where.fail("a parameter is no number");
    numbers.emplace_back(name, value.get<double>());
  }
  return numbers;
}

double read_time(const Fields& row, const std::string& key) {
  const Json& value = row[key];
  if (!value.is_number() || !(value.get<double>() >= 0)) row.fail("a time is no number");
  return value.get<double>();
}

}  // namespace

Json bench_json(const BenchResult& result, const RunInfo& run) {
  Json json = {{"schema", "vpr.bench/2"}, {"bench", result.bench}, {"settings", result.settings}};
  json["rows"] = Json::array();
  for (const BenchRow& row : result.rows)
    json["rows"].push_back({{"work", row.work},
                            {"parameters", numbers_json(row.parameters)},
                            {"per", row.per},
                            {"median_ms", row.time.median_ms},
                            {"lower_quartile_ms", row.time.lower_quartile_ms},
                            {"upper_quartile_ms", row.time.upper_quartile_ms},
                            {"least_ms", row.time.least_ms},
                            {"most_ms", row.time.most_ms},
                            {"repetitions", row.time.repetitions},
                            {"values", numbers_json(row.values)},
                            {"note", row.note}});
  json["left_out"] = result.left_out;
  json["provenance"] = provenance_json(run);
  json["machine"] = machine_json(run);
  return json;
}

BenchResult read_bench(const std::filesystem::path& path) {
  const std::string where = path.string();
  const Json json = read_json(path, ErrorKind::data);
  require_schema(json, "bench", where, ErrorKind::data, 2);
  const Fields fields(json, where);
  BenchResult result;
  result.bench = fields.text("bench");
  for (const Json& item : fields.list("rows")) {
    const Fields row(item, where);
    BenchRow& read = result.rows.emplace_back();
    read.work = row.text("work");
    read.per = row.text("per");
    read.parameters = read_numbers(row["parameters"], row);
    read.time = {read_time(row, "median_ms"),         read_time(row, "lower_quartile_ms"),
                 read_time(row, "upper_quartile_ms"), read_time(row, "least_ms"),
                 read_time(row, "most_ms"),           row.count("repetitions", 1ULL << 40)};
  }
  return result;
}

}  // namespace vpr
