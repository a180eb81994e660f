// Compiled once per SIMD target: see Highway's foreach_target.h.
#include "match/score_kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "match/score_kernels.cpp"
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

// Adds a half before truncation: rounding to nearest, for any rounding mode of the target.
constexpr float kBiasAndHalf = kScoreBias + 0.5F;

#if HWY_TARGET == HWY_SCALAR
using ShortTag = hn::Rebind<int16_t, FloatTag>;
using HalfTag = ShortTag;
#else
using ShortTag = hn::Repartition<int16_t, FloatTag>;
using HalfTag = hn::Half<ShortTag>;
#endif
using ByteTag = hn::Rebind<int8_t, ShortTag>;

// A distance minus the common part of the row: the offset and, if kCommon, the components. It is a
// copy, so that the compiler keeps it in registers.
template <bool kCommon>
struct Row {
  const uint16_t* distances;
  float offset;
  ComponentTerm common;

  // The sums of component_product for twice as many training frames as there are lanes: products of
  // a loading times 256, in fixed point with 15 fractional bits.
  HWY_INLINE hn::Vec<ShortTag> Sums(size_t i) const {
    const ShortTag d;
    auto sum = hn::Zero(d);
    for (size_t k = 0; k < kMaxComponents; ++k) {
      const auto loading = hn::PromoteTo(d, hn::LoadU(ByteTag(), common.loadings[k] + i));
      sum = hn::Add(sum,
                    hn::MulFixedPoint15(hn::ShiftLeft<8>(loading), hn::Set(d, common.weights[k])));
    }
    return sum;
  }

  HWY_INLINE hn::Vec<FloatTag> Centered(size_t i) const {
    const FloatTag d;
    const auto whole = hn::PromoteTo(IntTag(), hn::LoadU(DistanceTag(), distances + i));
    return hn::Sub(hn::ConvertTo(d, whole), hn::Set(d, offset));
  }

  HWY_INLINE hn::Vec<FloatTag> Less(hn::Vec<FloatTag> centered, hn::Vec<HalfTag> sums) const {
    const FloatTag d;
    const auto whole = hn::ConvertTo(d, hn::PromoteTo(IntTag(), sums));
    return hn::Sub(centered, hn::Mul(whole, hn::Set(d, common.unit)));
  }

  // Calls body(i, row minus the common part) for one vector of training frames at a time; returns
  // the number of frames processed, at most `count`.
  template <class Body>
  HWY_INLINE size_t ForLanes([[maybe_unused]] size_t count,
                             [[maybe_unused]] const Body& body) const {
    [[maybe_unused]] const size_t lanes = hn::Lanes(FloatTag());
    size_t i = 0;
#if HWY_TARGET != HWY_SCALAR  // One processes all frames there
    for (; i + 2 * lanes <= count; i += 2 * lanes) {
      if constexpr (kCommon) {
        const auto sums = Sums(i);
        body(i, Less(Centered(i), hn::LowerHalf(HalfTag(), sums)));
        body(i + lanes, Less(Centered(i + lanes), hn::UpperHalf(HalfTag(), sums)));
      } else {
        body(i, Centered(i));
        body(i + lanes, Centered(i + lanes));
      }
    }
#endif
    return i;
  }

  HWY_INLINE float One(size_t i) const {
    const float centered = static_cast<float>(distances[i]) - offset;
    if constexpr (!kCommon) return centered;
    int sum = 0;
    for (size_t k = 0; k < kMaxComponents; ++k)
      sum += component_product(common.loadings[k][i], common.weights[k]);
    return centered - static_cast<float>(sum) * common.unit;
  }
};

template <bool kCommon>
HWY_INLINE void LearnRow(const Row<kCommon> row, float gain, float* HWY_RESTRICT mean,
                         float* HWY_RESTRICT variance, size_t count) {
  const FloatTag d;
  const float rest = 1 - gain;
  const auto gains = hn::Set(d, gain);
  const auto rests = hn::Set(d, rest);
  size_t i = row.ForLanes(count, [&](size_t at, hn::Vec<FloatTag> x) HWY_ATTR {
    const auto before = hn::LoadU(d, mean + at);
    const auto step = hn::Sub(x, before);
    hn::StoreU(hn::Add(before, hn::Mul(gains, step)), d, mean + at);
    const auto spread = hn::Add(hn::LoadU(d, variance + at), hn::Mul(gains, hn::Mul(step, step)));
    hn::StoreU(hn::Mul(rests, spread), d, variance + at);
  });
  for (; i < count; ++i) {
    const float step = row.One(i) - mean[i];
    mean[i] = mean[i] + gain * step;
    variance[i] = rest * (variance[i] + gain * (step * step));
  }
}

void Learn(const uint16_t* distances, float offset, const ComponentTerm& common, float gain,
           float* mean, float* variance, size_t count) {
  if (common.loadings[0] == nullptr)
    LearnRow(Row<false>{distances, offset, {}}, gain, mean, variance, count);
  else
    LearnRow(Row<true>{distances, offset, common}, gain, mean, variance, count);
}

template <bool kCommon>
HWY_INLINE void ZScoreRow(const Row<kCommon> row, const float* mean, const float* variance,
                          float least_variance, uint16_t* HWY_RESTRICT out, size_t count) {
  const FloatTag d;
  const auto least = hn::Set(d, least_variance);
  const auto unit = hn::Set(d, static_cast<float>(kScoreUnit));
  const auto bias = hn::Set(d, kBiasAndHalf);
  const auto zero = hn::Zero(d);
  const auto largest = hn::Set(d, kLargest);
  size_t i = row.ForLanes(count, [&](size_t at, hn::Vec<FloatTag> x) HWY_ATTR {
    const auto away = hn::Sub(x, hn::LoadU(d, mean + at));
    const auto spread = hn::Max(hn::LoadU(d, variance + at), least);
    const auto z = hn::Div(away, hn::Sqrt(spread));
    const auto biased = hn::Add(hn::Mul(z, unit), bias);
    const auto cut = hn::Min(hn::Max(biased, zero), largest);
    hn::StoreU(hn::DemoteTo(DistanceTag(), hn::ConvertTo(IntTag(), cut)), DistanceTag(), out + at);
  });
  for (; i < count; ++i) {
    const float away = row.One(i) - mean[i];
    const float spread = std::max(variance[i], least_variance);
    const float z = away / std::sqrt(spread);
    const float biased = z * static_cast<float>(kScoreUnit) + kBiasAndHalf;
    out[i] = static_cast<uint16_t>(std::min(std::max(biased, 0.0F), kLargest));
  }
}

void ToZScores(const uint16_t* distances, float offset, const ComponentTerm& common,
               const float* mean, const float* variance, float least_variance, uint16_t* out,
               size_t count) {
  if (common.loadings[0] == nullptr)
    ZScoreRow(Row<false>{distances, offset, {}}, mean, variance, least_variance, out, count);
  else
    ZScoreRow(Row<true>{distances, offset, common}, mean, variance, least_variance, out, count);
}

}  // namespace

ScoreKernels Scores() { return {Learn, ToZScores}; }

}  // namespace HWY_NAMESPACE
}  // namespace vpr
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace vpr {

HWY_EXPORT(Scores);

ScoreKernels select_score_kernels() { return HWY_DYNAMIC_DISPATCH(Scores)(); }

}  // namespace vpr

#endif  // HWY_ONCE
