#include "matching/views.h"

#include <algorithm>

#include "matching/standardization.h"

namespace vpr {

std::vector<uint32_t> view_starts(const DescriptorSpan& sequence, double typical_distance) {
  ViewQueue views = make_view_queue({}, typical_distance);
  std::vector<uint32_t> starts;
  for (size_t frame = 0; frame < sequence.rows.size(); ++frame) {
    const auto& gaps = sequence.unreadable;
    const bool is_readable = !std::binary_search(gaps.begin(), gaps.end(), frame);
    const bool is_new = is_readable && is_new_view(views, sequence.rows, frame);
    if (is_new) push_view(views, frame);
    if (is_new || frame == 0) starts.push_back(static_cast<uint32_t>(frame));
  }
  return starts;
}

}  // namespace vpr
