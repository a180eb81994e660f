// Scalar products of bytes with AVX-512's VNNI: a part of cosine_kernels.cpp, inside its namespaces
// and only for its target AVX3_DL. It is included once, so it has no guard.

using Bytes = hn::Vec<hn::CappedTag<int8_t, 64>>;

/// A query vector in bytes, for rows of bytes.
struct ByteQuery {
  const int8_t* numbers = nullptr;
  uint32_t surplus = 0;  ///< what adding 128 to every value of a row adds to the product
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

// Adds 128 to the rows to make them unsigned, and subtracts the surplus from the product, modulo
// 2^32.
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
      const Bytes from_query = LoadBytes(queries[q].numbers + i, length - i);
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
