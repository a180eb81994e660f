#include "bench/bench_result.h"

#include <algorithm>
#include <fstream>

#include <fmt/format.h>
#include <sched.h>

#include "base/error.h"
#include "base/json.h"
#include "base/statistics.h"
#include "base/stopwatch.h"

namespace vpr {
namespace {

// The value of a line "Name:   123 kB" of a file in /proc, in bytes.
size_t proc_bytes(const char* path, const std::string& name) {
  std::ifstream file(path);
  for (std::string word; file >> word;) {
    if (word != name + ":") continue;
    size_t kilobytes = 0;
    file >> kilobytes;
    return kilobytes * 1024;
  }
  return 0;
}

NamedNumbers read_numbers(const Json& json, const Fields& where) {
  if (!json.is_object()) where.fail("the parameters are not an object");
  NamedNumbers numbers;
  for (const auto& [name, value] : json.items()) {
    if (!value.is_number()) where.fail("a parameter is not a number");
    numbers.emplace_back(name, value.get<double>());
  }
  return numbers;
}

double read_time(const Fields& row, const std::string& key) {
  const Json& value = row[key];
  if (!value.is_number() || !(value.get<double>() >= 0)) row.fail("a time is not a number");
  return value.get<double>();
}

}  // namespace

TimeSummary summarize(std::vector<double> times_ms) {
  std::sort(times_ms.begin(), times_ms.end());
  return {median(times_ms), quantile(times_ms, 0.25), quantile(times_ms, 0.75),
          times_ms.front(), times_ms.back(),          times_ms.size()};
}

void check_seconds(double seconds) {
  if (!(seconds > 0 && seconds <= 3600))
    throw Error(ErrorKind::usage,
                fmt::format("seconds must be above 0 and at most 3600, found {}", seconds));
}

void check_values(std::string_view name, const std::vector<uint64_t>& values, uint64_t low,
                  uint64_t high) {
  if (values.empty()) throw Error(ErrorKind::usage, fmt::format("{} is empty", name));
  for (const uint64_t value : values)
    if (value < low || value > high)
      throw Error(ErrorKind::usage,
                  fmt::format("{} must be from {} to {}, found {}", name, low, high, value));
}

TimeSummary time_repeatedly(const Effort& effort, const std::function<void()>& work,
                            const Monitor& monitor, double units) {
  for (size_t i = 0; i < effort.warm_ups; ++i) {
    check_stop(monitor);
    work();
  }
  std::vector<double> times_ms;
  const Stopwatch all;
  while (times_ms.size() < effort.repetitions ||
         (all.elapsed_s() < effort.seconds && times_ms.size() < effort.most)) {
    check_stop(monitor);
    const Stopwatch watch;
    work();
    times_ms.push_back(watch.elapsed_ms() / units);
  }
  return summarize(std::move(times_ms));
}

void pin_to_cores(size_t cores) {
  cpu_set_t allowed;
  if (sched_getaffinity(0, sizeof(allowed), &allowed) != 0) return;
  cpu_set_t chosen;
  CPU_ZERO(&chosen);
  size_t count = 0;
  for (int core = 0; core < CPU_SETSIZE && count < cores; ++core) {
    if (!CPU_ISSET(core, &allowed)) continue;
    CPU_SET(core, &chosen);
    ++count;
  }
  if (count == cores) sched_setaffinity(0, sizeof(chosen), &chosen);
}

void reset_peak_memory() { std::ofstream("/proc/self/clear_refs") << "5"; }

size_t peak_memory() { return proc_bytes("/proc/self/status", "VmHWM"); }

size_t available_memory() { return proc_bytes("/proc/meminfo", "MemAvailable"); }

std::optional<double> find_number(const NamedNumbers& numbers, const std::string& name) {
  for (const auto& [key, value] : numbers)
    if (key == name) return value;
  return std::nullopt;
}

const BenchRow* find_row(const BenchResult& result, const std::string& work,
                         const NamedNumbers& parameters) {
  for (const BenchRow& row : result.rows)
    if (row.work == work && row.parameters == parameters) return &row;
  return nullptr;
}

std::vector<Series> time_series(const BenchResult& result, const std::vector<std::string>& works,
                                const std::string& x, const NamedNumbers& fixed) {
  std::vector<Series> all;
  for (const std::string& work : works) {
    Series series{work, {}};
    for (const BenchRow& row : result.rows)
      if (row.work == work && std::ranges::all_of(fixed, [&](const NamedNumber& parameter) {
            return find_number(row.parameters, parameter.name) == parameter.value;
          }))
        series.points.emplace_back(find_number(row.parameters, x).value_or(0), row.time.median_ms);
    if (!series.points.empty()) all.push_back(std::move(series));
  }
  return all;
}

Json numbers_json(const NamedNumbers& numbers) {
  Json json = Json::object();
  for (const auto& [name, value] : numbers) json[name] = value;
  return json;
}

Json bench_json(const BenchResult& result, const RunInfo& run) {
  Json json = {{"schema", "vpr.bench/3"}, {"bench", result.bench}, {"settings", result.settings}};
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
  require_schema(json, "bench", where, ErrorKind::data);
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
