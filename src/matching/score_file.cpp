#include "matching/score_file.h"

#include <algorithm>
#include <limits>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/checksum.h"
#include "base/error.h"

namespace vpr {

ScoreFile::ScoreFile(const std::filesystem::path& path, const ScoreFormat& format)
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
  is_query_major_ = array_.is_column_major() == format.references_first;
  if (std::max(queries_, references_) > std::numeric_limits<int32_t>::max())
    throw Error(ErrorKind::data, fmt::format("{}: has more than 2^31 rows or columns", name_));
}

void ScoreFile::read(size_t index, size_t stride, size_t count, double* scores) const {
  type_->read(array_.value_bytes().data() + index * type_->bytes, stride * type_->bytes, count,
              scores, 1);
  if (format_.missing)
    std::replace(scores, scores + count, *format_.missing,
                 std::numeric_limits<double>::quiet_NaN());
}

void ScoreFile::read_query(size_t query, size_t first, size_t count, double* scores) const {
  if (is_query_major_)
    read(query * references_ + first, 1, count, scores);
  else
    read(first * queries_ + query, queries_, count, scores);
}

void ScoreFile::read_reference(size_t reference, size_t first, size_t count, double* scores) const {
  if (is_query_major_)
    read(first * references_ + reference, references_, count, scores);
  else
    read(reference * queries_ + first, 1, count, scores);
}

void ScoreFile::forget(size_t first, size_t count) const {
  const size_t line_bytes = line_values() * type_->bytes;
  array_.forget_values(first * line_bytes, count * line_bytes);
}

std::string ScoreFile::fingerprint(const Monitor& monitor) const {
  constexpr size_t kPieceBytes = size_t{16} << 20;
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
