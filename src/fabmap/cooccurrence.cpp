// Compiled once per SIMD target: see Highway's foreach_target.h.
#include "base/highway.h"
// The settings above must come first.
#include <bit>

#include "fabmap/cooccurrence.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "fabmap/cooccurrence.cpp"
#include <hwy/foreach_target.h>  // IWYU pragma: keep
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace vpr {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

void CountBothWithAll(const WordColumns& columns, size_t word, uint32_t* out) {
  const hn::CappedTag<uint64_t, kColumnLanes / 2> d;
  const hn::Rebind<uint32_t, decltype(d)> d32;
  const size_t lanes = hn::Lanes(d);
  std::vector<uint64_t> own(columns.chunks);
  for (size_t chunk = 0; chunk < own.size(); ++chunk)
    own[chunk] = columns.bits[columns.at(chunk, word)];
  for (size_t v = 0; v < columns.padded_words; v += 2 * lanes) {
    auto first = hn::Zero(d);
    auto second = hn::Zero(d);
    const uint64_t* bits = columns.bits.data() + columns.at(0, v);
    for (size_t chunk = 0; chunk < own.size(); ++chunk, bits += kColumnLanes) {
      const auto mine = hn::Set(d, own[chunk]);
      first = hn::Add(first, hn::PopulationCount(hn::And(mine, hn::LoadU(d, bits))));
      second = hn::Add(second, hn::PopulationCount(hn::And(mine, hn::LoadU(d, bits + lanes))));
    }
    hn::StoreU(hn::TruncateTo(d32, first), d32, out + v);
    hn::StoreU(hn::TruncateTo(d32, second), d32, out + v + lanes);
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace vpr
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace vpr {

HWY_EXPORT(CountBothWithAll);

WordColumns make_word_columns(std::span<const WordSet> frames, size_t words) {
  WordColumns columns;
  columns.chunks = (frames.size() + 63) / 64;
  columns.padded_words = (words + kColumnLanes - 1) / kColumnLanes * kColumnLanes;
  columns.bits.assign(columns.chunks * columns.padded_words, 0);
  for (size_t f = 0; f < frames.size(); ++f)
    for (const uint32_t word : frames[f])
      columns.bits[columns.at(f / 64, word)] |= uint64_t{1} << f % 64;
  return columns;
}

size_t count_both(const WordColumns& columns, size_t a, size_t b) {
  size_t both = 0;
  for (size_t chunk = 0; chunk < columns.chunks; ++chunk)
    both += static_cast<size_t>(
        std::popcount(columns.bits[columns.at(chunk, a)] & columns.bits[columns.at(chunk, b)]));
  return both;
}

void count_both_with_all(const WordColumns& columns, size_t word, uint32_t* out) {
  HWY_DYNAMIC_DISPATCH(CountBothWithAll)(columns, word, out);
}

}  // namespace vpr

#endif  // HWY_ONCE
