#include "evaluation/score_matrix.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "base/checksum.h"
#include "base/error.h"
#include "base/parallel.h"

namespace vpr {
namespace {

constexpr size_t kBlockValues = size_t{1} << 21;  // keys of one block, 16 MiB
constexpr size_t kPieceBytes = size_t{16} << 20;  // of a file while its checksum is taken
constexpr int64_t kMostExact = int64_t{1} << 53;

/// IEEE 754's 16-bit format.
struct Half {
  uint16_t bits;
};

double number(Half half) {
  const int exponent = half.bits >> 10 & 31;
  const int fraction = half.bits & 1023;
  const double sign = half.bits >> 15 != 0 ? -1 : 1;
  if (exponent == 31)
    return fraction != 0 ? std::numeric_limits<double>::quiet_NaN()
                         : sign * std::numeric_limits<double>::infinity();
  return sign *
         (exponent == 0 ? std::ldexp(fraction, -24) : std::ldexp(1024 + fraction, exponent - 25));
}

template <class T>
double number(T value) {
  if constexpr (std::is_integral_v<T> && sizeof(T) == 8) {
    const bool exact =
        std::cmp_less_equal(value, kMostExact) && std::cmp_greater_equal(value, -kMostExact);
    if (!exact)
      throw Error(
          ErrorKind::data,
          "the scores hold integers beyond 2^53, which are not told apart as float64; scale "
          "them down first");
  }
  return static_cast<double>(value);
}

/// Values that lie side by side become every key_stride-th key, from the first.
template <class T>
void read_keys(const std::byte* values, std::span<uint64_t> keys, size_t key_stride,
               const ScoreFormat& format) {
  for (size_t i = 0, k = 0; k < keys.size(); ++i, k += key_stride) {
    T value;
    std::memcpy(&value, values + i * sizeof(T), sizeof(T));
    const double score = number(value);
    keys[k] = format.missing && score == *format.missing ? kNoScore : score_key(score, format.kind);
  }
}

size_t blocks_of(size_t count, size_t size) { return (count + size - 1) / size; }

}  // namespace

ScoreMatrix::ScoreMatrix(const std::filesystem::path& path, const ScoreFormat& format)
    : name_(path.string()), format_(format), array_(path) {
  static const std::vector<std::pair<std::string_view, Reader>> kReaders = {
      {"<f2", read_keys<Half>},     {"<f4", read_keys<float>},    {"<f8", read_keys<double>},
      {"|b1", read_keys<uint8_t>},  {"|u1", read_keys<uint8_t>},  {"|i1", read_keys<int8_t>},
      {"<u2", read_keys<uint16_t>}, {"<i2", read_keys<int16_t>},  {"<u4", read_keys<uint32_t>},
      {"<i4", read_keys<int32_t>},  {"<u8", read_keys<uint64_t>}, {"<i8", read_keys<int64_t>}};
  const auto found = std::find_if(kReaders.begin(), kReaders.end(),
                                  [&](const auto& row) { return row.first == array_.type(); });
  if (found == kReaders.end() || array_.shape().size() != 2)
    throw Error(
        ErrorKind::data,
        fmt::format("{}: expected a matrix (2 dimensions) of numbers, queries x references; "
                    "found {} dimensions of type {}",
                    name_, array_.shape().size(), array_.type()));
  reader_ = found->second;
  value_size_ = static_cast<size_t>(array_.type()[2] - '0');
  queries_ = array_.shape()[format.references_first ? 1 : 0];
  references_ = array_.shape()[format.references_first ? 0 : 1];
  query_major_ = array_.is_column_major() == format.references_first;
}

ScoreMatrix::ScoreMatrix(ComputedScores computed)
    : computed_(std::move(computed)),
      queries_(computed_.queries),
      references_(computed_.references) {}

void ScoreMatrix::compute_block(size_t first, size_t count, std::span<uint64_t> keys) const {
  std::vector<double> distances(count * references_);
  computed_.compute(first, count, distances);
  for (size_t i = 0; i < distances.size(); ++i) keys[i] = score_key(distances[i], kind());
}

void ScoreMatrix::read_block(size_t first, size_t count, std::span<uint64_t> keys) const {
  if (computed_.compute) return compute_block(first, count, keys);
  const std::byte* values = array_.value_bytes().data();
  if (query_major_) {
    for (size_t q = 0; q < count; ++q)
      reader_(values + (first + q) * references_ * value_size_,
              keys.subspan(q * references_, references_), 1, format_);
    return;
  }
  // Reference after reference: the block's queries lie side by side in each.
  for (size_t r = 0; r < references_; ++r)
    reader_(values + (r * queries_ + first) * value_size_,
            keys.subspan(r, (count - 1) * references_ + 1), references_, format_);
}

void ScoreMatrix::forget_block(size_t first, size_t count) const {
  if (computed_.compute) return;
  if (query_major_)
    array_.forget_values(first * references_ * value_size_, count * references_ * value_size_);
  else
    array_.forget_values(0, array_.value_bytes().size());
}

void ScoreMatrix::for_each_row(size_t workers, const Monitor& monitor, const std::string& step,
                               const RowBody& body) const {
  if (queries_ == 0) return;
  const size_t most = computed_.compute ? std::min(computed_.block, queries_) : queries_;
  const size_t block = std::clamp<size_t>(kBlockValues / std::max<size_t>(1, references_), 1, most);
  const size_t blocks = blocks_of(queries_, block);
  StepCounter counter(monitor, step, queries_);
  parallel_for(workers, monitor, [&](size_t worker) {
    std::vector<uint64_t> keys(block * references_);
    for (size_t b = worker; b < blocks; b += workers) {
      const size_t first = b * block;
      const size_t count = std::min(block, queries_ - first);
      if (references_ > 0) read_block(first, count, keys);
      for (size_t q = 0; q < count; ++q)
        body(worker, first + q, std::span(keys).subspan(q * references_, references_));
      forget_block(first, count);
      counter.add(count);
    }
  });
}

std::string ScoreMatrix::fingerprint(const Monitor& monitor) const {
  if (computed_.compute) return computed_.fingerprint(monitor);
  ChecksumStream sum;
  const auto bytes = array_.file_bytes();
  const size_t header = bytes.size() - array_.value_bytes().size();
  sum.add(bytes.first(header));
  for (size_t at = header; at < bytes.size(); at += kPieceBytes) {
    check_stop(monitor);
    const auto piece = bytes.subspan(at, std::min(kPieceBytes, bytes.size() - at));
    sum.add(piece);
    array_.forget_values(at - header, piece.size());
  }
  return sum.text();
}

}  // namespace vpr
