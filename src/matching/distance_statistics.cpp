#include "matching/distance_statistics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "base/error.h"
#include "base/parallel.h"
#include "base/random.h"

namespace vpr {
namespace {

constexpr size_t kColumns = 1024;  // training frames that are worked on at once
constexpr size_t kRows = 64;       // sampled frames that meet them at once
constexpr uint64_t kMostSamples = 1'000'000;
constexpr uint32_t kFewestDistances = 2;

/// A sampled frame and its neighbours [first, last), itself included.
struct Sample {
  CodeWords words;
  size_t first = 0;
  size_t last = 0;
};

/// Of the distances of one training frame.
struct ColumnSums {
  uint32_t count = 0;
  uint32_t sum = 0;
  uint64_t squares = 0;
};

void check_settings(const StatisticsSettings& settings) {
  if (settings.samples < 1 || settings.samples > kMostSamples)
    throw Error(ErrorKind::usage, fmt::format("statistics.samples must be from 1 to {}, found {}",
                                              kMostSamples, settings.samples));
  if (!(settings.neighbour_share >= 0 && settings.neighbour_share <= 1))
    throw Error(ErrorKind::usage,
                fmt::format("statistics.neighbour_share must be from 0 to 1, found {}",
                            settings.neighbour_share));
}

std::vector<Sample> make_samples(const TrainCodes& train, const StatisticsSettings& settings) {
  std::vector<Sample> samples;
  const std::vector<size_t> frames = sampled_frames(train, settings);
  auto frame = frames.begin();
  size_t first = 0;
  for (const CodeSpan& sequence : train.sequences) {
    const size_t end = first + sequence.codes.size();
    const auto share = static_cast<uint64_t>(
        std::floor(settings.neighbour_share * static_cast<double>(sequence.codes.size())));
    const size_t reach =
        std::min<uint64_t>(std::max(settings.neighbour_frames, share), end - first);
    for (; frame != frames.end() && *frame < end; ++frame)
      samples.push_back({code_words(sequence.codes[*frame - first]),
                         *frame - std::min(reach, *frame - first),
                         std::min(*frame + reach + 1, end)});
    first = end;
  }
  return samples;
}

/// Sums of one tile of samples, in arrays of their own so that the compiler can take several
/// columns at once: squares of kRows distances of at most 1408 bits fit 32 bits.
struct TileSums {
  std::array<uint32_t, kColumns> sum = {};
  std::array<uint32_t, kColumns> squares = {};

  void add(const uint16_t* distances, size_t from, size_t to) {
    for (size_t x = from; x < to; ++x) {
      const uint32_t distance = distances[x];
      sum[x] += distance;
      squares[x] += distance * distance;
    }
  }
};
static_assert(kRows * (8 * kLdbBytes) * (8 * kLdbBytes) <= std::numeric_limits<uint32_t>::max());

// Training frames [first, first + count) against all samples.
void sum_columns(const TrainCodes& train, const std::vector<Sample>& samples,
                 const HammingKernels& kernels, size_t first, size_t count, ColumnSums* sums) {
  const size_t blocks = (count + kBlockFrames - 1) / kBlockFrames;
  std::vector<uint16_t> distances(kRows * kColumns);
  std::vector<CodeWords> words;
  for (size_t row = 0; row < samples.size(); row += kRows) {
    const size_t rows = std::min(kRows, samples.size() - row);
    words.clear();
    for (size_t r = 0; r < rows; ++r) words.push_back(samples[row + r].words);
    kernels.tile_distances(words.data(), rows, train.blocks.data() + first / kBlockFrames, blocks,
                           distances.data(), kColumns);
    TileSums tile;
    for (size_t r = 0; r < rows; ++r) {
      const Sample& sample = samples[row + r];
      const size_t from = std::clamp(sample.first, first, first + count) - first;
      const size_t to = std::clamp(sample.last, first, first + count) - first;
      tile.add(distances.data() + r * kColumns, 0, from);
      tile.add(distances.data() + r * kColumns, to, count);
      for (size_t x = from; x < to; ++x) --sums[x].count;
    }
    for (size_t x = 0; x < count; ++x) {
      sums[x].count += static_cast<uint32_t>(rows);
      sums[x].sum += tile.sum[x];
      sums[x].squares += tile.squares[x];
    }
  }
}

std::vector<uint8_t> readable_flags(const TrainCodes& train) {
  std::vector<uint8_t> readable(train.frame_count, 0);
  for (const FrameRun& run : train.runs)
    std::fill_n(readable.begin() + static_cast<ptrdiff_t>(run.first), run.count, uint8_t{1});
  return readable;
}

double mean_of(const ColumnSums& sums) {
  return static_cast<double>(sums.sum) / static_cast<double>(sums.count);
}

// (n * sum of squares - square of the sum) / n^2; the numerator is exact below 2^64.
double variance_of(const ColumnSums& sums) {
  const uint64_t spread = sums.count * sums.squares - uint64_t{sums.sum} * sums.sum;
  return static_cast<double>(spread) /
         (static_cast<double>(sums.count) * static_cast<double>(sums.count));
}

TrainStatistics summarise(const std::vector<ColumnSums>& sums,
                          const std::vector<uint8_t>& readable) {
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
  statistics.typical_distance = known == 0 ? kUnknownDistance : means / count;
  const double variance = known == 0 ? kUnknownDeviation * kUnknownDeviation : variances / count;
  for (size_t i = 0; i < sums.size(); ++i) {
    const double bias = is_known(i) ? mean_of(sums[i]) - statistics.typical_distance : 0;
    statistics.bias.push_back(static_cast<float>(bias));
    statistics.variance.push_back(
        static_cast<float>(is_known(i) ? variance_of(sums[i]) : variance));
  }
  return statistics;
}

}  // namespace

std::vector<size_t> sampled_frames(const TrainCodes& train, const StatisticsSettings& settings) {
  std::vector<size_t> frames;
  for (const FrameRun& run : train.runs)
    for (size_t i = 0; i < run.count; ++i) frames.push_back(run.first + i);
  if (frames.size() <= settings.samples) return frames;
  RandomEngine engine(settings.seed);
  std::vector<size_t> chosen;
  for (size_t s = 0; s < settings.samples; ++s) {
    const size_t first = s * frames.size() / settings.samples;
    const size_t last = (s + 1) * frames.size() / settings.samples;
    chosen.push_back(frames[first + uniform_below(engine, last - first)]);
  }
  return chosen;
}

TrainStatistics compute_statistics(const TrainCodes& train, const StatisticsSettings& settings,
                                   const HammingKernels& kernels, const Monitor& monitor) {
  check_settings(settings);
  const std::vector<Sample> samples = make_samples(train, settings);
  std::vector<ColumnSums> sums(train.frame_count);
  const size_t parts = (train.frame_count + kColumns - 1) / kColumns;
  StepCounter counter(monitor, "statistics", parts);
  parallel_for(parts, monitor, [&](size_t part) {
    const size_t first = part * kColumns;
    sum_columns(train, samples, kernels, first, std::min(kColumns, train.frame_count - first),
                sums.data() + first);
    counter.add();
  });
  TrainStatistics statistics = summarise(sums, readable_flags(train));
  statistics.settings = settings;
  return statistics;
}

}  // namespace vpr
