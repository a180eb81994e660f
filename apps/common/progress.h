// Progress on a terminal: one line that is drawn again, with the time left.
#pragma once

#include <cstddef>
#include <mutex>
#include <string>

#include "base/stopwatch.h"

namespace vpr {

/// "match monday 3/14       [#####     ]  50 %  ETA 0:12", at most `width` columns; what comes
/// before the bar has one width for all steps. `total` 0: unknown, the count stands alone.
/// `seconds_left` below 0: not known, left out.
std::string progress_text(const std::string& step, size_t done, size_t total, double seconds_left,
                          size_t width);

/// Draws on stderr, only if that is a terminal. Thread-safe.
class ProgressLine {
 public:
  explicit ProgressLine(bool enabled);
  ~ProgressLine();
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  /// The first word of `step` is the step, the others say which part of it (base/step_parts.h).
  void show(const std::string& step, size_t done, size_t total);
  /// Takes the line away, so that something else can be printed, on stdout or stderr.
  void clear();

 private:
  double seconds_left(double share) const;

  std::mutex mutex_;
  bool enabled_;
  bool drawn_ = false;
  std::string step_;
  Stopwatch step_time_;
  Stopwatch since_drawn_;
  double first_share_ = 0;  ///< of the step, when it began
  double last_share_ = 0;
};

}  // namespace vpr
