// Which program made a file.
#pragma once

#include <string>

namespace vpr {

/// "0.1.0"
std::string program_version();

/// Short hash of the commit that was built, "-dirty" appended, or "unknown" outside a repository.
std::string program_commit();

}  // namespace vpr
