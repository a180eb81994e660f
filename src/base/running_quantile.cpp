#include "base/running_quantile.h"

#include <cmath>

namespace vpr {

void RunningQuantile::add(double value) {
  if (!below_.empty() && value < below_.top())
    below_.push(value);
  else
    above_.push(value);
  const size_t count = below_.size() + above_.size();
  const auto wanted = static_cast<size_t>(std::floor(share_ * static_cast<double>(count - 1))) + 1;
  while (below_.size() < wanted) {
    below_.push(above_.top());
    above_.pop();
  }
  while (below_.size() > wanted) {
    above_.push(below_.top());
    below_.pop();
  }
}

}  // namespace vpr
