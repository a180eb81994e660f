// Progress on a terminal: one line that is drawn again, with the time left.
#pragma once

#include <cstddef>
#include <mutex>
#include <string>

#include "base/stopwatch.h"

namespace vpr {

/// Draws on stderr, only if that is a terminal. Thread-safe.
class ProgressLine {
 public:
  explicit ProgressLine(bool enabled);
  ~ProgressLine();
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  void show(const std::string& step, size_t done, size_t total);
  /// Takes the line away, so that something else can be printed.
  void clear();

 private:
  std::mutex mutex_;
  bool enabled_;
  bool drawn_ = false;
  std::string step_;
  Stopwatch step_time_;
  Stopwatch since_drawn_;
  size_t last_done_ = 0;
};

}  // namespace vpr
