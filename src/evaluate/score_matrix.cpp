#include "evaluate/score_matrix.h"

#include <algorithm>
#include <cassert>
#include <memory>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "base/error.h"
#include "base/parallel.h"
#include "evaluate/counts.h"

namespace vpr {

namespace {

constexpr size_t kBlockValues = size_t{1} << 21;  // keys of one block, 16 MiB
}  // namespace

ScoreMatrix::ScoreMatrix(const std::filesystem::path& path, const ScoreFormat& format) {
  const auto file = std::make_shared<const ScoreFile>(path, format);
  scores_.queries = scores_.block = file->queries();
  scores_.references = file->references();
  scores_.kind = format.is_similarity ? ScoreOrder::similarity : ScoreOrder::distance;
  scores_.fingerprint = [file](const Monitor& monitor) { return file->fingerprint(monitor); };
  scores_.compute = [file](size_t first, size_t count, std::span<double> scores) {
    const size_t references = file->references();
    if (file->is_query_major()) {
      for (size_t q = 0; q < count; ++q)
        file->read_query(first + q, 0, references, scores.data() + q * references);
      return file->forget(first, count);
    }
    std::vector<double> column(count);
    for (size_t r = 0; r < references; ++r) {
      file->read_reference(r, first, count, column.data());
      for (size_t q = 0; q < count; ++q) scores[q * references + r] = column[q];
    }
    file->forget(0, references);
  };
}

void ScoreMatrix::for_each_row(size_t workers, const Monitor& monitor, const std::string& step,
                               const RowBody& body) const {
  if (queries() == 0) return;
  const size_t most = std::min(scores_.block, queries());
  const size_t block =
      std::clamp<size_t>(kBlockValues / std::max<size_t>(1, references()), 1, most);
  StepCounter counter(monitor, step, queries());
  parallel_for(workers, monitor, [&](size_t worker) {
    std::vector<double> scores;
    std::vector<uint64_t> keys;
    for (size_t first = worker * block; first < queries(); first += workers * block) {
      const size_t count = std::min(block, queries() - first);
      scores.resize(count * references());
      keys.resize(scores.size());
      if (references() > 0) scores_.compute(first, count, scores);
      for (size_t i = 0; i < scores.size(); ++i) keys[i] = score_key(scores[i], kind());
      for (size_t q = 0; q < count; ++q)
        body(worker, first + q, std::span(keys).subspan(q * references(), references()));
      counter.add(count);
    }
  });
}

const ScoreLayout::Columns* ScoreLayout::columns_of(uint32_t sequence) const {
  const auto found = std::ranges::lower_bound(columns, sequence, {}, &Columns::sequence);
  return found != columns.end() && found->sequence == sequence ? &*found : nullptr;
}

size_t row_count(const ScoreLayout& layout) {
  const size_t frames = layout.scope.query.frames;
  return frames < layout.window_length ? 0 : frames - layout.window_length + 1;
}

size_t column_count(const ScoreLayout& layout) {
  return layout.columns.empty() ? 0 : layout.columns.back().first + layout.columns.back().count;
}

ScoreLayout layout_of(const ScoreMatrix& matrix, size_t window_length) {
  assert(window_length >= 1);
  ScoreLayout layout;
  layout.window_length = window_length;
  layout.scope.query.frames = matrix.queries() + window_length - 1;
  layout.scope.sequences = {{{"references", matrix.references() + window_length - 1}}};
  layout.columns = {{0, 0, matrix.references()}};
  return layout;
}

ScoreLayout layout_of(const Result& result) {
  ScoreLayout layout;
  layout.window_length = result.window_length();
  layout.scope = scope_of(result);
  for (size_t t = 0; t < result.targets.size(); ++t) {
    const size_t frames = result.targets[t].sequence.frames;
    if (!result.targets[t].searched || frames < layout.window_length) continue;
    layout.columns.push_back(
        {static_cast<uint32_t>(t), column_count(layout), frames - layout.window_length + 1});
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
