#include "bench/replay_work.h"

#include <memory>

#include <fmt/format.h>
#include <opencv2/core/mat.hpp>

#include "base/error.h"
#include "images/decode.h"
#include "matching/fastable_online.h"
#include "matching/live_frames.h"
#include "matching/match_filter.h"
#include "matching/rates.h"
#include "pipeline/fabmap_matcher.h"
#include "pipeline/score_basis.h"
#include "pipeline/train.h"
#include "recognition/fabmap_posterior.h"

namespace vpr {
namespace {

DescriptorSet described(const Sequence& frame, const SequenceDatabase& database) {
  DescriptorSet set = describe_frames(frame, database, false, {});
  if (set.descriptors.shape() != database.descriptors.shape())
    throw Error(ErrorKind::data,
                fmt::format("{}: its descriptors have {} {}, the database's {}",
                            frame.argument.path.string(), set.rows().shape.length,
                            element_words(set.rows().shape), database.descriptors.shape().length));
  return set;
}

/// Of a query without frames.
FrameDistances no_frames(const SequenceDatabase& database) {
  return frame_distances(descriptor_spans(database),
                         {DescriptorRows(database.descriptors.shape(), {}), {}});
}

size_t best_of(const ScoreRow& row, const RowKernels& kernels) {
  const uint32_t least = kernels.minimum(row.scores.data(), row.scores.size());
  return kernels.find_below(row.scores.data(), 0, row.scores.size(), least + 1);
}

FrameWork fastable_work(const SequenceDatabase& database, const MatchSettings& settings) {
  struct Online {
    LiveFrames frames;
    FastableState state;
    size_t best = 0;  // kept, so that the search for it is not left out
  };
  auto online = std::make_shared<Online>();
  online->frames = start_live(no_frames(database), nullptr);
  online->state = start_fastable(online->frames.distances, settings);
  if (!online->state.has_ring)
    throw Error(ErrorKind::usage,
                fmt::format("the distances of {} frames to {} training frames take too much memory",
                            settings.window_length, online->frames.raw.train_frames));
  return [online, &database, kernels = settings.kernels,
          window_length = settings.window_length](const Sequence& frame) {
    LiveFrames& frames = online->frames;
    add_frame(frames, {described(frame, database).rows()[0]});
    const auto sums = advance_fastable(online->state, frames.distances, kernels, frames.last_row());
    if (frames.frames < window_length) return;
    emit_row(frames.distances, window_length, frames.frames - 1, 0, sums,
             [&](const ScoreRow& row) { online->best = best_of(row, kernels); });
  };
}

FrameWork rates_work(const SequenceDatabase& database, const MatchSettings& settings) {
  struct Online {
    std::vector<uint8_t> bytes;  // of all frames: rows are named by their numbers
    FrameDistances distances;
    std::shared_ptr<RatesState> state;
    size_t best = 0;  // kept, so that the search for it is not left out
  };
  auto online = std::make_shared<Online>();
  online->distances = no_frames(database);
  online->state = start_rates(online->distances, settings);
  return [online, &database, kernels = settings.kernels](const Sequence& frame) {
    const DescriptorSet set = described(frame, database);
    const DescriptorRows row = set.rows();
    online->bytes.insert(online->bytes.end(), row.bytes.begin(), row.bytes.end());
    const DescriptorRows rows(row.shape, online->bytes);
    online->distances = online->distances.of_query({rows, {}});
    advance_rates(*online->state, online->distances, kernels, rows.size() - 1,
                  [&](const ScoreRow& scores) { online->best = best_of(scores, kernels); });
  };
}

FrameWork filter_work(const SequenceDatabase& database, const RowKernels& kernels) {
  struct Online {
    LiveFrames frames;
    FilteredQuery query;
    PathReport last;  // kept, so that nothing is left out
  };
  SequenceQuerySettings settings;
  settings.score = Score::standardized;
  const TrainStatistics* statistics = database.statistics ? &*database.statistics : nullptr;
  const std::optional<ScoreBasis> basis = score_basis(statistics, settings);
  auto online = std::make_shared<Online>();
  online->frames = start_live(no_frames(database), &*basis);
  online->query = start_filtered(online->frames.distances, {1, kDefaultMemoryLimit, kernels});
  return [online, &database](const Sequence& frame) {
    LiveFrames& frames = online->frames;
    add_frame(frames, {described(frame, database).rows()[0]}, &online->query.view);
    online->query.passed = frames.frames - 1 - frames.last_row();
    online->last = take_frame(online->query, frames.distances, frames.last_row());
  };
}

}  // namespace

FrameWork sequence_work(const SequenceDatabase& database, const RealtimeBenchSettings& settings,
                        const RowKernels& kernels) {
  MatchSettings match{settings.window_length, kDefaultMemoryLimit, kernels};
  match.rates = parse_rates(settings.rates);
  const bool has_rates = !match.rates.empty();
  if (settings.method != "filter")
    return has_rates ? rates_work(database, match) : fastable_work(database, match);
  if (has_rates)
    throw Error(ErrorKind::usage, "the filter has rates of its own: leave out --rates");
  return filter_work(database, kernels);
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
  return [online, &database](const Sequence& frame) {
    if (frame.kind != SequenceKind::images)
      throw Error(ErrorKind::data, "a FAB-MAP database takes images, not descriptors");
    const cv::Mat grey = decode_image(frame.files.front(), PixelFormat::grey);
    const WordSet words =
        quantise(online->vocabulary, find_features(grey, database.settings.features).descriptors);
    online->previous = fabmap_posterior(online->matcher.views(words, database.views.views()),
                                        online->matcher.new_place(words), online->previous,
                                        online->settings.posterior);
  };
}

}  // namespace vpr
