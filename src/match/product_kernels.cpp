// Compiled once per SIMD target: see Highway's foreach_target.h.
#include "match/product_kernels.h"

#include <algorithm>
#include <array>
#include <vector>

#include <hwy/cache_control.h>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "match/product_kernels.cpp"
#include <hwy/foreach_target.h>  // IWYU pragma: keep
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace vpr {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

constexpr size_t kPart = 64;     // rows whose products are buffered
constexpr size_t kTogether = 4;  // queries that share rows in registers
constexpr size_t kRows = 4;      // rows whose sums are computed together
static_assert(kPart % kProductRows == 0 && kProductRows % kRows == 0);

#if HWY_TARGET == HWY_SCALAR  // one lane, without sums of pairs

template <class T>
int32_t Product(const int16_t* a, const T* b, size_t length) {
  int32_t sum = 0;
  for (size_t i = 0; i < length; ++i) sum += int32_t{a[i]} * b[i];
  return sum;
}

template <class T>
void RowProducts(const ProductQuery& query, const T* rows, size_t length, int32_t* out) {
  for (size_t r = 0; r < kRows; ++r) out[r] = Product(query.values, rows + r * length, length);
}

template <class T>
void BlockProducts(const ProductQuery* queries, const T* rows, size_t length, int32_t* out) {
  for (size_t q = 0; q < kTogether; ++q)
    for (size_t r = 0; r < kRows; ++r)
      out[q * kPart + r] = Product(queries[q].values, rows + r * length, length);
}

#else

using ValueTag = hn::CappedTag<int16_t, kProductValues>;
using SumTag = hn::RepartitionToWide<ValueTag>;
using ByteTag = hn::Rebind<int8_t, ValueTag>;
using Values = hn::Vec<ValueTag>;
using Sums = hn::Vec<SumTag>;

HWY_INLINE Values Load(const int16_t* from) { return hn::LoadU(ValueTag(), from); }
HWY_INLINE Values Load(const int8_t* from) {
  return hn::PromoteTo(ValueTag(), hn::LoadU(ByteTag(), from));
}

#if HWY_HAVE_SCALABLE  // an unknown number of lanes, so each sum is computed separately

HWY_INLINE void StoreTotals(Sums a, Sums b, Sums c, Sums d, int32_t* out) {
  const SumTag tag;
  out[0] = hn::GetLane(hn::SumOfLanes(tag, a));
  out[1] = hn::GetLane(hn::SumOfLanes(tag, b));
  out[2] = hn::GetLane(hn::SumOfLanes(tag, c));
  out[3] = hn::GetLane(hn::SumOfLanes(tag, d));
}

#else

// Adds the upper half of the lanes to the lower half until four are left.
template <class Tag, class V>
HWY_INLINE void StoreFolded(Tag tag, V sums, int32_t* out) {
  if constexpr (hn::MaxLanes(tag) <= 4) {
    hn::StoreU(sums, tag, out);
  } else {
    const hn::Half<Tag> half;
    StoreFolded(half, hn::Add(hn::LowerHalf(half, sums), hn::UpperHalf(half, sums)), out);
  }
}

// The sums of the lanes of each of four vectors with at least four lanes, transposed during the
// additions in blocks of four lanes.
HWY_INLINE void StoreTotals(Sums a, Sums b, Sums c, Sums d, int32_t* HWY_RESTRICT out) {
  const SumTag tag;
  const hn::RepartitionToWide<SumTag> wide;
  const auto ab = hn::Add(hn::InterleaveLower(tag, a, b), hn::InterleaveUpper(tag, a, b));
  const auto cd = hn::Add(hn::InterleaveLower(tag, c, d), hn::InterleaveUpper(tag, c, d));
  const auto low = hn::InterleaveLower(wide, hn::BitCast(wide, ab), hn::BitCast(wide, cd));
  const auto high = hn::InterleaveUpper(wide, hn::BitCast(wide, ab), hn::BitCast(wide, cd));
  StoreFolded(tag, hn::Add(hn::BitCast(tag, low), hn::BitCast(tag, high)), out);
}

#endif

// Hardware prefetchers do not recognize four parallel rows: each step of kStep values per row
// prefetches the same amount in the order of memory, four rows or 8192 bytes ahead.
template <size_t kStep, class T>
HWY_INLINE void FetchAhead(const T* HWY_RESTRICT rows, size_t i, size_t length) {
  const T* ahead = rows + std::max(4 * length, 8192 / sizeof(T)) + 4 * i;
  HWY_UNROLL(4)
  for (size_t r = 0; r < 4; ++r) hwy::Prefetch(ahead + r * kStep);
}

// A few queries and four rows: each loaded value is used in several products.
template <size_t kQueries, class T>
HWY_INLINE void SomeProducts(const ProductQuery* HWY_RESTRICT queries, const T* HWY_RESTRICT rows,
                             size_t length, int32_t* HWY_RESTRICT out) {
  const SumTag d;
  Sums even[kQueries][4];
  Sums odd[kQueries][4];
  HWY_UNROLL(4)
  for (size_t q = 0; q < kQueries; ++q) {
    HWY_UNROLL(4)
    for (size_t r = 0; r < 4; ++r) even[q][r] = odd[q][r] = hn::Zero(d);
  }
  for (size_t i = 0; i < length; i += hn::Lanes(ValueTag())) {
    if constexpr (kQueries == 1) FetchAhead<hn::MaxLanes(ValueTag())>(rows, i, length);
    const Values row[4] = {Load(rows + i), Load(rows + length + i), Load(rows + 2 * length + i),
                           Load(rows + 3 * length + i)};
    HWY_UNROLL(4)
    for (size_t q = 0; q < kQueries; ++q) {
      const Values from_query = Load(queries[q].values + i);
      HWY_UNROLL(4)
      for (size_t r = 0; r < 4; ++r)
        even[q][r] = hn::ReorderWidenMulAccumulate(d, row[r], from_query, even[q][r], odd[q][r]);
    }
  }
  HWY_UNROLL(4)
  for (size_t q = 0; q < kQueries; ++q)
    StoreTotals(hn::Add(even[q][0], odd[q][0]), hn::Add(even[q][1], odd[q][1]),
                hn::Add(even[q][2], odd[q][2]), hn::Add(even[q][3], odd[q][3]), out + q * kPart);
}

template <class T>
HWY_INLINE void RowProducts(const ProductQuery& query, const T* HWY_RESTRICT rows, size_t length,
                            int32_t* HWY_RESTRICT out) {
  SomeProducts<1>(&query, rows, length, out);
}

// Sixteen sums fit the registers of AVX-512, eight those of other targets.
template <class T>
HWY_INLINE void BlockProducts(const ProductQuery* HWY_RESTRICT queries, const T* HWY_RESTRICT rows,
                              size_t length, int32_t* HWY_RESTRICT out) {
#if HWY_TARGET <= HWY_AVX3
  SomeProducts<4>(queries, rows, length, out);
#else
  SomeProducts<2>(queries, rows, length, out);
  SomeProducts<2>(queries + 2, rows, length, out + 2 * kPart);
#endif
}

#endif

#if HWY_TARGET == HWY_AVX3_DL  // scalar products of bytes with VNNI

using Bytes = hn::Vec<hn::CappedTag<int8_t, 64>>;

/// A query vector in bytes, for rows of bytes.
struct ByteQuery {
  const int8_t* values = nullptr;
  uint32_t surplus = 0;  ///< 128 times the sum of its values
  double size = 0;
};

HWY_INLINE Bytes LoadBytes(const int8_t* from, size_t left) {
  const hn::CappedTag<int8_t, 64> d;
  return left >= hn::Lanes(d) ? hn::LoadU(d, from) : hn::MaskedLoad(hn::FirstN(d, left), d, from);
}

// Adds four products of unsigned and signed bytes to each sum: an AVX-512 instruction that this
// target has but Highway does not expose. Sums wrap.
HWY_INLINE void AddProducts(Sums& sums, Bytes without_sign, Bytes with_sign) {
  asm("vpdpbusd %2, %1, %0" : "+v"(sums.raw) : "v"(without_sign.raw), "v"(with_sign.raw));
}

// Adds 128 to the values of rows to make them unsigned, and subtracts the query's surplus from the
// products, modulo 2^32.
template <size_t kQueries>
HWY_INLINE void ByteProducts(const ByteQuery* HWY_RESTRICT queries, const int8_t* HWY_RESTRICT rows,
                             size_t length, int32_t* HWY_RESTRICT out) {
  const hn::CappedTag<int8_t, 64> bytes;
  const Bytes raised = hn::Set(bytes, static_cast<int8_t>(-128));
  Sums sums[kQueries][4];
  HWY_UNROLL(4)
  for (size_t q = 0; q < kQueries; ++q) {
    HWY_UNROLL(4)
    for (size_t r = 0; r < 4; ++r) sums[q][r] = hn::Zero(SumTag());
  }
  for (size_t i = 0; i < length; i += hn::Lanes(bytes)) {
    if constexpr (kQueries == 1)
      FetchAhead<hn::MaxLanes(hn::CappedTag<int8_t, 64>())>(rows, i, length);
    Bytes row[4];
    HWY_UNROLL(4)
    for (size_t r = 0; r < 4; ++r)
      row[r] = hn::Xor(LoadBytes(rows + r * length + i, length - i), raised);
    HWY_UNROLL(4)
    for (size_t q = 0; q < kQueries; ++q) {
      const Bytes from_query = LoadBytes(queries[q].values + i, length - i);
      HWY_UNROLL(4)
      for (size_t r = 0; r < 4; ++r) AddProducts(sums[q][r], row[r], from_query);
    }
  }
  for (size_t q = 0; q < kQueries; ++q) {
    StoreTotals(sums[q][0], sums[q][1], sums[q][2], sums[q][3], out + q * kPart);
    for (size_t r = 0; r < 4; ++r)
      out[q * kPart + r] =
          static_cast<int32_t>(static_cast<uint32_t>(out[q * kPart + r]) - queries[q].surplus);
  }
}

HWY_INLINE void RowProducts(const ByteQuery& query, const int8_t* HWY_RESTRICT rows, size_t length,
                            int32_t* HWY_RESTRICT out) {
  ByteProducts<1>(&query, rows, length, out);
}

HWY_INLINE void BlockProducts(const ByteQuery* HWY_RESTRICT queries,
                              const int8_t* HWY_RESTRICT rows, size_t length,
                              int32_t* HWY_RESTRICT out) {
  ByteProducts<kTogether>(queries, rows, length, out);
}

#endif

// Each of the few operations is rounded according to IEEE 754: the same on every machine. A vector
// of zeros is orthogonal to all others.
void CosineDistances(const int32_t* HWY_RESTRICT products, const double* HWY_RESTRICT norms,
                     double query_norm, size_t count, uint16_t* HWY_RESTRICT out) {
  const hn::CappedTag<double, kProductRows> d;
  const hn::Rebind<int32_t, decltype(d)> d32;
  const hn::Rebind<uint16_t, decltype(d)> d16;
  const auto half = hn::Set(d, 65535.0 / 2);
  for (size_t i = 0; i < count; i += hn::Lanes(d)) {
    const auto lengths = hn::Mul(hn::Set(d, query_norm), hn::LoadU(d, norms + i));
    const auto product = hn::PromoteTo(d, hn::LoadU(d32, products + i));
    const auto cosine = hn::IfThenElseZero(hn::Gt(lengths, hn::Zero(d)), hn::Div(product, lengths));
    const auto distance = hn::Mul(hn::Sub(hn::Set(d, 1), cosine), half);
    const auto rounded =
        hn::Min(hn::Max(hn::Add(distance, hn::Set(d, 0.5)), hn::Zero(d)), hn::Set(d, 65535.0));
    hn::StoreU(hn::DemoteTo(d16, hn::DemoteTo(d32, rounded)), d16, out + i);
  }
}

// |a - b|^2 = |a|^2 + |b|^2 - 2 ab, integers below 2^33, which double represents exactly.
void PointDistances(const int32_t* HWY_RESTRICT products, const double* HWY_RESTRICT squares,
                    double query_square, size_t count, uint16_t* HWY_RESTRICT out) {
  const hn::CappedTag<double, kProductRows> d;
  const hn::Rebind<int32_t, decltype(d)> d32;
  const hn::Rebind<uint16_t, decltype(d)> d16;
  for (size_t i = 0; i < count; i += hn::Lanes(d)) {
    const auto product = hn::PromoteTo(d, hn::LoadU(d32, products + i));
    const auto both = hn::Add(hn::Set(d, query_square), hn::LoadU(d, squares + i));
    const auto square = hn::Sub(both, hn::Add(product, product));
    const auto rounded = hn::Min(hn::Add(hn::Sqrt(square), hn::Set(d, 0.5)), hn::Set(d, 65535.0));
    hn::StoreU(hn::DemoteTo(d16, hn::DemoteTo(d32, rounded)), d16, out + i);
  }
}

/// Converts products to distances, with the sizes of the rows and of the query.
using Finish = void (*)(const int32_t* products, const double* sizes, double query_size,
                        size_t count, uint16_t* out);

template <class T, Finish finish, class Query>
void TileOf(std::span<const Query> queries, const ProductRows<T>& rows, uint16_t* out,
            size_t stride) {
  std::array<int32_t, kTogether * kPart> products;
  for (size_t part = 0; part < rows.count; part += kPart) {
    const T* values = rows.values + part * rows.length;
    const size_t count = std::min(kPart, rows.count - part);
    for (size_t t = 0; t < queries.size(); t += kTogether) {
      const size_t together = std::min(kTogether, queries.size() - t);
      if (together == kTogether)
        for (size_t i = 0; i < count; i += kRows)
          BlockProducts(queries.data() + t, values + i * rows.length, rows.length,
                        products.data() + i);
      else
        for (size_t q = 0; q < together; ++q)
          for (size_t i = 0; i < count; i += kRows)
            RowProducts(queries[t + q], values + i * rows.length, rows.length,
                        products.data() + q * kPart + i);
      for (size_t q = 0; q < together; ++q)
        finish(products.data() + q * kPart, rows.sizes + part, queries[t + q].size, count,
               out + (t + q) * stride + part);
    }
  }
}

template <class T, Finish finish>
void Tile(std::span<const ProductQuery> queries, const ProductRows<T>& rows, uint16_t* out,
          size_t stride) {
  TileOf<T, finish>(queries, rows, out, stride);
}

#if HWY_TARGET == HWY_AVX3_DL

void ByteTile(std::span<const ProductQuery> queries, const ProductRows<int8_t>& rows, uint16_t* out,
              size_t stride) {
  std::vector<int8_t> values(queries.size() * rows.length);
  std::vector<ByteQuery> narrow;
  for (const ProductQuery& query : queries) {
    int8_t* to = values.data() + narrow.size() * rows.length;
    int64_t sum = 0;
    for (size_t i = 0; i < rows.length; ++i) {
      to[i] = static_cast<int8_t>(query.values[i]);
      sum += to[i];
    }
    narrow.push_back({to, static_cast<uint32_t>(128 * sum), query.size});
  }
  TileOf<int8_t, CosineDistances>(std::span<const ByteQuery>(narrow), rows, out, stride);
}

#endif

}  // namespace

#if HWY_TARGET == HWY_AVX3_DL
ProductKernel<int8_t> Cosines() {
  return __builtin_cpu_supports("avx512vnni") ? ByteTile : Tile<int8_t, CosineDistances>;
}
#else
ProductKernel<int8_t> Cosines() { return Tile<int8_t, CosineDistances>; }
#endif
ProductKernel<int16_t> WideCosines() { return Tile<int16_t, CosineDistances>; }
ProductKernel<int16_t> Points() { return Tile<int16_t, PointDistances>; }

}  // namespace HWY_NAMESPACE
}  // namespace vpr
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace vpr {

HWY_EXPORT(Cosines);
HWY_EXPORT(WideCosines);
HWY_EXPORT(Points);

template <>
ProductKernel<int8_t> select_cosine_kernel() {
  return HWY_DYNAMIC_DISPATCH(Cosines)();
}
template <>
ProductKernel<int16_t> select_cosine_kernel() {
  return HWY_DYNAMIC_DISPATCH(WideCosines)();
}
ProductKernel<int16_t> select_point_kernel() { return HWY_DYNAMIC_DISPATCH(Points)(); }

}  // namespace vpr

#endif  // HWY_ONCE
