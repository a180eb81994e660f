// How far FAB-MAP can be relied on beside frame distances, learned from the query alone.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace vpr {

/// A training sequence whose frames are matched.
struct FusedWalk {
  size_t sequence = 0;  ///< of the database
  size_t frames = 0;
  size_t neighbours = 0;  ///< frames so far apart may show the same place
};

/// The training frames that a query frame matches best, by either method; none where it says
/// nothing.
struct BestFrames {
  std::optional<size_t> likeliest;  ///< by FAB-MAP
  std::optional<size_t> closest;    ///< by score
};

/// Who walks is near where he was a frame ago. So of a method that knows the place, the best match
/// is near that of the frame before, and near the other method's where that knows it, too; of one
/// that guesses, it is so by chance only. Counts of both, less what chance gives.
struct Agreement {
  double likeliest_steps = 0;
  double closest_steps = 0;
  double together = 0;
  BestFrames last;  ///< of the frame before

  /// Of two consecutive frames, both with words, and of the later one alone.
  void count(const BestFrames& best, std::span<const FusedWalk> walks);

  /// By how many times FAB-MAP knows more than scores do: what it was right by more than chance
  /// (the mean of likeliest_steps and together) over closest_steps; none below 0, and five frames
  /// of 0.6 and 1 added, which stand for what is not known yet.
  double ratio() const;
};

/// The closest frame of a row of scores that comes in parts, from several threads at once: of equal
/// scores the first.
class ClosestFrame {
 public:
  void reset() { best_.store(kNone, std::memory_order_relaxed); }
  void add(uint16_t score, size_t frame);
  std::optional<size_t> frame() const;

 private:
  static constexpr uint64_t kNone = ~uint64_t{0};
  std::atomic<uint64_t> best_{kNone};  ///< score and frame
};

}  // namespace vpr
