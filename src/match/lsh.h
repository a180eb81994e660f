// Multi-probe locality-sensitive hashing of windows, as in ABLE-M for long sequences: approximate.
#pragma once

#include <memory>
#include <string_view>
#include <vector>

#include "match/match.h"

namespace vpr {

/// The name of the method.
inline constexpr std::string_view kLshMethod = "lsh";

/// A training window that shares a bucket with a query window.
struct LshCandidate {
  uint32_t sequence = 0;
  uint32_t train_window = 0;
  uint32_t distance = 0;  ///< D, exact

  bool operator==(const LshCandidate&) const = default;
};

/// Hash tables over all windows of a database, without copies: the windows of a sequence are
/// overlapping rows of its codes, c_l codes wide and one code apart. (The tables are OpenCV's.)
class LshIndex {
 public:
  /// The codes must outlive the index. The same seed yields the same tables for any number of
  /// threads. Throws Error(usage) for settings out of range.
  LshIndex(std::span<const DescribedFrames> train, size_t window_length,
           const LshSettings& settings, uint64_t seed, const Monitor& monitor);
  ~LshIndex();

  /// By sequence, then window, without duplicates. `window`: c_l contiguous codes. Thread-safe.
  std::vector<LshCandidate> find(const uint8_t* window) const;

 private:
  struct Tables;
  std::vector<std::unique_ptr<Tables>> tables_;  // one per run
};

/// Rows hold only the windows that were found. Throws Error(usage) for anything but plain Hamming
/// distances of bits.
void match_lsh(const FrameDistances& distances, const MatchSettings& settings,
               const Monitor& monitor, const RowConsumer& consume);

}  // namespace vpr
