#include "query/run_info.h"

#include <array>
#include <cmath>

#include <unistd.h>

#include "base/json.h"
#include "base/json_schema.h"
#include "base/parallel.h"
#include "base/provenance.h"
#include "base/simd.h"

namespace vpr {
namespace {

std::string host_name() {
  std::array<char, 256> name{};
  return ::gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "unknown";
}

/// "machine" of a file.
struct Machine {
  RunInfo& run;
};

template <class Visitor>
void visit_fields(Machine& machine, Visitor&& visit) {
  RunInfo& run = machine.run;
  visit("host", Derived{host_name()}, "Name of the machine.");
  visit("threads", run.threads, "Threads that were used.");
  visit("simd", Unless{run.simd_target, {}}, "Instruction set of the kernels, as in AVX2.");
  visit("memory_limit", Unless{run.memory_limit, {}}, "Bytes (--max-memory).");
  visit("command_line", run.command_line, "Words of the command line.");
  visit("paths", run.paths, "Paths by role.");
  visit("images", Unless{run.images, {}},
        "Checksums of the names and sizes of images or of a video and of some contents, by the "
        "role of their path.");
}

}  // namespace

RunInfo run_of(const std::string& program, const std::vector<std::string>& command_line,
               uint64_t seed) {
  return {program, command_line, {}, {}, simd_target(), thread_count(), 0, seed};
}

std::string RunInfo::path(const std::string& role) const {
  const auto found = paths.find(role);
  return found == paths.end() ? std::string() : found->second;
}

void set_query_path(RunInfo& run, const SequenceArgument& query) {
  if (query.array) return;
  run.paths["query"] = argument_text(query);
  const std::string images = images_checksum(open_sequence({query.path, query.range}));
  if (!images.empty()) run.images["query"] = images;
}

Provenance provenance_of(const RunInfo& run) {
  return {run.program, program_version(), program_commit(), run.seed};
}

Json provenance_json(const RunInfo& run) { return value_to_json(provenance_of(run)); }

Json machine_json(const RunInfo& run) {
  RunInfo copy = run;
  return value_to_json(Machine{copy}, kDataForm);
}

Json with_run(Json schema, bool has_timing) {
  RunInfo run;
  Machine machine{run};
  SchemaVisitor visit{SchemaForm::data, std::move(schema)};
  visit("machine", machine, "Values that may differ between two runs with equal results.");
  if (has_timing) visit("timing", std::map<std::string, double>(), "Seconds by step.");
  return visit.object;
}

void read_machine(const Fields& fields, RunInfo& run) {
  Machine machine{run};
  value_from_json(fields.json(), machine, fields.source(), "machine");
}

Json timing_json(const std::map<std::string, double>& seconds) {
  Json json = Json::object();
  for (const auto& [step, value] : seconds) json[step + "_s"] = std::round(value * 1e3) / 1e3;
  return json;
}

void add_run(Json& json, const RunInfo& run, const std::map<std::string, double>& seconds) {
  json["machine"] = machine_json(run);
  json["timing"] = timing_json(seconds);
}

}  // namespace vpr
