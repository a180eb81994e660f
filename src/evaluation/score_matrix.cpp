#include "evaluation/score_matrix.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "base/error.h"
#include "base/parallel.h"
#include "evaluation/counts.h"

namespace vpr {

namespace {

constexpr size_t kBlockValues = size_t{1} << 21;  // keys of one block, 16 MiB
constexpr size_t kPieceValues = 512;              // read at once

// Calls read(first, count, scores) for pieces of `count` scores, whose keys are `stride` apart.
template <class Read>
void read_keys(size_t count, ScoreOrder kind, uint64_t* keys, size_t stride, Read&& read) {
  std::array<double, kPieceValues> scores;
  for (size_t first = 0; first < count; first += kPieceValues) {
    const size_t piece = std::min(kPieceValues, count - first);
    read(first, piece, scores.data());
    for (size_t i = 0; i < piece; ++i) keys[(first + i) * stride] = score_key(scores[i], kind);
  }
}

size_t blocks_of(size_t count, size_t size) { return (count + size - 1) / size; }

}  // namespace

ScoreMatrix::ScoreMatrix(const std::filesystem::path& path, const ScoreFormat& format)
    : file_(std::in_place, path, format),
      kind_(format.is_similarity ? ScoreOrder::similarity : ScoreOrder::distance),
      queries_(file_->queries()),
      references_(file_->references()) {}

ScoreMatrix::ScoreMatrix(ComputedScores computed)
    : computed_(std::move(computed)),
      kind_(computed_.kind),
      queries_(computed_.queries),
      references_(computed_.references) {}

void ScoreMatrix::compute_block(size_t first, size_t count, std::span<uint64_t> keys) const {
  std::vector<double> distances(count * references_);
  computed_.compute(first, count, distances);
  for (size_t i = 0; i < distances.size(); ++i) keys[i] = score_key(distances[i], kind());
}

void ScoreMatrix::read_block(size_t first, size_t count, std::span<uint64_t> keys) const {
  if (!file_) return compute_block(first, count, keys);
  if (file_->is_query_major()) {
    for (size_t q = 0; q < count; ++q)
      read_keys(references_, kind_, keys.data() + q * references_, 1,
                [&](size_t begin, size_t piece, double* scores) {
                  file_->read_query(first + q, begin, piece, scores);
                });
    return file_->forget(first, count);
  }
  for (size_t r = 0; r < references_; ++r)
    read_keys(count, kind_, keys.data() + r, references_,
              [&](size_t begin, size_t piece, double* scores) {
                file_->read_reference(r, first + begin, piece, scores);
              });
  file_->forget(0, references_);
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
      counter.add(count);
    }
  });
}

std::string ScoreMatrix::fingerprint(const Monitor& monitor) const {
  return file_ ? file_->fingerprint(monitor) : computed_.fingerprint(monitor);
}

const ScoreLayout::Columns* ScoreLayout::columns_of(uint32_t sequence) const {
  const auto found = std::ranges::lower_bound(columns, sequence, {}, &Columns::sequence);
  return found != columns.end() && found->sequence == sequence ? &*found : nullptr;
}

size_t row_count(const ScoreLayout& layout) {
  const size_t frames = layout.scope.query_frames;
  return frames < layout.window_length ? 0 : frames - layout.window_length + 1;
}

size_t column_count(const ScoreLayout& layout) {
  return layout.columns.empty() ? 0 : layout.columns.back().first + layout.columns.back().count;
}

ScoreLayout layout_of(const ScoreMatrix& matrix, size_t window_length) {
  assert(window_length >= 1);
  ScoreLayout layout;
  layout.window_length = window_length;
  layout.scope.query_frames = matrix.queries() + window_length - 1;
  layout.scope.sequences = {{"references", matrix.references() + window_length - 1, true}};
  layout.columns = {{0, 0, matrix.references()}};
  return layout;
}

ScoreLayout layout_of(const Result& result) {
  ScoreLayout layout;
  layout.window_length = result.window_length();
  layout.scope = scope_of(result);
  for (size_t t = 0; t < result.targets.size(); ++t) {
    const Target& target = result.targets[t];
    if (!target.searched || target.frames < layout.window_length) continue;
    layout.columns.push_back(
        {static_cast<uint32_t>(t), column_count(layout), target.frames - layout.window_length + 1});
  }
  return layout;
}

void require_fit(const ScoreMatrix& matrix, const ScoreLayout& layout) {
  if (matrix.queries() == row_count(layout) && matrix.references() == column_count(layout)) return;
  throw Error(
      ErrorKind::data,
      fmt::format("the scores are {} x {}, and the result has {} query windows and {} "
                  "training windows; give the matrix that was saved with it",
                  matrix.queries(), matrix.references(), row_count(layout), column_count(layout)));
}

void label_row(const GroundTruth& truth, const ScoreLayout& layout, size_t row,
               std::vector<PlaceLabel>& labels) {
  labels.assign(column_count(layout), PlaceLabel::different);
  const size_t back = layout.window_length - 1;  // from a window's anchor to its first frame
  std::vector<PlaceLabel> frames;
  for (const ScoreLayout::Columns& columns : layout.columns) {
    frames.resize(columns.count + back);
    truth.label_row(layout.anchor(row), columns.sequence, frames);
    std::copy(frames.begin() + static_cast<std::ptrdiff_t>(back), frames.end(),
              labels.begin() + static_cast<std::ptrdiff_t>(columns.first));
  }
}

bool has_column_of(const GroundTruth& truth, const ScoreLayout& layout, size_t anchor) {
  const auto& pairs = truth.pairs[anchor];
  const auto first = static_cast<int64_t>(layout.window_length - 1);
  return std::any_of(pairs.begin(), pairs.end(), [&](const GroundTruth::Pair& pair) {
    if (pair.label != PlaceLabel::same) return false;
    const ScoreLayout::Columns* columns = layout.columns_of(pair.sequence);
    return columns != nullptr &&
           pair.first - truth.tolerance_frames < first + static_cast<int64_t>(columns->count) &&
           pair.last() + truth.tolerance_frames >= first;
  });
}

FrameMatch match_of_column(const ScoreLayout& layout, size_t column) {
  assert(column < column_count(layout));
  const auto behind =
      std::ranges::upper_bound(layout.columns, column, {}, &ScoreLayout::Columns::first);
  const ScoreLayout::Columns& columns = *std::prev(behind);
  return {columns.sequence, layout.anchor(column - columns.first)};
}

}  // namespace vpr
