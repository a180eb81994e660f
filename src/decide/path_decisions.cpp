#include "decide/path_decisions.h"

#include <algorithm>
#include <limits>

namespace vpr {

std::vector<PathMatch> PathDecisions::take(const PathReport& report) {
  if (report.path != path_) open_.clear();
  path_ = report.path;
  margin_ = report.margin;
  for (const PathMatch& match : report.matches) {
    const size_t first = open_.empty() ? match.query : open_.front().query;
    if (match.query < first) continue;  // recognized
    if (match.query - first == open_.size()) open_.emplace_back();
    open_[match.query - first] = match;
  }
  while (!open_.empty() && open_.front().query < report.first) open_.pop_front();
  return pop_before(report.settled);
}

std::vector<PathMatch> PathDecisions::finish() {
  return pop_before(std::numeric_limits<size_t>::max());
}

std::vector<PathMatch> PathDecisions::pop_before(size_t frame) {
  std::vector<PathMatch> recognized;
  while (margin_ >= least_margin_ && !open_.empty() && open_.front().query < frame) {
    recognized.push_back(open_.front());
    open_.pop_front();
  }
  return recognized;
}

std::vector<uint32_t> settled_margins(std::vector<PathStep> steps) {
  std::vector<uint32_t> margins(steps.size());
  if (!steps.empty()) steps.back().settled = steps.size();
  std::deque<size_t> best;  // steps that recognize the frame, with decreasing margins
  size_t next = 0;          // the first step that was not considered
  for (size_t frame = 0; frame < steps.size(); ++frame) {
    const uint32_t path = steps[frame].path;
    if (path == 0) continue;
    if (frame == 0 || steps[frame - 1].path != path) {
      best.clear();
      next = frame;
    }
    for (; next < steps.size() && steps[next].path == path && steps[next].first <= frame; ++next) {
      while (!best.empty() && steps[best.back()].margin <= steps[next].margin) best.pop_back();
      best.push_back(next);
    }
    while (!best.empty() && steps[best.front()].settled <= frame) best.pop_front();
    if (!best.empty()) margins[frame] = steps[best.front()].margin;
  }
  return margins;
}

}  // namespace vpr
