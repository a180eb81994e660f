// Places that the training sequences pass several times.
#include <algorithm>
#include <numeric>
#include <optional>
#include <utility>

#include "match/filter_track.h"
#include "match/zscores.h"

namespace vpr {
namespace {

constexpr size_t kMostPairs = size_t{1} << 32;

/// The passes found so far, by cell of the whole training set.
struct PassSearch {
  FilterState state;
  PathTrack track;
  size_t least_gap = 0;  ///< of a pass from the earlier one
  uint32_t least_margin = 0;
  std::optional<std::pair<size_t, size_t>> last;  ///< the last recognized cell, and its match

  uint32_t& first_pass(size_t cell) { return state.cells.first_passes[cell]; }
};

// Links the cells between two recognized ones to those between their matches `from` and `to`.
// False unless they are of one run, at most 2 least_gap apart, and fit speeds of 1/4 to 4.
bool fill_gap(PassSearch& search, size_t first, size_t last, size_t from, size_t to) {
  const auto near = static_cast<int64_t>(search.track.settings.near_keyframes);
  const auto cells = static_cast<int64_t>(last - first);
  const FilterCells& all = search.state.cells;
  const int64_t passed = static_cast<int64_t>(to) - static_cast<int64_t>(from);
  if (last - first > 2 * search.least_gap || passed < cells / 4 - near ||
      passed > 4 * cells + near || &run_of(all, first) != &run_of(all, last) ||
      &run_of(all, from) != &run_of(all, to))
    return false;
  for (int64_t k = 1; k < cells; ++k)
    search.first_pass(first + static_cast<size_t>(k)) =
        search.first_pass(static_cast<size_t>(static_cast<int64_t>(from) + passed * k / cells));
  return true;
}

// Adds the recognized keyframes of the path. PathKeyframe::frame is the cell of the keyframe.
void add_recognized(PassSearch& search, bool is_end) {
  const PathTrack& track = search.track;
  if (track.recent.empty() || track.margin < search.least_margin) return;
  const size_t settled = track.recent.size() - (is_end ? 0 : open_keyframes(track));
  for (size_t k = track.recent.size() - path_size(track); k < settled; ++k) {
    const size_t cell = track.recent[k].frame;
    if (search.first_pass(cell) != cell) continue;
    const size_t match = track.recent[k].cell;
    search.first_pass(cell) = search.first_pass(match);
    if (search.last) {
      const auto [last, last_match] = *search.last;
      if (!fill_gap(search, last, cell, last_match, match))
        fill_gap(search, last, cell, search.first_pass(last), search.first_pass(cell));
    }
    search.last = {cell, match};
  }
}

void search_run(PassSearch& search, const FrameDistances& own, const FrameStretch& stretch,
                const CellStretch& run, size_t first_of_sequence, StepCounter& counter) {
  FilterState& state = search.state;
  const DescriptorRows& rows = own.query.rows;
  std::vector<uint16_t> scores;
  size_t cell = run.first;
  for (size_t k = 0; k < stretch.count; ++k) {
    counter.add();
    const size_t frame = stretch.first_in_sequence + k;
    own.start_row(frame);
    compute_row(own, frame, scores);
    if (cell == run.first + run.count || state.cells.frames[cell] != stretch.first + k) continue;
    const size_t earlier = cell + 1 - std::min(cell + 1, search.least_gap);
    state.known = std::max(first_of_sequence, earlier);
    if (state.known > state.cells.runs.front().first) {
      advance_filter(state, scores);
      follow_keyframe(search.track, state, cell, [&](size_t place) {
        return distance_of(rows.shape.element)
            .pair(rows[frame], descriptor_of(state.cells, own, place));
      });
      add_recognized(search, false);
    }
    ++cell;
  }
  add_recognized(search, true);
}

}  // namespace

std::vector<RepeatedPlace> find_passes(std::span<const DescribedFrames> train,
                                       const TrainStatistics& statistics, uint32_t least_margin,
                                       const Monitor& monitor) {
  const size_t frames = count_frames(train);
  if (frames == 0 || frames > kMostPairs / frames) return {};
  const FilterSettings settings;
  const ScoreBasis basis = make_score_basis(statistics, settings.start_weight);
  const FrameDistances raw = frame_distances(train, {train[0].rows.first(0), {}});
  const double typical = statistics.typical_distance;
  PassSearch search;
  search.least_gap = 2 * settings.path_keyframes;
  search.least_margin = least_margin;
  search.state = start_filter(raw, settings, settings.keyframe_change * typical);
  search.track.settings = settings;
  search.track.typical_distance = typical;
  FilterCells& cells = search.state.cells;
  if (cells.places == 0) return {};
  cells.first_passes.resize(cells.decoys);
  std::iota(cells.first_passes.begin(), cells.first_passes.end(), 0U);
  std::optional<size_t> sequence;
  size_t first_of_sequence = 0;
  FrameDistances own;
  StepCounter counter(monitor, "find passes", frames);
  for (size_t r = 0; r < raw.train_runs.size(); ++r) {
    const CellStretch& run = cells.runs[r];
    if (sequence != run.sequence) {
      sequence = run.sequence;
      first_of_sequence = run.first;
      own = zscores(raw.of_query(train[run.sequence]), basis);
    }
    restart_filter(search.state);
    search.track.recent.clear();
    search.last.reset();
    search_run(search, own, raw.train_runs[r], run, first_of_sequence, counter);
  }
  std::vector<RepeatedPlace> passes;
  for (const CellStretch& run : cells.trained())
    for (size_t cell = run.first; cell < run.first + run.count; ++cell)
      if (const uint32_t first = cells.first_passes[cell]; first != cell)
        passes.push_back({cells.frames[cell], cells.frames[first]});
  return passes;
}

}  // namespace vpr
