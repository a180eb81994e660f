// Decisions along the paths of the filter: a query frame is recognized if its path has a large
// enough margin once its match is settled.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <vector>

#include "match/match.h"

namespace vpr {

/// Decides query frames as their reports arrive, in order.
class PathDecisions {
 public:
  /// `least_margin`: of a recognized frame, in units of reports.
  explicit PathDecisions(uint32_t least_margin) : least_margin_(least_margin) {}

  /// The frames that this report recognizes, each once.
  std::vector<Cell> take(const PathReport& report);

  /// The frames that the end of the query recognizes: the others of its last path.
  std::vector<Cell> finish();

  /// An unreadable frame ends the path.
  void end_path() { open_.clear(); }

 private:
  std::vector<Cell> pop_before(size_t frame);

  uint32_t least_margin_;
  uint32_t margin_ = 0;
  std::deque<Cell> open_;  ///< consecutive frames of the path that may still be recognized
};

/// By query frame: the largest margin that recognizes it, so that a least margin accepts what
/// PathDecisions recognizes. The end of the query settles all matches. `steps`: the reports by
/// query frame, without matches; path 0: an unreadable frame.
std::vector<uint32_t> settled_margins(std::vector<PathReport> steps);

}  // namespace vpr
