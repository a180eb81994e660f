// The version and commit of the programs, for the files that they write.
#pragma once

#include <string>

namespace vpr {

/// "0.1.0"
std::string program_version();

/// Short hash of the commit that was built, with "-dirty" if it was modified, or "unknown" outside
/// a repository.
std::string program_commit();

}  // namespace vpr
