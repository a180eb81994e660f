#include "pipeline/fabmap.h"

#include <algorithm>
#include <mutex>

#include <fmt/format.h>

#include "base/parallel.h"
#include "base/random.h"
#include "base/stopwatch.h"
#include "database/kmeans.h"
#include "images/frames.h"
#include "matching/fabmap.h"

namespace vpr {
namespace {

constexpr size_t kFramesAtOnce = 64;  // whose posteriors are in memory

Unreadable on_unreadable(bool skip) { return skip ? Unreadable::skip : Unreadable::fail; }

// Descriptors by frame; `make` turns them into what is kept.
template <class T, class Make>
std::vector<T> for_each_descriptors(const Sequence& sequence, const FeatureSettings& settings,
                                    Unreadable unreadable, const Monitor& monitor,
                                    FrameList& frames, Make&& make) {
  std::vector<T> kept(sequence.files.size());
  std::mutex mutex;  // a video's length is not known before its end
  frames = for_each_frame(sequence, PixelFormat::grey, unreadable, monitor,
                          [&](size_t index, const cv::Mat& image) {
                            T made = make(find_features(image, settings).descriptors);
                            const std::lock_guard lock(mutex);
                            if (index >= kept.size()) kept.resize(index + 1);
                            kept[index] = std::move(made);
                          });
  kept.resize(frames.count());
  return kept;
}

std::vector<cv::Mat> pretrain_descriptors(const std::vector<SequenceArgument>& pretrain,
                                          const FabmapTrainSettings& settings,
                                          const Monitor& monitor) {
  std::vector<cv::Mat> all;
  for (const SequenceArgument& argument : pretrain) {
    FrameList frames;
    for (cv::Mat& descriptors : for_each_descriptors<cv::Mat>(
             open_sequence(argument), settings.features, on_unreadable(settings.skip_unreadable),
             monitor, frames, [](const cv::Mat& found) { return found; }))
      all.push_back(descriptors);
  }
  return all;
}

cv::Mat stacked(const std::vector<cv::Mat>& parts, const FeatureSettings& settings) {
  cv::Mat all(0, descriptor_length(settings.kind), is_binary(settings.kind) ? CV_8U : CV_32F);
  for (const cv::Mat& part : parts)
    if (!part.empty()) all.push_back(part);
  return all;
}

void check_train_settings(const FabmapTrainSettings& settings) {
  check_feature_settings(settings.features);
  if (settings.words < 2 || settings.words > 10'000'000)
    throw Error(ErrorKind::usage,
                fmt::format("words must be from 2 to 10000000, found {}", settings.words));
  if (settings.iterations < 1)
    throw Error(ErrorKind::usage, "iterations must be 1 or more, found 0");
}

void check_share(std::string_view name, double value) {
  if (!(value >= 0 && value <= 1))
    throw Error(ErrorKind::usage, fmt::format("{} must be from 0 to 1, found {}", name, value));
}

void check_query_settings(const FabmapQuerySettings& settings) {
  check_share("t_p", settings.place_threshold);
  check_share("posterior.smoothing", settings.posterior.smoothing);
  check_share("posterior.motion_bias", settings.posterior.motion_bias);
  if (!(settings.posterior.new_place_prior > 0 && settings.posterior.new_place_prior <= 1))
    throw Error(ErrorKind::usage, "posterior.new_place_prior must be above 0 and at most 1");
  if (settings.window < 1 || settings.window > 1'000'000)
    throw Error(ErrorKind::usage,
                fmt::format("c_w must be from 1 to 1000000, found {}", settings.window));
  if (settings.lut_digits < 1 || settings.lut_digits > 12)
    throw Error(ErrorKind::usage,
                fmt::format("lut_digits must be from 1 to 12, found {}", settings.lut_digits));
  find_fabmap_variant(settings.variant);
}

// The pretraining frames whose average likelihood is the new place's.
ViewWords new_place_views(const FabmapDatabase& database, const FabmapQuerySettings& settings,
                          uint64_t seed) {
  const size_t all = database.pretrain.views();
  if (settings.new_place_samples == 0 || settings.new_place_samples >= all)
    return database.pretrain;
  std::vector<size_t> order(all);
  for (size_t i = 0; i < all; ++i) order[i] = i;
  RandomEngine engine(seed);
  for (size_t i = 0; i < settings.new_place_samples; ++i)
    std::swap(order[i], order[i + uniform_below(engine, all - i)]);
  ViewWords sample;
  for (size_t i = 0; i < settings.new_place_samples; ++i)
    sample.add(database.pretrain.view(order[i]));
  return sample;
}

/// Everything that stays the same for all frames of a query.
struct Matcher {
  FabmapModel model;
  FabmapIndex index;
  ViewWords samples;
  FabmapIndex sample_index;
  const FabmapDatabase& database;
  const FabmapQuerySettings& settings;

  Matcher(const FabmapDatabase& db, const FabmapQuerySettings& s, uint64_t seed)
      : model(make_fabmap_model(db.tree, {s.p_seen_if_there, s.p_seen_if_not}, s.word_model)),
        index(make_fabmap_index(model, db.views)),
        samples(new_place_views(db, s, seed)),
        sample_index(make_fabmap_index(model, samples)),
        database(db),
        settings(s) {}

