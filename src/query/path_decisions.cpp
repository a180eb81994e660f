#include "query/path_decisions.h"

#include <algorithm>
#include <cassert>
#include <limits>

namespace vpr {

std::vector<Cell> PathDecisions::take(const PathReport& report) {
  margin_ = report.margin;
  while (!open_.empty() && open_.front().query_window < report.first) open_.pop_front();
  for (const Cell& match : report.matches) {
    if (match.query_window < report.first) continue;
    const size_t index = open_.empty() ? 0 : match.query_window - open_.front().query_window;
    assert(index <= open_.size());  // a recognized frame has no later report
    if (index == open_.size()) open_.emplace_back();
    open_[index] = match;
  }
  return pop_before(report.settled);
}

std::vector<Cell> PathDecisions::finish() { return pop_before(std::numeric_limits<size_t>::max()); }

std::vector<Cell> PathDecisions::pop_before(size_t frame) {
  std::vector<Cell> recognized;
  while (margin_ >= least_margin_ && !open_.empty() && open_.front().query_window < frame) {
    recognized.push_back(open_.front());
    open_.pop_front();
  }
  return recognized;
}

std::vector<uint32_t> settled_margins(std::vector<PathReport> steps) {
  std::vector<uint32_t> margins(steps.size());
  if (!steps.empty()) steps.back().settled = steps.size();
  std::deque<size_t> best;  // steps that recognize the frame, with decreasing margins
  size_t next = 0;          // the first step that was not considered
  for (size_t frame = 0; frame < steps.size(); ++frame) {
    if (steps[frame].path == 0) continue;
    next = std::max(next, frame);
    for (; next < steps.size() && steps[next].path != 0 && steps[next].first <= frame; ++next) {
      while (!best.empty() && steps[best.back()].margin <= steps[next].margin) best.pop_back();
      best.push_back(next);
    }
    while (!best.empty() && steps[best.front()].settled <= frame) best.pop_front();
    if (!best.empty()) margins[frame] = steps[best.front()].margin;
  }
  return margins;
}

}  // namespace vpr
