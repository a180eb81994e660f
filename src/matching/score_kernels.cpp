// Compiled several times, once for each SIMD target: see Highway's foreach_target.h.
#include "base/highway.h"
// The settings above come first.
#include "matching/score_kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "matching/score_kernels.cpp"
#include <algorithm>
#include <cmath>

#include <hwy/foreach_target.h>  // IWYU pragma: keep
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace vpr {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

using FloatTag = hn::ScalableTag<float>;
using IntTag = hn::RebindToSigned<FloatTag>;
using DistanceTag = hn::Rebind<uint16_t, FloatTag>;

constexpr float kLargest = 65535;

// A half is added before the fraction is cut off: rounding to nearest, whatever the target's mode.
constexpr float kBiasAndHalf = kScoreBias + 0.5F;

HWY_INLINE auto Centred(const uint16_t* distances, hn::Vec<FloatTag> offset) {
  const FloatTag d;
  const auto whole = hn::PromoteTo(IntTag(), hn::LoadU(DistanceTag(), distances));
  return hn::Sub(hn::ConvertTo(d, whole), offset);
}

void Learn(const uint16_t* distances, float offset, float gain, float* mean, float* variance,
           size_t count) {
  const FloatTag d;
  const float rest = 1 - gain;
  const auto offsets = hn::Set(d, offset);
  const auto gains = hn::Set(d, gain);
  const auto rests = hn::Set(d, rest);
  const size_t lanes = hn::Lanes(d);
  size_t i = 0;
  for (; i + lanes <= count; i += lanes) {
    const auto before = hn::LoadU(d, mean + i);
    const auto step = hn::Sub(Centred(distances + i, offsets), before);
    hn::StoreU(hn::Add(before, hn::Mul(gains, step)), d, mean + i);
    const auto spread = hn::Add(hn::LoadU(d, variance + i), hn::Mul(gains, hn::Mul(step, step)));
    hn::StoreU(hn::Mul(rests, spread), d, variance + i);
  }
  for (; i < count; ++i) {
    const float step = static_cast<float>(distances[i]) - offset - mean[i];
    mean[i] = mean[i] + gain * step;
    variance[i] = rest * (variance[i] + gain * (step * step));
  }
}

void Standardize(const uint16_t* distances, float offset, const float* mean, const float* variance,
                 float least_variance, float most_variance, uint16_t* out, size_t count) {
  const FloatTag d;
  const auto offsets = hn::Set(d, offset);
  const auto least = hn::Set(d, least_variance);
  const auto most = hn::Set(d, most_variance);
  const auto unit = hn::Set(d, static_cast<float>(kScoreUnit));
  const auto bias = hn::Set(d, kBiasAndHalf);
  const auto zero = hn::Zero(d);
  const auto largest = hn::Set(d, kLargest);
  const size_t lanes = hn::Lanes(d);
  size_t i = 0;
  for (; i + lanes <= count; i += lanes) {
    const auto away = hn::Sub(Centred(distances + i, offsets), hn::LoadU(d, mean + i));
    const auto spread = hn::Min(hn::Max(hn::LoadU(d, variance + i), least), most);
    const auto z = hn::Div(away, hn::Sqrt(spread));
    const auto biased = hn::Add(hn::Mul(z, unit), bias);
    const auto cut = hn::Min(hn::Max(biased, zero), largest);
    hn::StoreU(hn::DemoteTo(DistanceTag(), hn::ConvertTo(IntTag(), cut)), DistanceTag(), out + i);
  }
  for (; i < count; ++i) {
    const float away = static_cast<float>(distances[i]) - offset - mean[i];
    const float spread = std::min(std::max(variance[i], least_variance), most_variance);
    const float z = away / std::sqrt(spread);
    const float biased = z * static_cast<float>(kScoreUnit) + kBiasAndHalf;
    out[i] = static_cast<uint16_t>(std::min(std::max(biased, 0.0F), kLargest));
  }
}

}  // namespace

ScoreKernels Scores() { return {Learn, Standardize}; }

}  // namespace HWY_NAMESPACE
}  // namespace vpr
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace vpr {

HWY_EXPORT(Scores);

ScoreKernels select_score_kernels() { return HWY_DYNAMIC_DISPATCH(Scores)(); }

}  // namespace vpr

#endif  // HWY_ONCE
