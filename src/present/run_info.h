// Who made a file, and on what machine: the only parts of a JSON file that may differ between two
// runs are its "machine" and "timing".
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "base/json_fwd.h"

namespace vpr {

/// What a program knows about its run.
struct RunInfo {
  std::string program;
  std::vector<std::string> command_line;
  std::map<std::string, std::string> paths;  ///< as given: role ("query", "database") to path
  std::string simd_target;                   ///< empty where none matters
  size_t threads = 0;
  size_t memory_limit = 0;  ///< bytes; 0: none
  uint64_t seed = 0;
};

/// The program that made a file.
struct Provenance {
  std::string program;
  std::string version;
  std::string commit;
  uint64_t seed = 0;
};

template <class Visitor>
void visit_fields(Provenance& provenance, Visitor&& visit) {
  visit("program", provenance.program);
  visit("version", provenance.version);
  visit("commit", provenance.commit);
  visit("seed", provenance.seed);
}

Provenance provenance_of(const RunInfo& run);
/// The same as JSON; the caller adds fingerprints of the data.
Json provenance_json(const RunInfo& run);

/// host, SIMD target, threads, command line, paths, memory limit.
Json machine_json(const RunInfo& run);

/// Seconds by step, to the millisecond.
Json timing_json(const std::map<std::string, double>& seconds);

}  // namespace vpr
