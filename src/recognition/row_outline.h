// The cells of a row that have come, as far as the smallest one elsewhere can depend on them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "matching/rows.h"

namespace vpr {

/// Cells of one row and one sequence that have come, piece by piece and in any order. Of them only
/// those are kept on which it can depend how close a window outside +-width of the closest one
/// comes, whichever window will be the closest once all have come: mostly two, and never more than
/// 4 * width + 4.
struct RowOutline {
  struct Point {
    uint32_t window = 0;
    uint32_t score = 0;
  };
  uint32_t sequence = 0;
  uint32_t width = 0;
  Point best = {0, kNoCell};  ///< the closest; ties to the first
  /// Windows [first, last) around the best have come as a whole: none of them but it can be the
  /// closest in the end.
  uint32_t first = 0;
  uint32_t last = 0;
  /// A score of this or more changes nothing, if it is larger than the best, too.
  uint32_t bound = kNoCell;
  std::vector<Point> points;  ///< by window; the best is one of them
};

/// Takes a piece of the outline's row. `least`: its smallest score, first met at index `at`. A
/// piece with `least` above the best and not below the outline's bound may be left out; note_seen
/// then says that it came.
void add_piece(RowOutline& outline, const ScoreRow& row, uint32_t least, size_t at,
               const RowKernels& kernels);

/// The windows of a piece that was left out have come.
void note_seen(RowOutline& outline, size_t begin, size_t end);

/// The smallest score of a window that is more than `width` windows before or behind `window`,
/// which is the best or has not come; kNoCell where there is none.
uint32_t smallest_outside(const RowOutline& outline, size_t window);

}  // namespace vpr
