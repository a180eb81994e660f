// Progress on a terminal: one line with the remaining time, redrawn in place.
#pragma once

#include <cstddef>
#include <mutex>
#include <string>

#include "base/stopwatch.h"

namespace vpr {

/// "match monday 3/14       [#####     ]  50 %  ETA 0:12", at most `width` columns; the bar starts
/// at the same column for all steps. `total` 0: unknown, shows only the count. `seconds_left`
/// below 0: unknown, omitted.
std::string progress_text(const std::string& step, size_t done, size_t total, double seconds_left,
                          size_t width);

/// Throws Error(output).
void write_to_stdout(const std::string& text);

/// Writes to stderr. A failure, as on a full disk, changes nothing else.
void write_to_stderr(const std::string& text);

/// Draws on stderr if it is a terminal. Thread-safe.
class ProgressLine {
 public:
  explicit ProgressLine(bool enabled);
  ~ProgressLine();
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  /// The first word of `step` is the step, the others are its part (part_of in base/monitor.h).
  void show(const std::string& step, size_t done, size_t total);
  /// Erases the line before other output on stdout or stderr.
  void clear();

 private:
  double seconds_left(double share) const;

  std::mutex mutex_;
  bool enabled_;
  bool drawn_ = false;
  std::string step_;
  Stopwatch step_time_;
  Stopwatch since_drawn_;
  double first_share_ = 0;  ///< at the start of the step
  double last_share_ = 0;
};

}  // namespace vpr
