// Places that the training sequences pass several times.
#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <optional>
#include <utility>

#include "match/filter_track.h"
#include "match/row_kernels.h"
#include "match/zscores.h"

namespace vpr {
namespace {

constexpr size_t kSampleStep = 4;      // keyframes per keyframe of the coarse filter
constexpr size_t kSampledRows = 1024;  // whose z-scores are relative to a common past

// Keyframes that are followed before and after a similar one, while statistics are learned and a
// path gathers evidence.
constexpr size_t kFollowedBefore = 96;
constexpr size_t kFollowedAfter = 32;

// Evidence by which sampled keyframes must be closer to a path of the training sequences than to
// any reversed one, in units of values.
constexpr uint32_t kLeastLead = 6 * kScoreUnit;

/// Every keyframe, or every fourth one: columns of z-scores, and queries. Cells of the filter refer
/// to columns instead of frames.
struct Keyframes {
  size_t least_gap = 0;          ///< of a pass from the earlier one
  std::vector<uint32_t> frames;  ///< of columns, in all training frames
  std::vector<uint8_t> bytes;    ///< of their descriptors
  DescriptorRows rows;
  FrameDistances distances;  ///< to the columns
  ScoreBasis basis;
  FilterState filter;
};

/// The passes found so far.
struct PassSearch {
  std::span<const DescribedFrames> train;
  const TrainStatistics* statistics = nullptr;
  std::vector<uint32_t> learned;  ///< keyframes of z-scores, in all training frames
  Keyframes all;
  PathTrack track;
  uint32_t least_margin = 0;
  std::optional<std::pair<size_t, size_t>> last;  ///< the last recognized cell, and its match

