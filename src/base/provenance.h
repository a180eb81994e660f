// The version and commit of the programs, for the files that they write.
#pragma once

#include <cstdint>
#include <string>

namespace vpr {

/// The origin of a file.
struct Provenance {
  std::string program;
  std::string version;
  std::string commit;
  uint64_t seed = 0;
};

inline constexpr const char* kProvenanceText =
    "Origin of this file; depends on program, settings and data, not on the machine.";

template <class Visitor, class Program, class Version, class Commit>
void visit_origin(Visitor&& visit, Program&& program, Version&& version, Commit&& commit) {
  visit("program", program, "The program that wrote the file.");
  visit("version", version, "Version of the toolkit.");
  visit("commit", commit, "Commit of the build; -dirty: changed tree.");
}

template <class Visitor>
void visit_fields(Provenance& made_by, Visitor&& visit) {
  visit_origin(visit, made_by.program, made_by.version, made_by.commit);
  visit("seed", made_by.seed, "Seed of random choices.");
}

/// "0.1.0"
std::string program_version();

/// Short hash of the commit that was built, with "-dirty" if it was modified, or "unknown" outside
/// a repository.
std::string program_commit();

}  // namespace vpr