  std::vector<double> views(const WordSet& words) const {
    return find_fabmap_variant(settings.variant)
        .log_likelihoods(
            {model, database.views, index, words, static_cast<int>(settings.lut_digits)});
  }
  double new_place(const WordSet& words) const {
    if (settings.new_place == NewPlaceModel::mean_field) return new_place_mean_field(model, words);
    return log_mean_exp(fabmap2_log_likelihoods({model, samples, sample_index, words}));
  }
};

PlaceMatch likeliest_view(size_t frame, std::span<const double> posterior,
                          const std::vector<uint32_t>& place_of) {
  const auto best = std::max_element(posterior.begin() + 1, posterior.end());
  const auto view = static_cast<uint32_t>(best - posterior.begin() - 1);
  return {static_cast<uint32_t>(frame), place_of[view], view, *best};
}

// The places whose views have been above t_p for c_w frames, each by its likeliest such view.
void append_hits(FabmapResult& result, size_t frame, std::span<const double> posterior,
                 const ViewWindow& window, const std::vector<uint32_t>& place_of) {
  std::map<uint32_t, PlaceMatch> found;
  for (uint32_t view = 0; view < place_of.size(); ++view) {
    if (window.run[view] < result.settings.window) continue;
    const PlaceMatch match{static_cast<uint32_t>(frame), place_of[view], view, posterior[view + 1]};
    const auto [entry, is_new] = found.emplace(match.place, match);
    if (!is_new && match.probability > entry->second.probability) entry->second = match;
  }
  for (const auto& [place, match] : found) result.hits.push_back(match);
}

}  // namespace

FabmapDatabase train_fabmap(const std::vector<SequenceArgument>& pretrain,
                            const std::vector<GroupArgument>& train,
                            const FabmapTrainSettings& settings, uint64_t seed,
                            const Monitor& monitor) {
  check_train_settings(settings);
  FabmapDatabase database;
  database.settings = settings;
  database.seed = seed;
  std::vector<WordSet> frames;
  {
    const std::vector<cv::Mat> descriptors = pretrain_descriptors(pretrain, settings, monitor);
    database.vocabulary = kmeans_words(stacked(descriptors, settings.features),
                                       {settings.words, settings.iterations, seed}, monitor);
    const Vocabulary vocabulary = make_vocabulary(database.vocabulary);
    frames.resize(descriptors.size());
    parallel_for(frames.size(), monitor, [&](size_t f) {
      if (!descriptors[f].empty()) frames[f] = quantise(vocabulary, descriptors[f]);
    });
  }
  for (const WordSet& frame : frames) database.pretrain.add(frame);
  database.tree = train_chow_liu(frames, settings.words, monitor);
  for (const GroupArgument& argument : train) {
    const SequenceWords words = describe_words(open_sequence(argument.sequence), database,
                                               settings.skip_unreadable, monitor);
    for (const WordSet& frame : words.frames) database.views.add(frame);
    database.groups.push_back({argument.name, argument.is_place, words.names});
  }
  return database;
}

SequenceWords describe_words(const Sequence& sequence, const FabmapDatabase& database,
                             bool skip_unreadable, const Monitor& monitor) {
  const Vocabulary vocabulary = make_vocabulary(database.vocabulary);
  FrameList frames;
  SequenceWords words;
  words.frames = for_each_descriptors<WordSet>(
      sequence, database.settings.features, on_unreadable(skip_unreadable), monitor, frames,
      [&](const cv::Mat& descriptors) { return quantise(vocabulary, descriptors); });
  words.names = std::move(frames.names);
  words.unreadable = std::move(frames.unreadable);
  return words;
}

FabmapRun query_fabmap(const FabmapDatabase& database, const SequenceWords& query,
                       const std::string& query_name, const FabmapQuerySettings& settings,
                       uint64_t seed, const PosteriorObserver& observe, const Monitor& monitor) {
  check_query_settings(settings);
  const std::vector<uint32_t> place_of = database.places();
  if (place_of.empty()) throw Error(ErrorKind::usage, "the database has no places to recognise");
  FabmapRun run;
  FabmapResult& result = run.result;
  result.settings = settings;
  result.query_name = query_name;
  result.query_frames = query.frames.size();
  result.query_unreadable = query.unreadable;
  result.places = database.place_names();
  result.views = place_of.size();

  Stopwatch watch;
  const Matcher matcher(database, settings, seed);
  run.seconds["index"] = watch.elapsed_s();
  watch = {};
  StepCounter counter(monitor, "match", query.frames.size());
  ViewWindow window;
  std::vector<double> previous;
  for (size_t begin = 0; begin < query.frames.size(); begin += kFramesAtOnce) {
    const size_t count = std::min(kFramesAtOnce, query.frames.size() - begin);
    std::vector<std::vector<double>> views(count);
    std::vector<double> new_place(count);
    parallel_for(count, monitor, [&](size_t i) {
      views[i] = matcher.views(query.frames[begin + i]);
      new_place[i] = matcher.new_place(query.frames[begin + i]);
      counter.add();
    });
    for (size_t i = 0; i < count; ++i) {
      const size_t frame = begin + i;
      const bool unreadable =
          std::binary_search(query.unreadable.begin(), query.unreadable.end(), frame);
      std::vector<double> posterior;
      if (!unreadable)
        posterior = fabmap_posterior(views[i], new_place[i], previous, settings.posterior);
      if (observe) observe(frame, posterior);
      window.add(posterior, settings.place_threshold, place_of.size());
      result.new_place.push_back(unreadable ? 0 : posterior[0]);
      result.best.emplace_back();
      if (unreadable) continue;
      if (!query.frames[frame].empty())
        result.best.back() = likeliest_view(frame, posterior, place_of);
      append_hits(result, frame, posterior, window, place_of);
      previous = std::move(posterior);
    }
  }
  run.seconds["match"] = watch.elapsed_s();
  return run;
}

}  // namespace vpr
