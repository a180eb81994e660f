// An order statistic of values that keep coming.
#pragma once

#include <functional>
#include <queue>
#include <vector>

namespace vpr {

/// Of n values that came, the one at index floor(share * (n - 1)) in rising order; O(log n) a
/// value.
class RunningQuantile {
 public:
  /// `share` in [0, 1]: 0 is the smallest, 1 the largest.
  explicit RunningQuantile(double share) : share_(share) {}
  void add(double value);
  bool is_empty() const { return below_.empty(); }
  /// Not before a value came.
  double value() const { return below_.top(); }

 private:
  double share_;
  std::priority_queue<double> below_;  // up to the value, which is its largest
  std::priority_queue<double, std::vector<double>, std::greater<>> above_;
};

}  // namespace vpr
