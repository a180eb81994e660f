#include "match/precomputed_distances.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cassert>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/checksum.h"
#include "base/error.h"
#include "base/parallel.h"

namespace vpr {

namespace {

constexpr double kSteps = 65535;   // of a rounded matrix
constexpr size_t kPiece = 512;     // values read at once
constexpr size_t kScanned = 1024;  // lines of the file per task
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// The result of a pass over a part of the file.
struct Extent {
  double least = std::numeric_limits<double>::infinity();
  double most = -std::numeric_limits<double>::infinity();
  double second_least = least;  ///< of different values
  double second_most = most;

  void add(double value) {
    if (value < least)
      second_least = std::exchange(least, value);
    else if (value > least)
      second_least = std::min(second_least, value);
    if (value > most)
      second_most = std::exchange(most, value);
    else if (value < most)
      second_most = std::max(second_most, value);
  }
};

// A marker of missing scores, such as 1e6, makes the steps too coarse for the others.
void warn_of_marker(const Extent& all, const std::string& name, const Monitor& monitor) {
  for (const auto& [marker, least, most] : {std::array{all.most, all.least, all.second_most},
                                            std::array{all.least, all.second_least, all.most}})
    if (least < most && most - least < (all.most - all.least) / 256)
      warn(monitor,
           "{}: the score {} is far from all others, from {:.4g} to {:.4g}. If it marks missing "
           "scores, use --missing {}",
           name, marker, least, most, marker);
}

// The distance -1 alone below 0 is a common marker of missing scores, and would match best.
void warn_of_minus_one(const Extent& all, const std::string& name, const Monitor& monitor) {
  if (all.least == -1 && all.second_least >= 0)
    warn(monitor,
         "{}: the smallest distance is -1, all others are from {:.4g} to {:.4g}. If it marks "
         "missing scores, use --missing -1",
         name, all.second_least, all.most);
}

ScoreUnits units_of(const Extent& all, bool is_similarity, bool is_whole) {
  const double best = is_similarity ? all.most : std::min(all.least, 0.0);
  const double range = is_similarity ? all.most - all.least : all.most - best;
  ScoreUnits units{is_similarity ? ScoreOrder::similarity : ScoreOrder::distance, best, 1,
                   is_whole && range <= kSteps, 0};
  if (!units.is_exact && range / kSteps > 0) units.unit = range / kSteps;
  units.largest = static_cast<uint16_t>(
      units.is_exact ? std::max(range, 1.0) : kSteps);  // equal scores have a unit as well
  return units;
}

uint16_t quantized(double score, const ScoreUnits& units) {
  if (std::isnan(score)) return units.largest;
  const bool is_similarity = units.kind == ScoreOrder::similarity;
  const double above = is_similarity ? units.best - score : score - units.best;
  return static_cast<uint16_t>(
      std::clamp(above / units.unit + 0.5, 0.0, static_cast<double>(units.largest)));
}

/// Consecutive references for consecutive training frames.
struct Stretch {
  size_t first = 0;  ///< training frame
  size_t count = 0;
  size_t reference = 0;
};

// The number stored in a descriptor.
uint32_t frame_number(DescriptorRow row) {
  return row[0] | uint32_t{row[1]} << 8 | uint32_t{row[2]} << 16 | uint32_t{row[3]} << 24;
}

std::vector<Stretch> stretches_of(std::span<const DescribedFrames> train) {
  std::vector<Stretch> stretches;
  size_t frame = 0;
  for (const DescribedFrames& sequence : train) {
    for (size_t i = 0; i < sequence.rows.size(); ++i, ++frame) {
      const size_t reference = frame_number(sequence.rows[i]);
      if (!stretches.empty() && stretches.back().reference + stretches.back().count == reference)
        ++stretches.back().count;
      else
        stretches.push_back({frame, 1, reference});
    }
  }
  return stretches;
}

// Reads the distances of a query frame to training frames [first, last).
void read_row(const PrecomputedDistances& precomputed, size_t query,
              const std::vector<Stretch>& stretches, size_t first, size_t last, uint16_t* out) {
  auto stretch = std::ranges::upper_bound(stretches, first, {}, &Stretch::first);
  for (--stretch; stretch != stretches.end() && stretch->first < last; ++stretch) {
    const size_t from = std::max(first, stretch->first);
    const size_t to = std::min(last, stretch->first + stretch->count);
    precomputed.read(query, stretch->reference + (from - stretch->first), to - from,
                     out + (from - first));
  }
}

// Distances within one side are unknown: 0 for a frame and itself, otherwise the largest distance.
uint32_t number_distance(DescriptorRow a, DescriptorRow b) {
  return frame_number(a) == frame_number(b) ? 0 : static_cast<uint32_t>(kSteps);
}

// Reads the distances in query.precomputed to the references whose numbers are the descriptors.
PreparedTraining prepare(std::span<const DescribedFrames> train, const DescriptorShape&) {
  return [stretches = stretches_of(train)](FrameDistances& distances) {
    const PrecomputedDistances* precomputed = distances.query.precomputed;
    if (precomputed == nullptr)
      throw Error(ErrorKind::usage,
                  "a matrix of scores has no distances between training frames: pass a number to "
                  "--t-r, or use --margin and --exclusion-frames");
    distances.largest = precomputed->units().largest;
    distances.tile = [precomputed, rows = distances.query.rows, stretches](
                         std::span<const uint32_t> queries, size_t first, size_t last,
                         uint16_t* out, size_t stride) {
      for (size_t t = 0; t < queries.size(); ++t)
        read_row(*precomputed, frame_number(rows[queries[t]]), stretches, first, last,
                 out + t * stride);
    };
  };
}

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
      file.read_query(query, 0, count, row.data());
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

}  // namespace

PrecomputedDistances::PrecomputedDistances(ScoreFile file, const Monitor& monitor)
    : file_(std::move(file)) {
  scan(monitor);
}

// NaN also for an infinite score at the worst end.
double PrecomputedDistances::score_of(double number) const {
  return std::isinf(number) && (number > 0) != is_similarity() ? kNone : number;
}

// Lines are contiguous values in the file.
void PrecomputedDistances::scan(const Monitor& monitor) {
  const bool by_query = file_.is_query_major();
  const size_t lines = by_query ? queries() : references();
  const size_t length = by_query ? references() : queries();
  std::vector<Extent> extents(lines);
  std::vector<std::atomic<uint8_t>> has_score(length);  // over all lines
  StepCounter counter(monitor, "scores", lines);
  parallel_for((lines + kScanned - 1) / kScanned, monitor, [&](size_t task) {
    std::vector<double> numbers(length);
    for (size_t line = task * kScanned; line < std::min(lines, (task + 1) * kScanned); ++line) {
      if (by_query)
        file_.read_query(line, 0, length, numbers.data());
      else
        file_.read_reference(line, 0, length, numbers.data());
      for (size_t i = 0; i < length; ++i) {
        const double score = score_of(numbers[i]);
        if (std::isnan(score)) continue;
        extents[line].add(score);
        has_score[i].store(1, std::memory_order_relaxed);
      }
      file_.forget(line, 1);
      counter.add();
    }
  });
  Extent all;
  std::vector<size_t>& empty_lines = by_query ? empty_queries_ : empty_references_;
  std::vector<size_t>& empty_across = by_query ? empty_references_ : empty_queries_;
  for (size_t line = 0; line < lines; ++line) {
    const Extent& extent = extents[line];
    if (extent.least > extent.most) {
      empty_lines.push_back(line);
      continue;
    }
    all.add(extent.least);
    all.add(extent.most);
    for (const double score : {extent.second_least, extent.second_most})
      if (std::isfinite(score)) all.add(score);  // infinite if all are equal
  }
  for (size_t i = 0; i < length; ++i)
    if (has_score[i].load(std::memory_order_relaxed) == 0) empty_across.push_back(i);
  if (all.least > all.most) throw Error(ErrorKind::data, "{}: has no score", file_.name());
  if (std::isinf(all.least) || std::isinf(all.most))
    throw Error(
        ErrorKind::data,
        "{}: has an infinite {}, better than all others; use --missing to mark missing scores",
        file_.name(), is_similarity() ? "similarity" : "distance");
  if (std::isinf(all.most - all.least))
    throw Error(ErrorKind::data,
                "{}: has scores from {} to {}, too far apart to be compared; use --missing to mark "
                "missing scores",
                file_.name(), all.least, all.most);
  units_ = units_of(all, is_similarity(), file_.is_whole());
  if (!units_.is_exact) warn_of_marker(all, file_.name(), monitor);
  if (!is_similarity()) warn_of_minus_one(all, file_.name(), monitor);
  warn_of_indices(file_, monitor);
}

void PrecomputedDistances::read(size_t query, size_t first, size_t count, uint16_t* out) const {
  assert(query < queries() && first + count <= references());
  std::array<double, kPiece> numbers;
  for (size_t done = 0; done < count; done += kPiece) {
    const size_t piece = std::min(kPiece, count - done);
    file_.read_query(query, first + done, piece, numbers.data());
    for (size_t i = 0; i < piece; ++i) out[done + i] = quantized(score_of(numbers[i]), units_);
  }
}

uint32_t PrecomputedDistances::distance(size_t query, size_t reference) const {
  double number = 0;
  file_.read_query(query, reference, 1, &number);
  const double score = score_of(number);
  if (std::isnan(score)) return units_.largest;
  const double away = std::abs(score - units_.best) / units_.unit;
  return std::min(static_cast<uint32_t>(std::floor(away + 0.5)), uint32_t{units_.largest});
}

void warn_of_indices(const ScoreFile& scores, const Monitor& monitor) {
  if (scores.may_be_indices())
    warn(monitor,
         "{}: every row has different integers, some not below the number of columns, {}. If "
         "they are indices of references, evaluate them with vpr-eval matrix and --train-frames, "
         "without --distance or --similarity",
         scores.name(), scores.references());
}

void append_frame_numbers(std::vector<uint8_t>& rows, size_t first, size_t count) {
  for (size_t i = 0; i < count; ++i) {
    const auto number = static_cast<uint32_t>(first + i);
    for (int byte = 0; byte < 4; ++byte) rows.push_back(static_cast<uint8_t>(number >> 8 * byte));
  }
}

// Frames with precomputed distances have no known components.
const DistanceKind kPrecomputedDistance = {
    ElementType::frame_numbers,
    {"units of the scores", 1},
    [](const DescriptorShape&) { return static_cast<uint16_t>(kSteps); },
    number_distance,
    [](const DescriptorRows&, std::span<const ComponentValues>) -> Projector {
      return [](DescriptorRow) { return ComponentValues{}; };
    },
    prepare};

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
  queries_ = array_->shape()[format.train_first ? 1 : 0];
  references_ = array_->shape()[format.train_first ? 0 : 1];
  is_query_major_ = array_->is_column_major() == format.train_first;
  if (std::max(queries_, references_) > std::numeric_limits<int32_t>::max())
    throw Error(ErrorKind::data, "{}: has more than 2^31 rows or columns", name_);
  may_be_indices_ = look_like_indices(*this) && type_->bytes >= 4;  // as libraries return them
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
