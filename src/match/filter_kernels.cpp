// Compiled once per SIMD target: see Highway's foreach_target.h.
#include "match/filter_kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "match/filter_kernels.cpp"
#include <hwy/foreach_target.h>  // IWYU pragma: keep
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace vpr {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

// A vector with one cell per lane of the tag.
template <class Tag>
HWY_INLINE void StepCells(Tag d, const FilterStep& step, const float* likelihoods,
                          const ConstRateArrays& before, const RateArrays& after, float* masses,
                          size_t cell) {
  const auto likelihood = hn::LoadU(d, likelihoods + cell);
  hn::Vec<Tag> fresh[kRates];
  for (size_t r = 0; r < kRates; ++r) {
    const float* from = before[r] + cell - kFirstSteps[r];
    auto sum = hn::Mul(hn::Set(d, step.weights[r][0]), hn::LoadU(d, from));
    sum = hn::Add(sum, hn::Mul(hn::Set(d, step.weights[r][1]), hn::LoadU(d, from - 1)));
    sum = hn::Add(sum, hn::Mul(hn::Set(d, step.weights[r][2]), hn::LoadU(d, from - 2)));
    fresh[r] = hn::Mul(likelihood, hn::Add(sum, hn::Set(d, step.entering[r])));
  }
  auto mass = fresh[0];
  for (size_t r = 1; r < kRates; ++r) mass = hn::Add(mass, fresh[r]);
  hn::StoreU(mass, d, masses + cell);
  const auto stay = hn::Set(d, step.stay);
  for (size_t r = 0; r < kRates; ++r)
    hn::StoreU(hn::Add(hn::Mul(stay, fresh[r]), hn::Mul(hn::Set(d, step.change[r]), mass)), d,
               after[r] + cell);
}

void Step(const FilterStep& step, const float* likelihoods, const ConstRateArrays& before,
          const RateArrays& after, float* masses, size_t first, size_t count) {
  const hn::ScalableTag<float> many;
  const hn::CappedTag<float, 1> one;
  const size_t lanes = hn::Lanes(many);
  const size_t end = first + count;
  size_t cell = first;
  for (; cell + lanes <= end; cell += lanes)
    StepCells(many, step, likelihoods, before, after, masses, cell);
  for (; cell < end; ++cell) StepCells(one, step, likelihoods, before, after, masses, cell);
}

}  // namespace

FilterKernels Filters() { return {Step}; }

}  // namespace HWY_NAMESPACE
}  // namespace vpr
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace vpr {

HWY_EXPORT(Filters);

FilterKernels select_filter_kernels() { return HWY_DYNAMIC_DISPATCH(Filters)(); }

}  // namespace vpr

#endif  // HWY_ONCE
