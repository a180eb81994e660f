#include "progress.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "base/error.h"
#include "base/text.h"

namespace vpr {
namespace {

constexpr double kRedrawMs = 100;
constexpr size_t kBarWidth = 24;      // less on a narrow terminal
constexpr size_t kNumbersWidth = 20;  // " [", "] 100 %", "  ETA 12:34"
constexpr size_t kLabelWidth = 30;
constexpr size_t kUsualWidth = 80;
// Minimum for an estimate of the remaining time.
constexpr double kLeastSeconds = 1;
constexpr double kLeastShare = 0.02;

std::string duration_text(double seconds) {
  const auto whole = std::lround(seconds);
  return whole >= 3600 ? fmt::format("{}:{:02}:{:02}", whole / 3600, whole / 60 % 60, whole % 60)
                       : fmt::format("{}:{:02}", whole / 60, whole % 60);
}

std::string first_word(const std::string& text) { return text.substr(0, text.find(' ')); }

double share_of(size_t done, size_t total) {
  return total == 0 ? 0 : static_cast<double>(std::min(done, total)) / static_cast<double>(total);
}

// Long names lose their beginning, because the end and the number distinguish parts.
std::string label_text(const std::string& step) {
  std::string label = printable_line(step);
  if (label.size() > kLabelWidth) {
    const std::string begin = first_word(step).substr(0, kLabelWidth / 2) + " ...";
    size_t from = label.size() - (kLabelWidth - begin.size());
    while (from < label.size() && !starts_letter(label[from])) ++from;
    label = begin + label.substr(from);
  }
  return fmt::format("{:<{}}", label, kLabelWidth);
}

size_t terminal_width() {
  winsize size{};
  const bool known = ::ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0;
  return known ? size.ws_col : kUsualWidth;
}

}  // namespace

std::string progress_text(const std::string& step, size_t done, size_t total, double seconds_left,
                          size_t width) {
  std::string text = label_text(step);
  if (total == 0) {
    text += fmt::format(" {}", done);
  } else {
    const double share = share_of(done, total);
    const size_t other = text.size() + kNumbersWidth;
    const size_t bar = std::clamp<size_t>(width - std::min(width, other), 4, kBarWidth);
    const auto filled = static_cast<size_t>(share * static_cast<double>(bar));
    text += fmt::format(" [{}{}] {:3.0f} %", std::string(filled, '#'),
                        std::string(bar - filled, ' '), 100 * share);
    if (seconds_left >= 0) text += fmt::format("  ETA {}", duration_text(seconds_left));
  }
  return text.substr(0, width);
}

ProgressLine::ProgressLine(bool enabled) : enabled_(enabled && ::isatty(STDERR_FILENO) != 0) {}

ProgressLine::~ProgressLine() { clear(); }

double ProgressLine::seconds_left(double share) const {
  const double elapsed_s = step_time_.elapsed_s();
  const double gone = share - first_share_;
  if (elapsed_s < kLeastSeconds || gone < kLeastShare || share >= 1) return -1;
  return elapsed_s / gone * (1 - share);
}

void write_to_stdout(const std::string& text) {
  const bool written =
      std::fwrite(text.data(), 1, text.size(), stdout) == text.size() && std::fflush(stdout) == 0;
  if (!written)
    throw Error(ErrorKind::output, "standard output: cannot be written: {}",
                system_error_text(errno));
}

void write_to_stderr(const std::string& text) {
  std::fwrite(text.data(), 1, text.size(), stderr);
  std::fflush(stderr);
}

void ProgressLine::show(const std::string& step, size_t done, size_t total) {
  if (!enabled_) return;
  const std::lock_guard lock(mutex_);
  const double share = share_of(done, total);
  if (first_word(step) != step_ || share < last_share_ / 2) {  // threads report out of order
    step_ = first_word(step);
    step_time_ = {};
    first_share_ = share;
  }
  last_share_ = share;
  if (drawn_ && since_drawn_.elapsed_ms() < kRedrawMs) return;
  since_drawn_ = {};
  drawn_ = true;
  // A line that fills the last column wraps, and its first row is not erased.
  write_to_stderr("\r\x1b[K" +
                  progress_text(step, done, total, seconds_left(share), terminal_width() - 1));
}

void ProgressLine::clear() {
  if (!enabled_) return;
  const std::lock_guard lock(mutex_);
  if (drawn_) write_to_stderr("\r\x1b[K");
  drawn_ = false;
}

}  // namespace vpr
