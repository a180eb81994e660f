#include "match/distance_statistics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "base/error.h"
#include "base/parallel.h"
#include "base/random.h"

namespace vpr {
namespace {

constexpr size_t kColumns = 1024;  // training frames per task
constexpr size_t kRows = 64;       // sampled frames per tile
constexpr uint32_t kFewestDistances = 2;

// Large sets have fewer samples than the settings allow: this number of pairs of frames, but at
// least kFewestSamples samples.
constexpr size_t kMostPairs = 100'000'000;
constexpr size_t kFewestSamples = 2000;

/// The neighbors [first, last) of a sampled frame, including itself.
struct Neighbors {
  size_t first = 0;
  size_t last = 0;
};

/// The sampled frames as a query.
struct Samples {
  std::vector<uint8_t> bytes;
  std::vector<Neighbors> neighbors;
};

/// Sums over the distances of one training frame.
struct ColumnSums {
  uint32_t count = 0;
  uint64_t sum = 0;
  uint64_t squares = 0;
};

Samples make_samples(std::span<const DescribedFrames> train, const StatisticsSettings& settings) {
  Samples samples;
  const std::vector<size_t> frames = sampled_frames(train, settings);
  auto frame = frames.begin();
  size_t first = 0;
  for (const DescribedFrames& sequence : train) {
    const size_t end = first + sequence.rows.size();
    const auto share = static_cast<uint64_t>(
        std::floor(settings.neighbor_share * static_cast<double>(sequence.rows.size())));
    const size_t reach = std::min<uint64_t>(std::max(settings.neighbor_frames, share), end - first);
    for (; frame != frames.end() && *frame < end; ++frame) {
      const DescriptorRow row = sequence.rows[*frame - first];
      samples.bytes.insert(samples.bytes.end(), row.begin(), row.end());
      samples.neighbors.push_back(
          {*frame - std::min(reach, *frame - first), std::min(*frame + reach + 1, end)});
    }
    first = end;
  }
  return samples;
}

/// Sums of one tile of samples, in separate arrays so that the compiler can vectorize over columns.
struct TileSums {
  std::array<uint32_t, kColumns> sum = {};
  std::array<uint64_t, kColumns> squares = {};

  void add(const uint16_t* distances, size_t from, size_t to) {
    for (size_t x = from; x < to; ++x) {
      const uint32_t distance = distances[x];
      sum[x] += distance;
      const uint32_t square = distance * distance;  // of 16 bits, so that it fits
      squares[x] += square;
    }
  }
};

// Compares training frames [first, first + count) with all samples.
void sum_columns(const FrameDistances& distances, const std::vector<Neighbors>& neighbors,
                 size_t first, size_t count, ColumnSums* sums) {
  std::vector<uint16_t> values(kRows * kColumns);
  for (size_t row = 0; row < neighbors.size(); row += kRows) {
    const size_t rows = std::min(kRows, neighbors.size() - row);
    std::array<uint32_t, kRows> queries;
    std::iota(queries.begin(), queries.end(), static_cast<uint32_t>(row));
    distances.tile(std::span(queries).first(rows), first, first + count, values.data(), kColumns);
    TileSums tile;
    for (size_t r = 0; r < rows; ++r) {
      const Neighbors& near = neighbors[row + r];
      const size_t from = std::clamp(near.first, first, first + count) - first;
      const size_t to = std::clamp(near.last, first, first + count) - first;
      tile.add(values.data() + r * kColumns, 0, from);
      tile.add(values.data() + r * kColumns, to, count);
      for (size_t x = from; x < to; ++x) --sums[x].count;
    }
    for (size_t x = 0; x < count; ++x) {
      sums[x].count += static_cast<uint32_t>(rows);
      sums[x].sum += tile.sum[x];
      sums[x].squares += tile.squares[x];
    }
  }
}

double mean_of(const ColumnSums& sums) {
  return static_cast<double>(sums.sum) / static_cast<double>(sums.count);
}

// (n * sum of squares - square of the sum) / n^2, whose numerator is exact.
double variance_of(const ColumnSums& sums) {
  __extension__ using Wide = unsigned __int128;
  const Wide spread = Wide{sums.count} * sums.squares - Wide{sums.sum} * sums.sum;
  return static_cast<double>(spread) /
         (static_cast<double>(sums.count) * static_cast<double>(sums.count));
}

TrainStatistics summarize(const std::vector<ColumnSums>& sums, const std::vector<uint8_t>& readable,
                          uint16_t largest) {
  const auto is_known = [&](size_t i) {
    return readable[i] != 0 && sums[i].count >= kFewestDistances;
  };
  double means = 0;
  double variances = 0;
  size_t known = 0;
  for (size_t i = 0; i < sums.size(); ++i) {
    if (!is_known(i)) continue;
    means += mean_of(sums[i]);
    variances += variance_of(sums[i]);
    ++known;
  }
  const auto count = static_cast<double>(known);
  TrainStatistics statistics;
  statistics.typical_distance = known == 0 ? unknown_distance(largest) : means / count;
  const double unknown = unknown_deviation(largest);
  const double variance = known == 0 ? unknown * unknown : variances / count;
  for (size_t i = 0; i < sums.size(); ++i) {
    const double bias = is_known(i) ? mean_of(sums[i]) - statistics.typical_distance : 0;
    statistics.bias.push_back(static_cast<float>(bias));
    statistics.variance.push_back(
        static_cast<float>(is_known(i) ? variance_of(sums[i]) : variance));
  }
  return statistics;
}

}  // namespace

std::vector<size_t> sampled_frames(std::span<const DescribedFrames> train,
                                   const StatisticsSettings& settings) {
  std::vector<size_t> frames;
  for (const FrameStretch& run : readable_runs(train))
    for (size_t i = 0; i < run.count; ++i) frames.push_back(run.first + i);
  if (frames.size() <= settings.samples) return frames;
  const size_t samples =
      std::min<size_t>(settings.samples, std::max(kFewestSamples, kMostPairs / frames.size()));
  RandomEngine engine(settings.seed);
  std::vector<size_t> chosen;
  for (size_t s = 0; s < samples; ++s) {
    const size_t first = s * frames.size() / samples;
    const size_t last = (s + 1) * frames.size() / samples;
    chosen.push_back(frames[first + uniform_below(engine, last - first)]);
  }
  return chosen;
}

TrainStatistics compute_statistics(std::span<const DescribedFrames> train,
                                   const StatisticsSettings& settings, const Monitor& monitor) {
  require_range("statistics.samples", static_cast<double>(settings.samples), 1, 1e6);
  require_range("statistics.neighbor_share", settings.neighbor_share, 0, 1);
  const Samples samples = make_samples(train, settings);
  const DescriptorShape shape = train.empty() ? kLdbShape : train.front().rows.shape;
  const FrameDistances distances = frame_distances(train, {{shape, samples.bytes}, {}});
  const size_t frames = distances.train_frames;
  std::vector<ColumnSums> sums(frames);
  const size_t parts = divide_up(frames, kColumns);
  StepCounter counter(monitor, "statistics", parts);
  parallel_for(parts, monitor, [&](size_t part) {
    const size_t first = part * kColumns;
    sum_columns(distances, samples.neighbors, first, std::min(kColumns, frames - first),
                sums.data() + first);
    counter.add();
  });
  TrainStatistics statistics =
      summarize(sums, readable_flags(distances.train_runs, frames), distances.largest);
  statistics.settings = settings;
  return statistics;
}

}  // namespace vpr
