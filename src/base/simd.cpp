#include "base/simd.h"

#include <algorithm>
#include <cstdint>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <hwy/highway.h>

#include "base/error.h"

namespace vpr {
namespace {

// Highway's bits of the targets; a lower value is a better target.
const std::vector<int64_t>& target_bits() {
  static const std::vector<int64_t> kBits = [] {
    std::vector<int64_t> bits = hwy::SupportedAndGeneratedTargets();
    std::ranges::sort(bits);
    return bits;
  }();
  return kBits;
}

}  // namespace

std::vector<std::string> simd_targets() {
  std::vector<std::string> names;
  for (const int64_t bit : target_bits()) names.emplace_back(hwy::TargetName(bit));
  return names;
}

std::string simd_target() {
  const auto bit = std::ranges::find_if(
      target_bits(), [](int64_t target) { return (hwy::SupportedTargets() & target) != 0; });
  return hwy::TargetName(*bit);
}

void use_simd_target(std::string_view name) {
  for (const int64_t bit : target_bits()) {
    if (!name.empty() && name != hwy::TargetName(bit)) continue;
    hwy::SetSupportedTargetsForTest(name.empty() ? 0 : bit);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    return;
  }
  throw Error(ErrorKind::usage,
              "VPR_SIMD={}: is not a SIMD target of this machine; choose one of {}", name,
              fmt::join(simd_targets(), ", "));
}

}  // namespace vpr
