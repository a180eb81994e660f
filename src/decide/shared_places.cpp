#include "decide/shared_places.h"

#include <algorithm>
#include <cmath>

#include "decide/elsewhere.h"
#include "match/distance_statistics.h"
#include "match/match.h"
#include "match/zscores.h"

namespace vpr {
namespace {

constexpr size_t kWindow = 20;
constexpr size_t kShortestWindow = 4;
constexpr size_t kFewest = 10;      // one window in so many has a trace
constexpr double kLeastMargin = 3;  // deviations of a mean of independent frames
constexpr uint64_t kSamples = 1000;

/// A walk that others are looked for in.
struct Searched {
  const DescriptorSpan& walk;
  Elsewhere elsewhere;
  ScoreBasis basis;
};

Searched prepare(const DescriptorSpan& walk, uint32_t width, const Monitor& monitor) {
  StatisticsSettings settings;
  settings.samples = kSamples;
  const TrainStatistics statistics = compute_statistics({&walk, 1}, settings, monitor);
  return {walk, make_elsewhere({width}, {}), make_score_basis({}, true, statistics)};
}

/// Windows of a query that leave a trace, of those that could.
struct Traces {
  size_t windows = 0;
  size_t found = 0;
};

void add_traces(Traces& traces, const MarginScanResult& scan, size_t length) {
  const size_t apart = length / 2;
  const double least =
      kLeastMargin * kScoreUnit * std::sqrt(static_cast<double>(length));  // as a sum
  const auto is_clear = [&](size_t window) {
    return scan.margins[window] && *scan.margins[window] >= least;
  };
  for (size_t window = apart; window < scan.best.size(); ++window) {
    if (!scan.best[window] || !scan.best[window - apart]) continue;
    ++traces.windows;
    const size_t from = scan.best[window - apart]->train_window;
    const size_t to = scan.best[window]->train_window;
    const bool follows = to >= from + (apart + 1) / 2 && to <= from + apart + apart / 2;
    if (follows && is_clear(window) && is_clear(window - apart)) ++traces.found;
  }
}

bool is_seen_in(const Searched& searched, const DescriptorSpan& walk, const RowKernels& kernels,
                const Monitor& monitor, size_t most_pairs) {
  const size_t length =
      std::min(kWindow, std::min(walk.rows.size(), searched.walk.rows.size()) / 2);
  if (length < kShortestWindow) return false;
  Traces traces;
  const FrameDistances distances = frame_distances({&searched.walk, 1}, {walk.rows.first(0), {}});
  for (const Stretch& stretch :
       choose_stretches(walk, searched.walk.rows.size(), length, most_pairs)) {
    MarginScan scan(searched.elsewhere, stretch.count - length + 1, kernels);
    match(zscores(distances.of_query(stretch.of(walk)), searched.basis, monitor),
          {length, kDefaultMemoryLimit, kernels}, {{}, {std::ref(scan)}}, monitor);
    add_traces(traces, scan.result(), length);
  }
  return traces.found > 0 && kFewest * traces.found >= traces.windows;
}

}  // namespace

std::vector<std::pair<size_t, size_t>> find_shared_places(std::span<const DescriptorSpan> walks,
                                                          const std::vector<uint32_t>& widths,
                                                          const RowKernels& kernels,
                                                          const Monitor& monitor,
                                                          size_t most_pairs) {
  std::vector<std::vector<uint8_t>> seen(walks.size(), std::vector<uint8_t>(walks.size(), 0));
  if (walks.size() < 2) return {};
  most_pairs /= walks.size() * (walks.size() - 1);
  for (size_t b = 0; b < walks.size(); ++b) {
    const Searched searched = prepare(walks[b], widths[b], monitor);
    for (size_t a = 0; a < walks.size(); ++a)
      seen[a][b] = a != b && is_seen_in(searched, walks[a], kernels, monitor, most_pairs);
  }
  std::vector<std::pair<size_t, size_t>> pairs;
  for (size_t a = 0; a < walks.size(); ++a)
    for (size_t b = a + 1; b < walks.size(); ++b)
      if (seen[a][b] != 0 || seen[b][a] != 0) pairs.emplace_back(a, b);
  return pairs;
}

}  // namespace vpr
