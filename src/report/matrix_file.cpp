#include "report/matrix_file.h"

#include <algorithm>

#include "base/json.h"
#include "base/npy.h"
#include "report/result_file.h"

namespace vpr {

MatrixLayout matrix_layout(const SequenceResult& result) {
  MatrixLayout layout;
  layout.rows = result.query_windows;
  layout.score_offset = result.score_offset();
  layout.missing = score_kind(result.settings.score).missing;
  for (const SequenceThreshold& sequence : result.sequences) {
    layout.first_column.push_back(layout.cols);
    if (sequence.searched && sequence.frames >= result.settings.window_length)
      layout.cols += sequence.frames - result.settings.window_length + 1;
  }
  return layout;
}

Json matrix_layout_json(const MatrixLayout& layout, const SequenceResult& result) {
  Json columns = Json::array();
  for (size_t s = 0; s < result.sequences.size(); ++s)
    if (result.sequences[s].searched)
      columns.push_back(
          {{"sequence", result.sequences[s].name}, {"first_column", layout.first_column[s]}});
  return {{"rows", layout.rows}, {"columns", layout.cols}, {"sequences", columns}};
}

MatrixFile::MatrixFile(OutputFile& file, const MatrixLayout& layout, bool has_gaps,
                       const Monitor& monitor)
    : file_(file), layout_(layout) {
  const std::string header = npy_header(npy_type<int32_t>(), {layout.rows, layout.cols});
  header_bytes_ = header.size();
  file_.write(header);
  file_.reserve(header_bytes_ + sizeof(int32_t) * layout.rows * layout.cols);
  if (!has_gaps) return;
  const std::vector<int32_t> missing(layout.cols, layout.missing);
  for (size_t r = 0; r < layout.rows; ++r) {
    check_stop(monitor);
    file_.write(std::as_bytes(std::span(missing)));
  }
}

void MatrixFile::operator()(const DistanceRow& row) {
  const size_t column = layout_.first_column[row.sequence] + row.train_window;
  const size_t cell = row.query_window * layout_.cols + column;
  const size_t position = header_bytes_ + sizeof(int32_t) * cell;
  if (layout_.score_offset == 0) {
    file_.write_at(position, std::as_bytes(row.distances));
    return;
  }
  std::vector<int32_t> scores(row.distances.size());
  std::transform(row.distances.begin(), row.distances.end(), scores.begin(),
                 [&](uint32_t sum) { return static_cast<int32_t>(sum - layout_.score_offset); });
  file_.write_at(position, std::as_bytes(std::span(scores)));
}

Json MatrixFile::entry(const Monitor& monitor) const {
  return file_entry(file_.temporary(), layout_.rows, monitor);
}

}  // namespace vpr
