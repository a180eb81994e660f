#include "report/frame_axis.h"

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
  for (const FrameBand& band : bands)
    if (band.sequence == match.sequence) return band.at + match.reference - band.first_frame;
  assert(false);
  return 0;
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
    for (size_t i = 0; i < band.count; ++i) {
      const size_t frame = band.first_frame + i;
      if (i > 0 && frame % step != 0) continue;
      const double position = static_cast<double>(band.at + i) + 0.5;
      if (position < end) {
        if (i > 0) continue;
        ticks.pop_back();
      }
      ticks.push_back({position, frame});
      end = position + room;
    }
  }
  return ticks;
}

}  // namespace vpr
