// How much better the best match of a query window is than the best one elsewhere.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "decide/row_scan.h"
#include "match/rows.h"

namespace vpr {

/// What is elsewhere: in the sequence of the best match, windows more than w before or behind it;
/// in another sequence, all windows if the two show different places, and none if they are walks of
/// one place.
struct Elsewhere {
  std::vector<uint32_t> widths;              ///< w, by sequence
  std::vector<std::vector<uint8_t>> shared;  ///< [a][b]: whether a and b show the same place
};

/// Sequences that all show different places, but for these pairs.
Elsewhere make_elsewhere(std::vector<uint32_t> widths,
                         const std::vector<std::pair<size_t, size_t>>& shared_places);

/// Per query window. None where no window came; no margin where none is elsewhere.
struct MarginScanResult {
  std::vector<std::optional<Cell>> best;         ///< ties to the smallest sequence and train window
  std::vector<std::optional<uint32_t>> margins;  ///< the smallest score elsewhere less the
                                                 ///< best; never negative
};

/// Takes rows of any exact method, whose values are whole numbers and the better the smaller they
/// are. Each cell passes once; about 100 bytes are kept of a row for each sequence. The result does
/// not depend on the order in which pieces arrive, nor on the number of threads.
class MarginScan {
 public:
  MarginScan(Elsewhere elsewhere, size_t query_windows, const RowKernels& kernels);
  ~MarginScan();
  void operator()(const ScoreRow& row);
  /// The same, where the smallest score of the row is known.
  void take(const ScoreRow& row, uint32_t least);
  MarginScanResult result() const;

 private:
  struct Rows;
  Elsewhere elsewhere_;
  RowKernels kernels_;
  std::unique_ptr<Rows> rows_;
};

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
