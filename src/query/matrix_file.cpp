#include "query/matrix_file.h"

#include <algorithm>
#include <limits>
#include <vector>

#include "base/npy.h"

namespace vpr {

MatrixLayout matrix_layout(const ScoreLayout& layout) {
  MatrixLayout found;
  found.rows = row_count(layout);
  for (uint32_t s = 0; s < layout.scope.sequences.size(); ++s) {
    if (!layout.scope.sequences[s].searched) continue;
    found.sequences.push_back({layout.scope.sequences[s].sequence.name, found.columns});
    if (const ScoreLayout::Columns* columns = layout.columns_of(s)) found.columns += columns->count;
  }
  return found;
}

MatrixFile::MatrixFile(Output& file, const Result& result, bool has_gaps, const Monitor& monitor)
    : file_(file),
      layout_(layout_of(result)),
      score_offset_(result.score().offset(result.window_length())) {
  const size_t rows = row_count(layout_);
  const size_t columns = column_count(layout_);
  const std::string header = npy_header(npy_type<int32_t>(), {rows, columns});
  header_bytes_ = header.size();
  file_.write(header);
  file_.reserve(header_bytes_ + sizeof(int32_t) * rows * columns);
  if (!has_gaps) return;
  const std::vector<int32_t> missing(columns, result.score().missing);
  for (size_t r = 0; r < rows; ++r) {
    check_stop(monitor);
    file_.write(std::as_bytes(std::span(missing)));
  }
}

void MatrixFile::operator()(const ScoreRow& row) {
  const size_t first = layout_.columns_of(static_cast<uint32_t>(row.sequence))->first;
  const size_t cell = row.query_window * column_count(layout_) + first + row.train_window;
  const size_t position = header_bytes_ + sizeof(int32_t) * cell;
  if (score_offset_ == 0) {
    file_.write_at(position, std::as_bytes(row.scores));
    return;
  }
  std::vector<int32_t> scores(row.scores.size());
  std::transform(row.scores.begin(), row.scores.end(), scores.begin(),
                 [&](uint32_t sum) { return static_cast<int32_t>(sum - score_offset_); });
  file_.write_at(position, std::as_bytes(std::span(scores)));
}

FileEntry MatrixFile::entry(const Monitor& monitor) const {
  return {row_count(layout_), file_checksum(file_.temporary(), monitor)};
}

PosteriorFile::PosteriorFile(Output& file, size_t frames, size_t views)
    : file_(file), frames_(frames), columns_(views + 1) {
  file_.write(npy_header(npy_type<double>(), {frames, columns_}));
}

void PosteriorFile::add(std::span<const double> posterior) {
  std::vector<double> row(posterior.begin(), posterior.end());
  row.resize(columns_, posterior.empty() ? std::numeric_limits<double>::quiet_NaN() : 0);
  file_.write(std::as_bytes(std::span<const double>(row)));
}

FileEntry PosteriorFile::entry(const Monitor& monitor) const {
  return {frames_, file_checksum(file_.temporary(), monitor)};
}

}  // namespace vpr
