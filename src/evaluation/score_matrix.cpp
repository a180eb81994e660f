#include "evaluation/score_matrix.h"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/checksum.h"
#include "base/error.h"
#include "base/npy_numbers.h"
#include "base/parallel.h"

namespace vpr {
namespace {

constexpr size_t kBlockValues = size_t{1} << 21;  // keys of one block, 16 MiB
constexpr size_t kPieceValues = 512;              // read at once
constexpr size_t kPieceBytes = size_t{16} << 20;  // of a file while its checksum is taken

// Scores that lie side by side become keys that are `key_stride` apart.
void read_keys(const NumberType& type, const std::byte* values, size_t count, uint64_t* keys,
               size_t key_stride, const ScoreFormat& format) {
  std::array<double, kPieceValues> scores;
  for (size_t first = 0; first < count; first += kPieceValues) {
    const size_t piece = std::min(kPieceValues, count - first);
    type.read(values + first * type.bytes, type.bytes, piece, scores.data(), 1);
    for (size_t i = 0; i < piece; ++i)
      keys[(first + i) * key_stride] = format.missing && scores[i] == *format.missing
                                           ? kNoScore
                                           : score_key(scores[i], format.kind);
  }
}

size_t blocks_of(size_t count, size_t size) { return (count + size - 1) / size; }

}  // namespace

ScoreMatrix::ScoreMatrix(const std::filesystem::path& path, const ScoreFormat& format)
    : name_(path.string()), format_(format), array_(path) {
  type_ = find_number_type(array_.type());
  if (type_ == nullptr || array_.shape().size() != 2 || array_.value_bytes().empty())
    throw Error(
        ErrorKind::data,
        fmt::format("{}: expected a matrix of scores, queries x references; found the shape ({}) "
                    "of type {}",
                    name_, fmt::join(array_.shape(), ", "), array_.type()));
  queries_ = array_.shape()[format.references_first ? 1 : 0];
  references_ = array_.shape()[format.references_first ? 0 : 1];
  query_major_ = array_.is_column_major() == format.references_first;
}

ScoreMatrix::ScoreMatrix(ComputedScores computed)
    : computed_(std::move(computed)),
      queries_(computed_.queries),
      references_(computed_.references) {
  format_.kind = computed_.kind;
}

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
      read_keys(*type_, values + (first + q) * references_ * type_->bytes, references_,
                keys.data() + q * references_, 1, format_);
    return;
  }
  // Reference after reference: the block's queries lie side by side in each.
  for (size_t r = 0; r < references_; ++r)
    read_keys(*type_, values + (r * queries_ + first) * type_->bytes, count, keys.data() + r,
              references_, format_);
}

void ScoreMatrix::forget_block(size_t first, size_t count) const {
  if (computed_.compute) return;
  if (query_major_)
    array_.forget_values(first * references_ * type_->bytes, count * references_ * type_->bytes);
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
