#include "progress.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include <fmt/format.h>
#include <unistd.h>

namespace vpr {
namespace {

constexpr double kRedrawMs = 100;
constexpr size_t kBarWidth = 24;

std::string duration_text(double seconds) {
  const auto whole = std::lround(seconds);
  return whole >= 3600 ? fmt::format("{}:{:02}:{:02}", whole / 3600, whole / 60 % 60, whole % 60)
                       : fmt::format("{}:{:02}", whole / 60, whole % 60);
}

std::string line_text(const std::string& step, size_t done, size_t total, double elapsed_s) {
  if (total == 0) return fmt::format("{} {}", step, done);
  done = std::min(done, total);
  const double share = static_cast<double>(done) / static_cast<double>(total);
  const auto filled = static_cast<size_t>(share * kBarWidth);
  const std::string left = done == 0 ? "?" : duration_text(elapsed_s / share - elapsed_s);
  return fmt::format("{:<9}[{}{}] {:3.0f} %  {}/{}  ETA {}", step, std::string(filled, '#'),
                     std::string(kBarWidth - filled, ' '), 100 * share, done, total, left);
}

}  // namespace

ProgressLine::ProgressLine(bool enabled) : enabled_(enabled && ::isatty(STDERR_FILENO) != 0) {}

ProgressLine::~ProgressLine() { clear(); }

void ProgressLine::show(const std::string& step, size_t done, size_t total) {
  if (!enabled_) return;
  const std::lock_guard lock(mutex_);
  if (step != step_ || done < last_done_ / 2) {
    step_ = step;
    step_time_ = {};
  }
  last_done_ = done;
  if (drawn_ && since_drawn_.elapsed_ms() < kRedrawMs) return;
  since_drawn_ = {};
  drawn_ = true;
  fmt::print(stderr, "\r\x1b[K{}", line_text(step, done, total, step_time_.elapsed_s()));
  std::fflush(stderr);
}

void ProgressLine::clear() {
  if (!enabled_) return;
  const std::lock_guard lock(mutex_);
  if (drawn_) fmt::print(stderr, "\r\x1b[K");
  std::fflush(stderr);
  drawn_ = false;
}

}  // namespace vpr