  uint32_t& first_pass(size_t cell) { return all.filter.cells.first_passes[cell]; }
};

// Links the cells between two recognized ones to those between their matches `from` and `to`. False
// unless they are of one run, at most 2 least_gap apart, and fit speeds of 1/4 to 4.
bool fill_gap(PassSearch& search, size_t first, size_t last, size_t from, size_t to) {
  const auto near = static_cast<int64_t>(search.track.settings.near_keyframes);
  const auto cells = static_cast<int64_t>(last - first);
  const FilterCells& all = search.all.filter.cells;
  const int64_t passed = static_cast<int64_t>(to) - static_cast<int64_t>(from);
  if (last - first > 2 * search.all.least_gap || passed < cells / 4 - near ||
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

ScoreBasis basis_of_columns(const ScoreBasis& basis, std::span<const uint32_t> frames) {
  ScoreBasis columns = basis;
  columns.mean.clear();
  for (const uint32_t frame : frames) columns.mean.push_back(basis.mean[frame]);
  for (size_t k = 0; k < kMaxComponents; ++k) {
    columns.components.loadings[k].clear();
    for (const uint32_t frame : frames)
      columns.components.loadings[k].push_back(basis.components.loadings[k][frame]);
  }
  return columns;
}

// Frames count over all sequences, and increase.
std::vector<uint8_t> descriptors_of(std::span<const DescribedFrames> train,
                                    std::span<const uint32_t> frames) {
  std::vector<uint8_t> bytes;
  bytes.reserve(frames.size() * train.front().rows.shape.row_bytes());
  size_t first = 0;
  auto frame = frames.begin();
  for (const DescribedFrames& sequence : train) {
    for (; frame != frames.end() && *frame < first + sequence.rows.size(); ++frame) {
      const DescriptorRow row = sequence.rows[*frame - first];
      bytes.insert(bytes.end(), row.begin(), row.end());
    }
    first += sequence.rows.size();
  }
  return bytes;
}

// The keyframes of z-scores.
std::vector<uint32_t> learned_frames(std::span<const DescribedFrames> train,
                                     double typical_distance) {
  std::vector<uint32_t> frames;
  size_t first = 0;
  for (const DescribedFrames& sequence : train) {
    for (const uint32_t frame : keyframe_starts(sequence, typical_distance))
      frames.push_back(static_cast<uint32_t>(first + frame));
    first += sequence.rows.size();
  }
  return frames;
}

// Every step-th keyframe of each run.
Keyframes make_keyframes(std::span<const DescribedFrames> train, const FilterCells& cells,
                         const ScoreBasis& basis, const FilterSettings& settings, size_t step) {
  Keyframes keyframes;
  keyframes.least_gap = 2 * FilterSettings{}.path_keyframes / step;
  FilterCells sampled;
  for (CellStretch run : cells.trained()) {
    sampled.frames.resize(sampled.size() + kLongestStep, 0);
    const size_t first = sampled.size();
    for (size_t cell = run.first; cell < run.first + run.count; cell += step) {
      sampled.frames.push_back(static_cast<uint32_t>(keyframes.frames.size()));
      keyframes.frames.push_back(cells.frames[cell]);
    }
    run.count = sampled.size() - first;
    run.first = first;
    sampled.runs.push_back(run);
    sampled.places += run.count;
  }
  add_decoys(sampled);
  keyframes.bytes = descriptors_of(train, keyframes.frames);
  keyframes.rows = {train.front().rows.shape, keyframes.bytes};
  const DescribedFrames columns{keyframes.rows, {}};
  keyframes.distances = frame_distances({&columns, 1}, {keyframes.rows.first(0), {}});
  keyframes.basis = basis_of_columns(basis, keyframes.frames);
  keyframes.filter = start_filter(std::move(sampled), settings);
  return keyframes;
}

// The frames of cells of a run, and those that are learned between them.
std::vector<uint32_t> queries_of(const Keyframes& keyframes, CellRange range,
                                 std::span<const uint32_t> learned) {
  const auto first = keyframes.frames.begin() + keyframes.filter.cells.frames[range.first];
  const auto last = first + static_cast<ptrdiff_t>(range.last - range.first);
  const auto begin = std::ranges::lower_bound(learned, *first);
  std::vector<uint32_t> queries;
  std::set_union(first, last, begin, std::lower_bound(begin, learned.end(), *(last - 1)),
                 std::back_inserter(queries));
  return queries;
}

// The z-scores of the rows of frames to the first columns.
FrameDistances scores_of(const PassSearch& search, const Keyframes& keyframes,
                         const DescriptorRows& rows, std::span<const uint32_t> frames,
                         size_t columns) {
  FrameDistances distances = keyframes.distances.of_query({rows, {}});
  distances.train_frames = columns;
  distances.readable_frames = columns;
  // The mean distance to all frames, not only to these columns.
  distances.row_total = [&search, frames, columns](size_t query) {
    const TrainStatistics& statistics = *search.statistics;
    const double mean = statistics.typical_distance + statistics.bias[frames[query]];
    return static_cast<uint64_t>(std::llround(mean * static_cast<double>(columns)));
  };
  ScoreBasis basis = keyframes.basis;
  basis.mean.resize(columns);
  for (std::vector<int8_t>& loadings : basis.components.loadings) loadings.resize(columns);
  return zscores(read_ahead(std::move(distances)), basis);
}

// Passes cells of a run through the filter, as queries of cells at least least_gap earlier and of
// the sequences before the cell `of_sequence`. Calls use(cell) after each.
template <class Use>
void advance_cells(const PassSearch& search, Keyframes& keyframes, CellRange range,
                   std::span<const uint32_t> learned, size_t of_sequence, StepCounter& counter,
                   const Use& use) {
  FilterState& filter = keyframes.filter;
  const std::vector<uint32_t> queries = queries_of(keyframes, range, learned);
  const std::vector<uint8_t> bytes = descriptors_of(search.train, queries);
  const FrameDistances scores =
      scores_of(search, keyframes, {keyframes.rows.shape, bytes}, queries,
                filter.cells.frames[range.first] + range.last - range.first);
  std::vector<uint16_t> row;
  size_t cell = range.first;
  for (size_t query = 0; query < queries.size(); ++query) {
    scores.start_row(query);
    compute_row(scores, query, row);
    if (queries[query] != keyframes.frames[filter.cells.frames[cell]]) continue;
    counter.add();
    const size_t earlier = cell + 1 - std::min(cell + 1, keyframes.least_gap);
    filter.known = std::max(of_sequence, earlier);
    if (filter.known > filter.cells.runs.front().first) {
      advance_filter(filter, row);
      use(cell);
    }
    ++cell;
  }
}

// The first cell of the sequence of a run.
size_t sequence_start(const FilterCells& cells, const CellStretch& run) {
  return std::ranges::find(cells.trained(), run.sequence, &CellStretch::sequence)->first;
}

// Adds cells [first, last), which do not begin before the last range. Ranges that meet become one.
void add_range(std::vector<CellRange>& ranges, size_t first, size_t last) {
  if (!ranges.empty() && first <= ranges.back().last)
    ranges.back().last = std::max(ranges.back().last, last);
  else
    ranges.push_back({first, last});
}

// The cells of each run that may be passes of an earlier place: near a sampled keyframe that a
// filter over sampled keyframes finds closer to a path of the training sequences than to any
// reversed one.
std::vector<std::vector<CellRange>> similar_cells(const PassSearch& search, Keyframes sampled,
                                                  const Monitor& monitor) {
  const FilterCells& cells = sampled.filter.cells;
  StepCounter counter(monitor, "find similar places", cells.places);
  std::vector<std::vector<CellRange>> similar;
  for (size_t r = 0; r < cells.runs.size() / 2; ++r) {
    const CellStretch& run = cells.runs[r];
    const CellStretch& all = search.all.filter.cells.runs[r];
    std::vector<CellRange>& ranges = similar.emplace_back();
    restart_filter(sampled.filter);
    const size_t end = run.first + run.count;
    for (size_t first = run.first; first < end; first += kSampledRows)
      advance_cells(search, sampled, {first, std::min(first + kSampledRows, end)}, {},
                    sequence_start(cells, run), counter, [&](size_t cell) {
                      const std::span<const uint32_t> values = sampled.filter.values;
                      const uint32_t forward = minimum_of(values.first(cells.decoys));
                      if (forward + kLeastLead > minimum_of(values.subspan(cells.decoys))) return;
                      const size_t at = all.first + (cell - run.first) * kSampleStep;
                      add_range(ranges, std::max(at, all.first + kFollowedBefore) - kFollowedBefore,
                                std::min(at + kFollowedAfter, all.first + all.count));
                    });
  }
  return similar;
}

void follow_cells(PassSearch& search, CellRange range, size_t of_sequence, StepCounter& counter) {
  Keyframes& all = search.all;
  restart_filter(all.filter);
  search.track.recent.clear();
  advance_cells(search, all, range, search.learned, of_sequence, counter, [&](size_t cell) {
    const std::vector<uint32_t>& columns = all.filter.cells.frames;
    follow_keyframe(search.track, all.filter, cell, [&](size_t place) {
      return frame_distance(all.rows, columns[cell], columns[place]);
    });
    add_recognized(search, false);
  });
  add_recognized(search, true);
}

}  // namespace

std::vector<RepeatedPlace> find_passes(std::span<const DescribedFrames> train,
                                       const TrainStatistics& statistics, uint32_t least_margin,
                                       const Monitor& monitor, size_t exhaustive_places) {
  FrameDistances frames;  // without kernels
  frames.train.assign(train.begin(), train.end());
  frames.train_runs = readable_runs(train);
  FilterSettings settings;
  const FilterCells places =
      find_cells(frames, settings.keyframe_change * statistics.typical_distance);
  if (places.places == 0) return {};
  const ScoreBasis basis = make_score_basis(statistics, settings.start_weight);
  PassSearch search;
  search.train = train;
  search.statistics = &statistics;
  search.learned = learned_frames(train, statistics.typical_distance);
  search.all = make_keyframes(train, places, basis, settings, 1);
  search.track.settings = settings;
  search.track.typical_distance = statistics.typical_distance;
  search.least_margin = least_margin;
  FilterCells& cells = search.all.filter.cells;
  cells.first_passes.resize(cells.decoys);
  std::iota(cells.first_passes.begin(), cells.first_passes.end(), 0U);
  std::vector<std::vector<CellRange>> followed;  // of each run
  if (places.places <= exhaustive_places) {
    for (const CellStretch& run : cells.trained())
      followed.push_back({{run.first, run.first + run.count}});
  } else {
    settings.path_keyframes = 0;  // the coarse filter keeps no earlier values
    followed =
        similar_cells(search, make_keyframes(train, places, basis, settings, kSampleStep), monitor);
  }
  size_t count = 0;
  for (const std::vector<CellRange>& ranges : followed)
    for (const CellRange& range : ranges) count += range.last - range.first;
  StepCounter counter(monitor, "find passes", count);
  for (size_t r = 0; r < followed.size(); ++r) {
    search.last.reset();
    for (const CellRange& range : followed[r])
      follow_cells(search, range, sequence_start(cells, cells.runs[r]), counter);
  }
  std::vector<RepeatedPlace> passes;
  for (const CellStretch& run : cells.trained())
    for (size_t cell = run.first; cell < run.first + run.count; ++cell)
      if (const uint32_t first = cells.first_passes[cell]; first != cell)
        passes.push_back(
            {search.all.frames[cells.frames[cell]], search.all.frames[cells.frames[first]]});
  return passes;
}

}  // namespace vpr
