// Sinks of the rows of scores. None of them stores all n x m cells.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "match/match.h"

namespace vpr {

/// The largest score of each training sequence; 0 for a sequence without cells.
class MaximumScan {
 public:
  explicit MaximumScan(size_t sequences) : maxima_(sequences) {}
  void operator()(const ScoreRow& row);
  std::vector<uint32_t> result() const { return {maxima_.begin(), maxima_.end()}; }

 private:
  std::vector<std::atomic<uint32_t>> maxima_;
};

/// The settings of a RecognitionScan.
struct RecognitionScanSettings {
  std::vector<uint32_t> limits;  ///< by sequence: a cell with score < limit is a recognition
  size_t query_windows = 0;
  size_t max_recognitions = 0;  ///< more throw Error(usage)
};

struct RecognitionScanResult {
  std::vector<Cell> recognitions;         ///< by query window, sequence, train window
  std::vector<std::optional<Cell>> best;  ///< by query window; nullopt for a window without a
                                          ///< cell. Ties to the smallest sequence, train window
};

/// Recognitions and best matches. The result does not depend on the order of rows.
class RecognitionScan {
 public:
  explicit RecognitionScan(RecognitionScanSettings settings);
  ~RecognitionScan();
  void operator()(const ScoreRow& row);
  RecognitionScanResult result();

 private:
  struct Threads;
  RecognitionScanSettings settings_;
  std::unique_ptr<Threads> threads_;
};

}  // namespace vpr
