#include "matching/live_frames.h"

#include <algorithm>
#include <cassert>

namespace vpr {
namespace {

size_t new_index(const std::vector<size_t>& kept, size_t row) {
  return static_cast<size_t>(std::lower_bound(kept.begin(), kept.end(), row) - kept.begin());
}

std::vector<size_t> rows_to_keep(const LiveFrames& live, const std::optional<size_t>* other) {
  std::vector<size_t> rows;
  if (live.state) rows = live.state->views.pending;
  if (other != nullptr && *other) rows.push_back(**other);
  std::sort(rows.begin(), rows.end());
  rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
  return rows;
}

// The state of the rows that are kept, and room for the new one.
void keep_rows(StandardizedState& state, const std::vector<size_t>& kept,
               FrameDistances distances) {
  std::vector<CommonWeights> common;
  for (const size_t row : kept) common.push_back(state.common[row]);
  common.resize(kept.size() + 1);
  state.common = std::move(common);
  for (size_t& view : state.views.pending) view = new_index(kept, view);
  state.readable = readable_flags(distances.query_runs, distances.query_frames);
  state.distances = std::move(distances);
}

}  // namespace

LiveFrames start_live(FrameDistances raw, const ScoreBasis* basis) {
  assert(raw.query_frames == 0 && raw.of_query && (basis == nullptr || !basis->offline));
  LiveFrames live;
  live.raw = raw;
  if (basis != nullptr) {
    live.state = start_standardized(std::move(raw), *basis, {});
    live.fusion = basis->fusion;
    live.fusion_state = std::make_shared<FusionState>();
  }
  live.distances =
      live.state ? fused(standardized(live.state), live.fusion, live.fusion_state) : live.raw;
  return live;
}

void add_frame(LiveFrames& live, FrameRow frame, std::optional<size_t>* other) {
  const std::vector<size_t> kept = rows_to_keep(live, other);
  const DescriptorRows rows(live.raw.query.rows.shape, live.bytes);
  std::vector<uint8_t> bytes;
  for (const size_t index : kept) bytes.insert(bytes.end(), rows[index].begin(), rows[index].end());
  bytes.insert(bytes.end(), frame.descriptor.begin(), frame.descriptor.end());
  live.bytes = std::move(bytes);
  live.unreadable.clear();  // nothing is kept of a frame that can't be read
  if (!frame.is_readable) live.unreadable.push_back(kept.size());
  live.words.assign(kept.size(), {});
  live.words.push_back(std::move(frame.words));
  FrameDistances distances = live.raw.of_query(
      {DescriptorRows(rows.shape, live.bytes), live.unreadable, nullptr, live.words});
  if (other != nullptr && *other) *other = new_index(kept, **other);
  if (live.state) keep_rows(*live.state, kept, distances);
  live.distances = live.state ? fused(standardized(live.state), live.fusion, live.fusion_state)
                              : std::move(distances);
  ++live.frames;
}

}  // namespace vpr
