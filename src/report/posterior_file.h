// Posteriors of FAB-MAP (.npy, float64): a row a query frame, a column for the new place and one a
// view.
#pragma once

#include <span>

#include "base/json_fwd.h"
#include "base/monitor.h"
#include "base/output.h"

namespace vpr {

/// Takes the rows in the order of frames. A view that is not known yet (in loops) has 0, an
/// unreadable frame not a number.
class PosteriorFile {
 public:
  PosteriorFile(Output& file, size_t frames, size_t views);
  /// New place first; empty for an unreadable frame.
  void add(std::span<const double> posterior);
  /// What the result says of the file, when all rows are there.
  Json entry(const Monitor& monitor) const;

 private:
  Output& file_;
  size_t frames_;
  size_t columns_;
};

}  // namespace vpr
