// What is taken from the rows of scores while they pass: nothing of size n x m is kept.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "match/rows.h"

namespace vpr {

/// One cell: windows by their first frame, the train window within its sequence.
struct Cell {
  uint32_t query_window = 0;
  uint32_t sequence = 0;
  uint32_t train_window = 0;
  uint32_t score = 0;  ///< D, or the biased sum of scores, over the window
  uint8_t rate = 0;    ///< of windows of several rates: which of them

  bool operator==(const Cell&) const = default;
};

/// By query window, sequence, train window.
bool by_position(const Cell& a, const Cell& b);
/// Whether of two cells of a row `a` is the best match; ties to the smallest sequence and train
/// window.
bool is_closer(const Cell& a, const Cell& b);
/// Throws the Error(usage) of a scan that may keep so many recognitions and finds more.
[[noreturn]] void refuse_recognitions(size_t max_recognitions);

/// The largest score of each training sequence; 0 for one without windows, or if no row came.
class MaximumScan {
 public:
  MaximumScan(size_t sequences, const RowKernels& kernels);
  ~MaximumScan();
  void operator()(const ScoreRow& row);
  std::vector<uint32_t> result() const;

 private:
  struct Threads;
  size_t sequences_;
  RowKernels kernels_;
  std::unique_ptr<Threads> threads_;
};

/// What a RecognitionScan looks for.
struct RecognitionScanSettings {
  std::vector<uint32_t> limits;  ///< per sequence: a cell with score < limit is a recognition
  size_t query_windows = 0;
  size_t max_recognitions = 0;  ///< more throw Error(usage)
  RowKernels kernels;
};

/// What a RecognitionScan found.
struct RecognitionScanResult {
  std::vector<Cell> recognitions;         ///< by query window, sequence, train window
  std::vector<std::optional<Cell>> best;  ///< per query window; none where the window has no cell.
                                          ///< Ties go to the smallest sequence and train window
};

/// Recognitions and best matches. The result does not depend on the order in which rows arrive.
class RecognitionScan {
 public:
  explicit RecognitionScan(RecognitionScanSettings settings);
  ~RecognitionScan();
  void operator()(const ScoreRow& row);
  /// The same, where the smallest score of the row is known.
  void take(const ScoreRow& row, uint32_t least);
  RecognitionScanResult result();

 private:
  struct Threads;
  RecognitionScanSettings settings_;
  std::unique_ptr<Threads> threads_;
};

/// Picks up the scores of given cells, for checking. `cells` must be sorted by query window,
/// sequence and train window, without duplicates.
class CellScan {
 public:
  explicit CellScan(std::vector<Cell> cells);
  void operator()(const ScoreRow& row);
  const std::vector<Cell>& result() const { return cells_; }

 private:
  std::vector<Cell> cells_;  // each is written by the one row that holds it
};

}  // namespace vpr
