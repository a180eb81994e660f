#include "recognition/elsewhere.h"

#include <algorithm>
#include <tuple>

#include "recognition/row_scan.h"
#include "recognition/stretches.h"

namespace vpr {
namespace {

constexpr size_t kSampledFrames = 10'000;

/// How many windows before and behind the query window nothing is handed on.
struct Gap {
  size_t before = 0;
  size_t behind = 0;
};

// Of a row, what is at least that far before or behind the query window.
void hand_on_far(const ScoreRow& row, const Gap& gap, const RowConsumer& consume) {
  const size_t end = row.train_window + row.scores.size();
  const size_t before = row.query_window + 1 > gap.before ? row.query_window + 1 - gap.before : 0;
  const size_t to = std::clamp(before, row.train_window, end);
  const size_t from = std::clamp(row.query_window + gap.behind, row.train_window, end);
  const auto hand_on = [&](size_t first, size_t last) {
    if (first >= last) return;
    consume({row.query_window, row.sequence, first,
             row.scores.subspan(first - row.train_window, last - first)});
  };
  hand_on(row.train_window, to);
  hand_on(from, end);
}

template <class GapOf>
void match_stretches(const DescriptorSpan& walk, size_t window_length, const GapOf& gap_of,
                     const WalkMatcher& match, const RowConsumer& consume, size_t most_pairs) {
  const FrameDistances own = frame_distances({&walk, 1}, {walk.rows.first(0), {}});
  for (const Stretch& stretch : choose_stretches(walk, walk.rows.size(), window_length, most_pairs))
    match(own.of_query(stretch.of(walk)), [&](ScoreRow row) {
      row.query_window += stretch.first;
      hand_on_far(row, gap_of(row.query_window), consume);
    });
}

/// Finds reaches by windows that are more and more frames apart.
class ReachFinder {
 public:
  ReachFinder(const DescriptorSpan& walk, size_t window_length, size_t least)
      : reaches(walk.rows.size() - window_length + 1, {walk.rows.size(), walk.rows.size()}),
        walk_(walk),
        length_(window_length),
        least_(least),
        half_(mean_distance_within(frame_distances({&walk, 1}, walk)) / 2 *
              static_cast<double>(window_length)),
        fits_(reaches.size(), 0) {
    for (const FrameRun& run : readable_runs(walk))
      for (size_t end = run.first + length_; end <= run.first + run.count; ++end)
        fits_[end - length_] = 1;
  }

  // Whether a reach may still be found by windows that are further apart.
  bool look(size_t apart) {
    bool is_open = false;
    uint64_t sum = 0;
    for (size_t window = 0; window + apart < reaches.size(); ++window) {
      sum = window == 0
                ? first_sum(apart)
                : sum - difference(window - 1, apart) + difference(window + length_ - 1, apart);
      size_t& behind = reaches[window].behind;
      size_t& before = reaches[window + apart].before;
      const bool is_other =
          fits_[window] != 0 && fits_[window + apart] != 0 && static_cast<double>(sum) >= half_;
      const size_t reach = is_other ? std::max(apart, least_) : walk_.rows.size();
      behind = std::min(behind, reach);
      before = std::min(before, reach);
      is_open = is_open || (fits_[window] != 0 && behind == walk_.rows.size()) ||
                (fits_[window + apart] != 0 && before == walk_.rows.size());
    }
    return is_open;
  }

  std::vector<PlaceReach> reaches;

 private:
  uint32_t difference(size_t frame, size_t apart) const {
    return frame_distance(walk_.rows, frame, frame + apart);
  }
  uint64_t first_sum(size_t apart) const {
    uint64_t sum = 0;
    for (size_t frame = 0; frame < length_; ++frame) sum += difference(frame, apart);
    return sum;
  }

  const DescriptorSpan& walk_;
  size_t length_;
  size_t least_;
  double half_;
  std::vector<uint8_t> fits_;
};

}  // namespace

size_t half_width(const DescriptorSpan& walk, const Monitor& monitor) {
  const size_t frames = walk.rows.size();
  const double half = mean_distance_within(frame_distances({&walk, 1}, walk)) / 2;
  const std::vector<uint8_t> readable = readable_flags(readable_runs(walk), frames);
  const size_t step = std::max<size_t>(1, frames / kSampledFrames);
  for (size_t apart = 1; apart < frames; ++apart) {
    check_stop(monitor);
    uint64_t sum = 0;
    uint64_t count = 0;
    for (size_t i = 0; i + apart < frames; i += step) {
      if (readable[i] == 0 || readable[i + apart] == 0) continue;
      sum += frame_distance(walk.rows, i, i + apart);
      ++count;
    }
    if (count > 0 && static_cast<double>(sum) >= half * static_cast<double>(count)) return apart;
  }
  return std::max<size_t>(frames, 1);
}

void match_far(const DescriptorSpan& walk, size_t window_length, size_t gap,
               const WalkMatcher& match, const RowConsumer& consume, size_t most_pairs) {
  const size_t frames = walk.rows.size();
  if (frames < window_length || gap > frames - window_length) return;
  const auto gap_of = [gap](size_t) { return Gap{gap, gap}; };
  match_stretches(walk, window_length, gap_of, match, consume, most_pairs);
}

std::vector<PlaceReach> place_reaches(const DescriptorSpan& walk, size_t window_length,
                                      const Monitor& monitor, size_t most_pairs) {
  const size_t frames = walk.rows.size();
  if (frames < window_length) return {};
  ReachFinder finder(walk, window_length, half_width(walk, monitor));
  size_t pairs = 0;
  for (size_t apart = 1; apart <= frames - window_length && pairs < most_pairs; ++apart) {
    check_stop(monitor);
    if (!finder.look(apart)) break;
    pairs += frames - apart;
  }
  return std::move(finder.reaches);
}

std::optional<ClosestWindows> closest_elsewhere(const DescriptorSpan& walk, size_t window_length,
                                                const RowKernels& kernels, const WalkMatcher& match,
                                                const Monitor& monitor, size_t most_pairs) {
  const std::vector<PlaceReach> reaches = place_reaches(walk, window_length, monitor);
  if (reaches.empty()) return std::nullopt;
  HitScan scan({{0}, reaches.size(), 0, kernels});  // no hits: only what is closest to each window
  const auto gap_of = [&](size_t window) {
    return Gap{2 * reaches[window].before + 1, 2 * reaches[window].behind + 1};
  };
  match_stretches(walk, window_length, gap_of, match, std::ref(scan), most_pairs);
  std::optional<Cell> closest;
  for (const auto& cell : scan.result().best)
    if (cell && (!closest || std::tie(cell->score, cell->query_window) <
                                 std::tie(closest->score, closest->query_window)))
      closest = *cell;
  if (!closest) return std::nullopt;
  return ClosestWindows{closest->score, closest->query_window, 0, closest->train_window};
}

}  // namespace vpr
