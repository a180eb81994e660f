#include "evaluate/score_file.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/checksum.h"
#include "base/error.h"

namespace vpr {
namespace {

// Whether every row has different integers, in all from below to above the number of columns, as
// indices of the best references are. Throws if every row has the integers 0, 1, ... once.
bool look_like_indices(const ScoreFile& file) {
  constexpr size_t kFewest = 3;  // two distances may be 0 and 1
  constexpr size_t kMost = 1000;
  const size_t count = file.references();
  if (!file.is_whole() || count < kFewest) return false;
  std::vector<double> row(count);
  double least = std::numeric_limits<double>::infinity();
  double most = 0;
  for (size_t query = 0; query < file.queries(); ++query) {
    try {
      file.read_query(query, row.data());
    } catch (const Error&) {  // of a value, as reported later
      return false;
    }
    if (std::ranges::any_of(row, [](double value) { return std::isnan(value); })) return false;
    std::ranges::sort(row);
    least = std::min(least, row.front());
    most = std::max(most, row.back());
    const bool is_wide = most >= static_cast<double>(count);
    if (least < 0 || (is_wide && count > kMost) || std::ranges::adjacent_find(row) != row.end())
      return false;
  }
  if (most >= static_cast<double>(count)) return least < static_cast<double>(count);
  throw Error(ErrorKind::data,
              "{}: every row has the integers 0 to {} once. If they are indices, best first, save "
              "fewer columns for vpr-eval matrix, as in I[:, :{}], and pass --train-frames {}; if "
              "they are ranks of the columns, save floats",
              file.name(), count - 1, std::min<size_t>(count - 1, 100), count);
}

// The number of this type that is nearest to `value`.
double nearest_of(const NumberType& type, double value) {
  if (type.is_whole || !std::isfinite(value)) return value;
  const int digits = type.bytes == 2 ? 11 : type.bytes == 4 ? 24 : 53;
  int exponent = 0;
  const double fraction = std::frexp(value, &exponent);
  return std::ldexp(std::nearbyint(std::ldexp(fraction, digits)), exponent - digits);
}

}  // namespace

void warn_of_indices(const ScoreFile& scores, const Monitor& monitor) {
  if (look_like_indices(scores) && scores.score_bytes() >= 4)  // as libraries return them
    warn(monitor,
         "{}: every row has different integers, some not below the number of columns, {}. If "
         "they are indices of references, evaluate them with vpr-eval matrix and --train-frames, "
         "without --distance or --similarity",
         scores.name(), scores.references());
}

ScoreFile::ScoreFile(const std::filesystem::path& path, const ScoreFormat& format)
    : ScoreFile(std::make_shared<const NpyArray>(path), path.string(), format) {}

ScoreFile::ScoreFile(std::shared_ptr<const NpyArray> array, const std::string& name,
                     const ScoreFormat& format)
    : name_(name), format_(format), array_(std::move(array)) {
  type_ = find_number_type(array_->type());
  if (type_ == nullptr || array_->shape().size() != 2 || array_->value_bytes().empty())
    throw Error(
        ErrorKind::data,
        "{}: expected a matrix of scores, queries x references; found the shape ({}) of type {}",
        name_, fmt::join(array_->shape(), ", "), array_->type());
  if (format_.missing) format_.missing = nearest_of(*type_, *format_.missing);
  queries_ = array_->shape()[format.train_first ? 1 : 0];
  references_ = array_->shape()[format.train_first ? 0 : 1];
  is_query_major_ = array_->is_column_major() == format.train_first;
  if (std::max(queries_, references_) > std::numeric_limits<int32_t>::max())
    throw Error(ErrorKind::data, "{}: has more than 2^31 rows or columns", name_);
}

void ScoreFile::read(size_t index, size_t stride, size_t count, double* scores) const {
  try {
    type_->read(array_->value_bytes().data() + index * type_->bytes, stride * type_->bytes, count,
                scores, 1);
  } catch (const Error& error) {
    throw Error(error.kind(), fmt::format("{}: {}", name_, error.what()));
  }
  if (format_.missing)
    std::replace(scores, scores + count, *format_.missing,
                 std::numeric_limits<double>::quiet_NaN());
}

void ScoreFile::read_query(size_t query, double* scores) const {
  if (is_query_major_)
    read(query * references_, 1, references_, scores);
  else
    read(query, queries_, references_, scores);
}

void ScoreFile::read_reference(size_t reference, size_t first, size_t count, double* scores) const {
  if (is_query_major_)
    read(first * references_ + reference, references_, count, scores);
  else
    read(reference * queries_ + first, 1, count, scores);
}

void ScoreFile::forget(size_t first, size_t count) const {
  const size_t line_bytes = (is_query_major_ ? references_ : queries_) * type_->bytes;
  array_->forget_values(first * line_bytes, count * line_bytes);
}

std::string ScoreFile::fingerprint(const Monitor& monitor) const {
  constexpr size_t kPieceBytes = size_t{16} << 20;
  ChecksumStream sum;
  const std::string header = array_->header_bytes();
  sum.add(std::as_bytes(std::span(header)));
  const auto values = array_->value_bytes();
  for (size_t at = 0; at < values.size(); at += kPieceBytes) {
    check_stop(monitor);
    const auto piece = values.subspan(at, std::min(kPieceBytes, values.size() - at));
    sum.add(piece);
    array_->forget_values(at, piece.size());
  }
  return sum.text();
}

}  // namespace vpr
