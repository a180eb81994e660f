// Compiled once per SIMD target: see Highway's foreach_target.h.
#include "base/exponentials.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "base/exponentials.cpp"
#include <hwy/foreach_target.h>  // IWYU pragma: keep
#include <hwy/highway.h>

#ifndef VPR_EXPONENTIALS_ONCE
#define VPR_EXPONENTIALS_ONCE
namespace vpr {
namespace {
constexpr size_t kGroup = 8;     // values per group, each with its own partial sum
constexpr double kLeast = -690;  // exp of anything smaller counts as 0
}  // namespace
}  // namespace vpr
#endif

HWY_BEFORE_NAMESPACE();
namespace vpr {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

using Tag = hn::CappedTag<double, kGroup>;
using Doubles = hn::Vec<Tag>;
constexpr size_t kLanes = hn::MaxLanes(Tag());
constexpr size_t kVectors = kGroup / kLanes;

// exp(x) for x in [kLeast, 0], 0 below: x = n ln 2 + r, with the Taylor series of exp(r) up to
// r^13, whose remainder is below 4e-18. No fused multiply-add: it would change the last digit on
// some targets.
HWY_INLINE Doubles Exp(Doubles x) {
  const Tag d;
  const hn::RebindToSigned<Tag> di;
  constexpr auto kInverseFactorials = [] {  // 1 / 13!, 1 / 12!, ..., 1 / 0!
    std::array<double, 14> inverse{};
    double factorial = 1;
    for (size_t k = 0; k < inverse.size(); factorial *= static_cast<double>(++k))
      inverse[13 - k] = 1 / factorial;
    return inverse;
  }();
  const auto too_small = hn::Lt(x, hn::Set(d, kLeast));
  const Doubles bounded = hn::Max(x, hn::Set(d, kLeast));
  const Doubles n = hn::Round(hn::Mul(bounded, hn::Set(d, 1.4426950408889634)));
  // ln 2 in two parts; the first is short enough that its product with n is exact.
  const Doubles r = hn::Sub(hn::Sub(bounded, hn::Mul(n, hn::Set(d, 6.93147180369123816490e-01))),
                            hn::Mul(n, hn::Set(d, 1.90821492927058770002e-10)));
  Doubles series = hn::Set(d, kInverseFactorials[0]);
  for (size_t k = 1; k < kInverseFactorials.size(); ++k)
    series = hn::Add(hn::Mul(series, r), hn::Set(d, kInverseFactorials[k]));
  const auto power = hn::ShiftLeft<52>(hn::Add(hn::ConvertTo(di, n), hn::Set(di, 1023)));
  return hn::IfThenZeroElse(too_small, hn::Mul(series, hn::BitCast(d, power)));
}

double Exponentiate(double* values, size_t count, double most) {
  const Tag d;
  const Doubles shift = hn::Set(d, most);
  Doubles sums[kVectors];
  for (Doubles& sum : sums) sum = hn::Zero(d);
  double last[kGroup];
  for (size_t i = 0; i < count; i += kGroup) {
    double* group = values + i;
    const size_t here = std::min(kGroup, count - i);
    if (here < kGroup) {
      std::fill_n(last, kGroup, -std::numeric_limits<double>::infinity());
      std::copy_n(values + i, here, last);
      group = last;
    }
    for (size_t v = 0; v < kVectors; ++v) {
      const Doubles p = Exp(hn::Sub(hn::LoadU(d, group + v * kLanes), shift));
      hn::StoreU(p, d, group + v * kLanes);
      sums[v] = hn::Add(sums[v], p);
    }
    if (here < kGroup) std::copy_n(last, here, values + i);
  }
  double sum = 0;
  for (size_t v = 0; v < kVectors; ++v) {
    double lanes[kLanes];
    hn::StoreU(sums[v], d, lanes);
    for (const double lane : lanes) sum += lane;
  }
  return sum;
}

double Largest(const double* values, size_t count) {
  const Tag d;
  Doubles most[kVectors];
  for (Doubles& vector : most) vector = hn::Set(d, -std::numeric_limits<double>::infinity());
  size_t i = 0;
  for (; i + kGroup <= count; i += kGroup)
    for (size_t v = 0; v < kVectors; ++v)
      most[v] = hn::Max(most[v], hn::LoadU(d, values + i + v * kLanes));
  double largest = -std::numeric_limits<double>::infinity();
  for (const Doubles& vector : most)
    largest = std::max(largest, hn::GetLane(hn::MaxOfLanes(d, vector)));
  for (; i < count; ++i) largest = std::max(largest, values[i]);
  return largest;
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace vpr
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace vpr {

HWY_EXPORT(Exponentiate);
HWY_EXPORT(Largest);

double exponentiate(std::span<double> values) {
  assert(!values.empty());
  const double most = HWY_DYNAMIC_DISPATCH(Largest)(values.data(), values.size());
  return HWY_DYNAMIC_DISPATCH(Exponentiate)(values.data(), values.size(), most);
}

// x = 2^n m with m from 0.5 to 2; ln m = ln((1 + y) / (1 - y)) = 2 (y + y^3 / 3 + y^5 / 5 ...),
// |y| <= 1/3.
double natural_logarithm(double x) {
  assert(x > 0 && std::isfinite(x));
  int n = 0;
  for (; x > 2; x /= 2) ++n;
  for (; x < 0.5; x *= 2) --n;
  const double y = (x - 1) / (x + 1);
  double power = y;
  double sum = 0;
  for (int k = 1; k <= 35; k += 2) {
    sum += power / k;
    power *= y * y;
  }
  return 2 * sum + n * std::numbers::ln2;
}

}  // namespace vpr

#endif  // HWY_ONCE
