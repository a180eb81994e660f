// The SIMD target of the kernels. Results do not depend on it.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace vpr {

/// Highway's names of the targets that both the machine and this build support, best first.
std::vector<std::string> simd_targets();

/// Highway's name of the target that the kernels run on.
std::string simd_target();

/// Runs all kernels of the process on this target; an empty name selects the best one. (Highway
/// keeps this choice globally: call it before work starts.) Throws Error(usage), which lists the
/// choices, for a name that the machine or this build does not support.
void use_simd_target(std::string_view name);

}  // namespace vpr
