// Provenance, machine and timing of JSON files. Files of two runs may differ in "machine" and
// "timing" only.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "base/json_fwd.h"
#include "base/provenance.h"
#include "recordings/sequence_source.h"

namespace vpr {

struct RunInfo {
  std::string program;
  std::vector<std::string> command_line;
  std::map<std::string, std::string> paths;  ///< from the command line, by role such as "query"
  std::map<std::string, std::string> images = {};  ///< images_checksum of their frames, by role
  std::string simd_target;                         ///< may be empty
  size_t threads = 0;
  size_t memory_limit = 0;  ///< bytes; 0: none
  uint64_t seed = 0;

  /// Empty: unknown.
  std::string path(const std::string& role) const;
};

/// The run of a program with the threads and the SIMD target of this process.
RunInfo run_of(const std::string& program, const std::vector<std::string>& command_line,
               uint64_t seed);

class Fields;

/// Adds the path of the query and the checksum of the names of its frames; nothing for an array in
/// memory.
void set_query_path(RunInfo& run, const SequenceArgument& query);

Provenance provenance_of(const RunInfo& run);
/// Without fingerprints of the data.
Json provenance_json(const RunInfo& run);

/// Host, SIMD target, threads, command line, paths and memory limit.
Json machine_json(const RunInfo& run);

/// The schema with "machine" and "timing".
Json with_run(Json schema, bool has_timing = true);

/// Reads the output of machine_json, except the host. Throws Error(data) for damage.
void read_machine(const Fields& fields, RunInfo& run);

/// Seconds by step, rounded to milliseconds.
Json timing_json(const std::map<std::string, double>& seconds);

void add_run(Json& json, const RunInfo& run, const std::map<std::string, double>& seconds);

}  // namespace vpr
