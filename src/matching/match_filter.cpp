#include "matching/match_filter.h"

#include <algorithm>
#include <cassert>

#include "base/parallel.h"
#include "matching/filter_track.h"

namespace vpr {
namespace {

constexpr size_t kFramesPerThread = 32768;  // below, a second thread costs more than it gives

struct FilterRun {
  FilterState filter;
  PathTrack track;
  std::vector<uint16_t> scores;  ///< of the frame to all training frames
  std::vector<uint32_t> row;     ///< values of all training frames
  std::optional<size_t> view;    ///< the last query frame that was one
};

// The scores of frames that are no view are computed, too: something may be learned from them.
void find_scores(FilterRun& run, const FrameDistances& distances, size_t frame) {
  const auto query = static_cast<uint32_t>(frame);
  distances.start_row(frame);
  const size_t frames = distances.train_frames;
  const size_t parts = std::clamp<size_t>(frames / kFramesPerThread, 1, thread_count());
  const size_t part =
      (frames / parts + kStretchFrames) / kStretchFrames * kStretchFrames;  // covers all in parts
  const auto find = [&](size_t p) {
    const size_t first = std::min(p * part, frames);
    const size_t last = std::min(first + part, frames);
    if (first < last) distances.tile({&query, 1}, first, last, run.scores.data() + first, 0);
  };
  if (parts == 1) return find(0);
  parallel_for(parts, Monitor{}, find);
}

bool shows_new_view(const FilterRun& run, const FrameDistances& distances, size_t frame) {
  const double least_change = run.filter.settings.view_change * distances.typical_distance;
  return !run.view || frame_distance(distances.query.rows, *run.view, frame) >= least_change;
}

void write_views(FilterRun& run) {
  const FilterCells& cells = run.filter.cells;
  for (const CellRun& cell_run : cells.runs)
    for (size_t cell = cell_run.first; cell < cell_run.first + cell_run.count; ++cell)
      std::fill(run.row.begin() + cells.frames[cell],
                run.row.begin() + static_cast<ptrdiff_t>(view_end(cells, cell_run, cell)),
                run.filter.values[cell]);
}

// Of the best view, one frame is better than the others.
void write_best(FilterRun& run, const PathFrame& path) {
  const FilterCells& cells = run.filter.cells;
  const uint32_t value = run.filter.values[path.cell];
  const size_t end = view_end(cells, run_of(cells, path.cell), path.cell);
  std::fill(run.row.begin() + cells.frames[path.cell],
            run.row.begin() + static_cast<ptrdiff_t>(end), value + 1);
  run.row[path.frame] = value;
}

void take_frame(FilterRun& run, const FrameDistances& distances, const MatchSettings& settings,
                size_t frame, const RowConsumer& consume) {
  find_scores(run, distances, frame);
  if (shows_new_view(run, distances, frame)) {
    run.view = frame;
    advance_filter(run.filter, run.scores);
    follow_view(run.track, run.filter, run.scores, frame);
    write_views(run);
  }
  const PathFrame path = path_at(run.track, run.filter.cells, frame);
  write_best(run, path);
  if (settings.on_path) settings.on_path({frame, path.margin, path.nowhere, path.rate});
  emit_row(distances, 1, frame, 0, run.row, consume);
}

}  // namespace

void match_filter(const FrameDistances& distances, const MatchSettings& settings,
                  const Monitor& monitor, const RowConsumer& consume) {
  assert(distances.is_in_order() && settings.window_length == 1);
  StepCounter counter(monitor, "match", distances.query_frames);
  FilterRun run;
  run.filter = start_filter(distances, settings.filter,
                            settings.filter.view_change * distances.typical_distance);
  if (run.filter.cells.places == 0) return;
  run.scores.resize(distances.train_frames + kStretchFrames);
  run.row.resize(distances.train_frames);
  for (const FrameRun& stretch : distances.query_runs) {
    restart_filter(run.filter);
    run.track = {};
    run.track.kernels = settings.kernels;
    run.track.shared = settings.shared_places;
    run.view.reset();
    for (size_t frame = stretch.first; frame < stretch.first + stretch.count; ++frame) {
      counter.add();
      take_frame(run, distances, settings, frame, consume);
    }
  }
}

}  // namespace vpr
