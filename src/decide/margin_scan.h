// How much better the best match of a query window is than the best one elsewhere.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
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

/// The margin of a row: the smallest score elsewhere less the smallest of all. Takes whole rows,
/// whose values are whole numbers and the better the smaller they are.
class MarginScan {
 public:
  MarginScan(Elsewhere elsewhere, size_t query_windows, const RowKernels& kernels);
  void operator()(std::span<const ScoreRow> row);
  const MarginScanResult& result() const { return result_; }

 private:
  Elsewhere elsewhere_;
  RowKernels kernels_;
  MarginScanResult result_;
};

}  // namespace vpr
