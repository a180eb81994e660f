#include "report/frame_axis.h"

#include <algorithm>
#include <cassert>

namespace vpr {

std::vector<FrameBand> frame_bands(const ScoreLayout& layout) {
  std::vector<FrameBand> bands;
  for (const ScoreLayout::Columns& columns : layout.columns) {
    const auto& sequence = layout.scope.sequences[columns.sequence];
    bands.push_back({sequence.name, columns.sequence, length_of(bands), 0, sequence.frames});
  }
  return bands;
}

std::vector<FrameBand> column_bands(const ScoreLayout& layout) {
  std::vector<FrameBand> bands;
  for (const ScoreLayout::Columns& columns : layout.columns)
    bands.push_back({layout.scope.sequences[columns.sequence].name, columns.sequence, columns.first,
                     layout.anchor(0), columns.count});
  return bands;
}

std::vector<FrameBand> row_bands(const ScoreLayout& layout) {
  return {{"", 0, 0, layout.anchor(0), row_count(layout)}};
}

size_t length_of(const std::vector<FrameBand>& bands) {
  return bands.empty() ? 0 : bands.back().at + bands.back().count;
}

size_t position_of(const std::vector<FrameBand>& bands, const FrameMatch& match) {
  const auto band = std::ranges::lower_bound(bands, match.sequence, {}, &FrameBand::sequence);
  assert(band != bands.end() && band->sequence == match.sequence);
  return band->at + match.reference - band->first_frame;
}

size_t round_step(size_t length, size_t most) {
  for (size_t power = 1;; power *= 10)
    for (const size_t factor : {1, 2, 5})
      if (length / (factor * power) <= most) return factor * power;
}

std::vector<AxisTick> ticks_of(const std::vector<FrameBand>& bands, size_t most) {
  const size_t step = round_step(length_of(bands), most);
  std::vector<AxisTick> ticks;
  double end = -1e9;  // of the tick before, with the room that its label takes
  const double room = static_cast<double>(step) * 0.45;
  for (const FrameBand& band : bands) {
    const size_t behind = band.first_frame + band.count;
    for (size_t frame = band.first_frame; frame < behind; frame = (frame / step + 1) * step) {
      const size_t at = band.at + frame - band.first_frame;
      const double position = static_cast<double>(at) + 0.5;
      if (position < end) {
        if (frame > band.first_frame) continue;
        ticks.pop_back();
      }
      ticks.push_back({position, frame});
      end = position + room;
    }
  }
  return ticks;
}

}  // namespace vpr
