// Which SIMD target the kernels run on. Results never depend on it.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace vpr {

/// Highway's names of the targets that this machine and this program have, best first.
std::vector<std::string> simd_targets();

/// All kernels of the process run on this target from now on; on the best one for an empty name.
/// (Highway keeps its choice for the whole process: call it before work starts.) Throws
/// Error(usage) listing the choices for a name that this machine or program does not have.
void use_simd_target(std::string_view name);

}  // namespace vpr
