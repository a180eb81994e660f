#include "matching/views.h"

#include <algorithm>

#include "matching/standardization.h"

namespace vpr {

std::vector<uint32_t> view_starts(std::span<const LdbCode> codes,
                                  std::span<const size_t> unreadable, double typical_distance) {
  const StandardizationSettings settings;
  ViewQueue views{settings.view_change * typical_distance, settings.lag_views, {}};
  std::vector<uint32_t> starts;
  for (size_t frame = 0; frame < codes.size(); ++frame) {
    const bool is_readable = !std::binary_search(unreadable.begin(), unreadable.end(), frame);
    const CodeWords words = code_words(codes[frame]);
    const bool is_new = is_readable && is_new_view(views, words);
    if (is_new) push_view(views, words);
    if (is_new || frame == 0) starts.push_back(static_cast<uint32_t>(frame));
  }
  return starts;
}

}  // namespace vpr
