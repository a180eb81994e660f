#include "bench/bench_result.h"

#include <algorithm>
#include <cmath>
#include <fstream>

#include <sched.h>

#include "base/error.h"
#include "base/json_schema.h"
#include "base/statistics.h"
#include "base/stopwatch.h"
#include "bench/benches.h"

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

}  // namespace

VPR_FIELDS(TimeSummary, (median_ms, "Median, in milliseconds.", at_least(0)),
           (lower_quartile_ms, "Lower quartile, in milliseconds.", at_least(0)),
           (upper_quartile_ms, "Upper quartile, in milliseconds.", at_least(0)),
           (least_ms, "Shortest, in milliseconds.", at_least(0)),
           (most_ms, "Longest, in milliseconds.", at_least(0)),
           (repetitions, "Times measured.", at_least(1)))

template <class Visitor>
void visit_fields(BenchRow& row, Visitor&& visit) {
  visit("work", row.work, "A method, feature or step.");
  visit("parameters", numbers_field(row.parameters), "Names of the row.", kAs<NumbersByName>);
  visit("per", row.per, "Unit of work of one time: query frame, tree.");
  visit_fields(row.time, visit);
  visit("values", numbers_field(row.values), "Other measurements: fps, recall.",
        kAs<NumbersByName>);
  visit("note", row.note, "Remark, as in 12 rows sampled; may be empty.");
}

template <class Visitor>
void visit_fields(BenchResult& result, Visitor&& visit) {
  visit("schema", Derived{schema_name("bench")});
  visit("bench", result.bench, "Benchmark.");
  visit("settings", Derived{result.settings},
        "Settings that can change the numbers; keys are the names of flags.",
        kAs<InForce<MatchingBenchSettings>, InForce<DescribeBenchSettings>,
            InForce<FabmapBenchSettings>, InForce<RealtimeBenchSettings>,
            InForce<TrainingBenchSettings>>);
  visit("rows", result.rows, "Measurements.");
  visit("left_out", result.left_out, "Omitted measurements, with the reason.");
}

TimeSummary summarize(std::vector<double> times_ms) {
  std::sort(times_ms.begin(), times_ms.end());
  return {median(times_ms), quantile(times_ms, 0.25), quantile(times_ms, 0.75),
          times_ms.front(), times_ms.back(),          times_ms.size()};
}

void check_seconds(double seconds) {
  if (!(seconds > 0 && seconds <= 3600))
    throw Error(ErrorKind::usage, "seconds must be above 0 and at most 3600, found {}", seconds);
}

void check_values(std::string_view name, const std::vector<uint64_t>& values, uint64_t low,
                  uint64_t high) {
  if (values.empty()) throw Error(ErrorKind::usage, "{} is empty", name);
  for (const uint64_t value : values)
    require_range(name, static_cast<double>(value), static_cast<double>(low),
                  static_cast<double>(high));
}

TimeSummary time_repeatedly(const Effort& effort, const std::function<void()>& work,
                            const Monitor& monitor, double units) {
  check_stop(monitor);
  work();
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

Json bench_json(const BenchResult& result, const RunInfo& run) {
  Json json = value_to_json(result, kDataForm);
  json["provenance"] = provenance_json(run);
  json["machine"] = machine_json(run);
  return json;
}

Json bench_schema() {
  SchemaVisitor visit{SchemaForm::data, schema_of<BenchResult>()};
  visit("provenance", Provenance(), kProvenanceText);
  return with_run(visit.object, false);
}

BenchResult read_bench(const std::filesystem::path& path) {
  const std::string where = path.string();
  const Json json = read_json(path, ErrorKind::data);
  require_schema(json, "bench", where, ErrorKind::data);
  BenchResult result;
  const JsonSource source{where};
  value_from_json(json, result, source, "the file");
  for (const BenchRow& row : result.rows) {
    const TimeSummary& time = row.time;
    for (const double ms : {time.median_ms, time.lower_quartile_ms, time.upper_quartile_ms,
                            time.least_ms, time.most_ms})
      if (!(ms >= 0 && std::isfinite(ms))) source.fail("a time is out of range");
  }
  return result;
}

}  // namespace vpr
