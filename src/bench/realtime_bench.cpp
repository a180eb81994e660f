#include "bench/realtime_bench.h"

#include <algorithm>
#include <chrono>
#include <ctime>
#include <memory>
#include <thread>

#include <fmt/format.h>
#include <opencv2/core/mat.hpp>

#include "base/error.h"
#include "base/json.h"
#include "base/statistics.h"
#include "bench/generated.h"
#include "bench/matching_timers.h"
#include "images/decode.h"
#include "matching/fastable_online.h"
#include "matching/match_filter.h"
#include "matching/rates.h"
#include "matching/standardized_frames.h"
#include "pipeline/fabmap_matcher.h"
#include "pipeline/score_basis.h"
#include "pipeline/train.h"
#include "recognition/fabmap_posterior.h"

namespace vpr {
namespace {

using Clock = std::chrono::steady_clock;

constexpr size_t kSmallestTried = 1000;
constexpr size_t kRingBytes = size_t{512} << 20;

double process_cpu_s() {
  timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_nsec) * 1e-9;
}

void check_settings(const RealtimeBenchSettings& settings) {
  if (!(settings.rate_hz > 0 && settings.rate_hz <= 10'000))
    throw Error(ErrorKind::usage,
                fmt::format("rate must be above 0 and at most 10000, found {}", settings.rate_hz));
  if (settings.frames < 1) throw Error(ErrorKind::usage, "frames must be 1 or more, found 0");
  if (!(settings.share_percent > 0 && settings.share_percent <= 100))
    throw Error(ErrorKind::usage, fmt::format("share must be above 0 and at most 100, found {}",
                                              settings.share_percent));
  if (settings.window_length < 1 || settings.window_length > kMaxWindowLength)
    throw Error(ErrorKind::usage, fmt::format("c_l must be from 1 to {}, found {}",
                                              kMaxWindowLength, settings.window_length));
}

void check_described(const SequenceDatabase& database) {
  const std::string_view name = database.descriptors.kind->name;
  if (name != "ldb")
    throw Error(ErrorKind::usage,
                fmt::format("a replay describes frames by ldb, but the database by {}", name));
  if (database.descriptor.illumination_invariant)
    throw Error(ErrorKind::usage,
                "a replay decodes in grey; train the database without --illumination-invariant");
}

/// Milliseconds of one online step against a generated database.
BenchRow time_database(uint64_t frames, const RealtimeBenchSettings& settings,
                       const RowKernels& kernels, uint64_t seed, const Monitor& monitor) {
  const std::vector<LdbCode> train = generate_walk(frames, seed);
  const MatchingCase example(train,
                             walk_again(train, 0, settings.window_length + 50, 100, seed + 1),
                             {settings.window_length, kRingBytes, kernels, {}, seed});
  check_methods(example, {"fastable-online"}, monitor);
  BenchRow row{"fastable-online",
               {{"frames", static_cast<double>(frames)},
                {"c_l", static_cast<double>(settings.window_length)}},
               "query frame",
               {},
               {},
               ""};
  find_matching_timer("fastable-online").measure(example, {0.3}, monitor, row);
  row.values.emplace_back("cpu_percent", row.time.median_ms * settings.rate_hz / 10);
  return row;
}

FrameWork fastable_work(const SequenceDatabase& database, const MatchSettings& settings) {
  struct Online {
    std::vector<LdbCode> codes;  // of the last c_l + 1 frames: what enters, and what leaves
    FrameDistances distances;
    FastableState state;
    size_t best = 0;  // kept, so that the search for it is not left out
  };
  auto online = std::make_shared<Online>();
  online->codes.resize(settings.window_length + 1);
  online->distances = frame_distances(descriptor_spans(database), {online->codes, {}});
  online->state = start_fastable(online->distances, settings);
  return [online, kernels = settings.kernels,
          window_length = settings.window_length](const cv::Mat& grey) {
    const size_t frame = online->state.frames_seen % online->codes.size();
    online->codes[frame] = describe_ldb(grey);
    online->distances = online->distances.of_query({online->codes, {}});
    const auto sums = advance_fastable(online->state, online->distances, kernels, frame);
    if (online->state.frames_seen < window_length) return;
    emit_row(online->distances, window_length, online->state.frames_seen - 1, 0, sums,
             [&](const ScoreRow& row) {
               const uint32_t least = kernels.minimum(row.scores.data(), row.scores.size());
               online->best =
                   kernels.find_below(row.scores.data(), 0, row.scores.size(), least + 1);
             });
  };
}

FrameWork rates_work(const SequenceDatabase& database, size_t frames,
                     const MatchSettings& settings) {
  struct Online {
    std::vector<LdbCode> codes;
    FrameDistances distances;
    std::shared_ptr<RatesState> state;
    size_t frame = 0;
    size_t best = 0;  // kept, so that the search for it is not left out
  };
  auto online = std::make_shared<Online>();
  online->codes.resize(frames);
  online->distances = frame_distances(descriptor_spans(database), {online->codes, {}});
  online->state = start_rates(online->distances, settings);
  return [online, kernels = settings.kernels](const cv::Mat& grey) {
    online->codes.at(online->frame) = describe_ldb(grey);
    online->distances = online->distances.of_query({online->codes, {}});
    advance_rates(*online->state, online->distances, kernels, online->frame,
                  [&](const ScoreRow& row) {
                    const size_t count = row.scores.size();
                    const uint32_t least = kernels.minimum(row.scores.data(), count);
                    online->best = kernels.find_below(row.scores.data(), 0, count, least + 1);
                  });
    ++online->frame;
  };
}

FrameWork filter_work(const SequenceDatabase& database, size_t frames, const RowKernels& kernels) {
  struct Online {
    std::vector<LdbCode> codes;  // of all frames: views are compared with later ones
    FrameDistances distances;
    std::shared_ptr<StandardizedState> learned;
    FrameDistances scores;
    FilteredQuery query;
    size_t frame = 0;
    PathReport last;  // kept, so that nothing is left out
  };
  SequenceQuerySettings settings;
  settings.score = Score::standardized;
  const TrainStatistics* statistics = database.statistics ? &*database.statistics : nullptr;
  const std::optional<ScoreBasis> basis = score_basis(statistics, settings);
  auto online = std::make_shared<Online>();
  online->codes.resize(frames);
  online->distances = frame_distances(descriptor_spans(database), {online->codes, {}});
  online->learned = start_standardized(online->distances, *basis, {});
  online->scores = standardized(online->learned);
  online->query = start_filtered(online->scores, {1, kRingBytes, kernels});
  return [online](const cv::Mat& grey) {
    online->codes.at(online->frame) = describe_ldb(grey);
    online->learned->distances = online->distances.of_query({online->codes, {}});
    online->last = take_frame(online->query, online->scores, online->frame);
    ++online->frame;
  };
}

}  // namespace

FrameWork sequence_work(const SequenceDatabase& database, const RealtimeBenchSettings& settings,
                        const RowKernels& kernels) {
  check_described(database);
  MatchSettings match{settings.window_length, kRingBytes, kernels};
  match.rates = parse_rates(settings.rates);
  const bool has_rates = !match.rates.empty();
  if (settings.method != "filter")
    return has_rates ? rates_work(database, settings.frames, match)
                     : fastable_work(database, match);
  if (has_rates)
    throw Error(ErrorKind::usage, "the filter has rates of its own: leave out --rates");
  return filter_work(database, settings.frames, kernels);
}

FrameWork fabmap_work(const FabmapDatabase& database, const FabmapQuerySettings& settings) {
  struct Online {
    const FabmapQuerySettings settings;
    const Vocabulary vocabulary;
    const FabmapMatcher matcher;
    std::vector<double> previous = {};

    Online(const FabmapDatabase& db, const FabmapQuerySettings& s)
        : settings(s), vocabulary(make_vocabulary(db.vocabulary)), matcher(db, settings, 1) {}
  };
  const auto online = std::make_shared<Online>(database, settings);
  return [online, &database](const cv::Mat& grey) {
    const WordSet words =
        quantise(online->vocabulary, find_features(grey, database.settings.features).descriptors);
    online->previous = fabmap_posterior(online->matcher.views(words, database.views.views()),
                                        online->matcher.new_place(words), online->previous,
                                        online->settings.posterior);
  };
}

BenchResult bench_realtime(const Sequence& query, const FrameWork& work,
                           const RealtimeBenchSettings& settings, const Monitor& monitor) {
  check_settings(settings);
  if (query.files.empty())
    throw Error(ErrorKind::usage, fmt::format("{}: give a folder or list of images, not a video",
                                              query.argument.path.string()));
  BenchResult result;
  result.bench = "realtime";
  result.settings = value_to_json(settings);
  const size_t frames = std::min<size_t>(settings.frames, query.files.size());
  const double period_ms = 1000 / settings.rate_hz;
  std::vector<double> latencies_ms;
  StepCounter counter(monitor, "replay", frames);
  const double cpu_before = process_cpu_s();
  const auto start = Clock::now();
  for (size_t f = 0; f < frames; ++f) {
    check_stop(monitor);
    const auto due =
        start + std::chrono::duration_cast<Clock::duration>(
                    std::chrono::duration<double, std::milli>(static_cast<double>(f) * period_ms));
    std::this_thread::sleep_until(due);
    work(decode_image(query.files[f], PixelFormat::grey));
    latencies_ms.push_back(std::chrono::duration<double, std::milli>(Clock::now() - due).count());
    counter.add();
  }
  const double wall_s = std::max(std::chrono::duration<double>(Clock::now() - start).count(),
                                 static_cast<double>(frames) * period_ms / 1000);
  const double cpu_s = process_cpu_s() - cpu_before;
  BenchRow row{"replay", {{"rate_hz", settings.rate_hz}}, "frame", summarise(latencies_ms), {}, ""};
  for (const int percent : {50, 95, 99, 100})
    row.values.emplace_back(
        percent == 100 ? "latency_max_ms" : fmt::format("latency_{}_ms", percent),
        quantile(latencies_ms, percent / 100.0));
  row.values.emplace_back(
      "missed", static_cast<double>(std::count_if(latencies_ms.begin(), latencies_ms.end(),
                                                  [&](double ms) { return ms > period_ms; })));
  row.values.emplace_back("cpu_percent", 100 * cpu_s / wall_s);
  result.rows.push_back(std::move(row));
  return result;
}

void find_largest_database(BenchResult& result, const RealtimeBenchSettings& settings,
                           const RowKernels& kernels, uint64_t seed, const Monitor& monitor) {
  check_settings(settings);
  const double budget_ms = settings.share_percent / 100 * 1000 / settings.rate_hz;
  uint64_t fits = 0;
  uint64_t too_large = 0;
  const auto fits_budget = [&](uint64_t frames) {
    const BenchRow row = time_database(frames, settings, kernels, seed, monitor);
    result.rows.push_back(row);
    return row.time.median_ms <= budget_ms;
  };
  uint64_t frames = std::max<uint64_t>(kSmallestTried, settings.window_length + 1);
  if (settings.most_frames < frames)
    throw Error(ErrorKind::usage, fmt::format("most_frames must be at least {}, found {}", frames,
                                              settings.most_frames));
  while (too_large == 0 && frames <= settings.most_frames) {
    if (fits_budget(frames)) {
      fits = frames;
      frames *= 4;
    } else {
      too_large = frames;
    }
  }
  for (int step = 0; step < 3 && too_large != 0 && fits != 0; ++step) {
    const uint64_t middle = fits + (too_large - fits) / 2;
    (fits_budget(middle) ? fits : too_large) = middle;
  }
  BenchRow& last = result.rows.back();
  BenchRow summary{"largest database",
                   {{"rate_hz", settings.rate_hz}, {"share_percent", settings.share_percent}},
                   "query frame",
                   last.time,
                   {{"largest_frames", static_cast<double>(fits)}},
                   too_large == 0 ? "the largest that was tried fits" : ""};
  for (const BenchRow& row : result.rows)
    if (row.work == "fastable-online" && row.parameter("frames") == static_cast<double>(fits))
      summary.time = row.time;
  result.rows.push_back(std::move(summary));
}

}  // namespace vpr
