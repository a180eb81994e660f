#include "ground_truth/matrix_shape.h"

#include <fmt/format.h>

#include "ground_truth/builder.h"

namespace vpr {

bool require_matrix_shape(GroundTruthBuilder& builder, size_t sequence, size_t rows, size_t cols,
                          bool usually) {
  const FrameCount& query = builder.query();
  const FrameCount& train = builder.train(sequence);
  const auto fits = [](const FrameCount& side, size_t frames) {
    return side.grows || side.frames == frames;
  };
  const bool fits_query = fits(query, rows) && fits(train, cols);
  const bool fits_reference = fits(query, cols) && fits(train, rows);
  const MatrixRows given = builder.argument().options.matrix_rows;
  bool rows_are_query = usually ? fits_query || !fits_reference : fits_query && !fits_reference;
  if (given != MatrixRows::automatic) rows_are_query = given == MatrixRows::query;
  if (!(rows_are_query ? fits_query : fits_reference))
    builder.fail(
        fmt::format("is a matrix of {} x {}, and there are {} query and {} training frames", rows,
                    cols, query.frames, train.frames));
  builder.require_query_frames(rows_are_query ? rows : cols);
  builder.require_train_frames(sequence, rows_are_query ? cols : rows);
  return rows_are_query;
}

}  // namespace vpr
