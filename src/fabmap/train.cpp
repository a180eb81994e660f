#include "fabmap/train.h"

#include <algorithm>
#include <mutex>

#include <fmt/format.h>
#include <opencv2/core/mat.hpp>

#include "base/checksum.h"
#include "base/error.h"
#include "base/monitor.h"
#include "base/parallel.h"
#include "base/text.h"
#include "fabmap/word_clustering.h"
#include "sequence/frames.h"
#include "sequence/sequence_source.h"

namespace vpr {
namespace {

constexpr size_t kMaxWords = 10'000'000;
constexpr size_t kWarnedShare = 10;  // warn from a tenth of the frames without features

Unreadable on_unreadable(bool skip) { return skip ? Unreadable::skip : Unreadable::fail; }

cv::Mat no_descriptors(const FeatureSettings& settings) {
  return cv::Mat(0, descriptor_length(settings.kind), is_binary(settings.kind) ? CV_8U : CV_32F);
}

// A sequence with one value per frame, which `make` computes from descriptors.
template <class T, class Make>
std::pair<Sequence, std::vector<T>> for_each_descriptors(const SequenceSource& source,
                                                         const FeatureSettings& settings,
                                                         bool skip_unreadable,
                                                         const Monitor& monitor, Make&& make) {
  std::vector<T> values(source.files.size());
  std::mutex mutex;  // the length of a video is unknown before its end
  Sequence sequence = for_each_frame(source, PixelFormat::gray, on_unreadable(skip_unreadable),
                                     monitor, [&](size_t index, const cv::Mat& image) {
                                       T value = make(find_features(image, settings).descriptors);
                                       const std::lock_guard lock(mutex);
                                       if (index >= values.size()) values.resize(index + 1);
                                       values[index] = std::move(value);
                                     });
  values.resize(sequence.frames);
  return {std::move(sequence), std::move(values)};
}

// A frame without features matches nothing, or matches other frames with few features, without any
// other sign.
void warn_featureless(const std::string& frames_of, size_t featureless, size_t frames,
                      FeatureKind kind, const Monitor& monitor) {
  if (featureless * kWarnedShare < frames || featureless == 0) return;
  warn(monitor,
       fmt::format("{}: {} of {} ({:.0f} %) have no {} features, so FAB-MAP cannot recognize them; "
                   "use larger images, or train with another kind of --features",
                   frames_of, featureless, counted(frames, "frame"),
                   100 * static_cast<double>(featureless) / static_cast<double>(frames),
                   enum_name(kind)));
}

// Descriptors of readable frames only: unreadable frames say nothing about the frequency of words.
std::vector<cv::Mat> pretrain_descriptors(const std::vector<SequenceArgument>& pretrain,
                                          const FabmapTrainSettings& settings,
                                          const Monitor& monitor) {
  std::vector<cv::Mat> all;
  for (size_t p = 0; p < pretrain.size(); ++p) {
    const auto [sequence, found] = for_each_descriptors<cv::Mat>(
        open_sequence(pretrain[p]), settings.features, settings.skip_unreadable,
        part_of(monitor, "pretraining", p, pretrain.size()),
        [](const cv::Mat& descriptors) { return descriptors; });
    for (size_t f = 0; f < found.size(); ++f)
      if (!std::ranges::binary_search(sequence.unreadable, f)) all.push_back(found[f]);
  }
  return all;
}

cv::Mat stacked(const std::vector<cv::Mat>& parts, const FeatureSettings& settings) {
  cv::Mat all = no_descriptors(settings);
  for (const cv::Mat& part : parts)
    if (!part.empty()) all.push_back(part);
  return all;
}

void check_train_settings(const FabmapTrainSettings& settings) {
  check_feature_settings(settings.features);
  if (settings.words < 2 || settings.words > kMaxWords)
    throw Error(ErrorKind::usage,
                fmt::format("words must be from 2 to {}, found {}", kMaxWords, settings.words));
  if (settings.iterations < 1)
    throw Error(ErrorKind::usage, "iterations must be 1 or more, found 0");
}

cv::Mat make_words(const std::vector<cv::Mat>& frames, const FabmapTrainSettings& settings,
                   uint64_t seed, const Monitor& monitor) {
  const cv::Mat descriptors = stacked(frames, settings.features);
  if (descriptors.empty() && !frames.empty())
    throw Error(ErrorKind::usage,
                fmt::format("none of the {} --pretrain frames has a {} feature for the vocabulary; "
                            "use larger images, or another kind of --features",
                            frames.size(), enum_name(settings.features.kind)));
  if (settings.clustering == Clustering::radius)
    return radius_words(descriptors, settings.radius, kMaxWords, monitor);
  return kmeans_words(descriptors, {settings.words, settings.iterations, seed}, monitor);
}

// Trains the vocabulary and the tree on the features of the pretraining frames.
void learn_words(FabmapDatabase& database, const std::vector<cv::Mat>& descriptors,
                 const Monitor& monitor) {
  const FabmapTrainSettings& settings = database.settings;
  database.vocabulary = make_words(descriptors, settings, database.seed, monitor);
  warn_featureless("--pretrain",
                   static_cast<size_t>(std::count_if(descriptors.begin(), descriptors.end(),
                                                     [](const cv::Mat& m) { return m.empty(); })),
                   descriptors.size(), settings.features.kind, monitor);
  const Vocabulary vocabulary = make_vocabulary(database.vocabulary);
  std::vector<WordSet> frames(descriptors.size());
  parallel_for(frames.size(), monitor, [&](size_t f) {
    if (!descriptors[f].empty()) frames[f] = quantize(vocabulary, descriptors[f]);
  });
  const auto words = static_cast<size_t>(database.vocabulary.rows);
  database.settings.words = words;
  for (const WordSet& frame : frames) database.pretrain.add(frame);
  database.tree = train_chow_liu(frames, words, monitor);
}

}  // namespace

SequenceWords selected(SequenceWords recorded, const Selection& selection) {
  return {selected(std::move(recorded.sequence), selection),
          selected(std::move(recorded.words), selection)};
}

size_t featureless_frames(const SequenceWords& words) {
  const auto wordless = std::ranges::count_if(words.words, &WordSet::empty);
  return static_cast<size_t>(wordless) - words.sequence.unreadable.size();
}

std::string words_fingerprint(const SequenceWords& words) {
  ChecksumStream sum;
  for (const WordSet& frame : words.words) {
    const uint64_t count = frame.size();
    sum.add(std::as_bytes(std::span(&count, 1)));
    sum.add(std::as_bytes(std::span(frame)));
  }
  sum.add(std::as_bytes(std::span(words.sequence.unreadable)));
  return sum.text();
}

FabmapDatabase train_fabmap(const std::vector<SequenceArgument>& pretrain,
                            const std::vector<GroupArgument>& train,
                            const FabmapTrainSettings& settings, uint64_t seed,
                            const Monitor& monitor) {
  check_train_settings(settings);
  FabmapDatabase database;
  database.settings = settings;
  database.seed = seed;
  learn_words(database, pretrain_descriptors(pretrain, settings, monitor), monitor);
  add_views(database, train, settings.skip_unreadable, monitor);
  return database;
}

void add_views(FabmapDatabase& database, const std::vector<GroupArgument>& groups,
               bool skip_unreadable, const Monitor& monitor) {
  for (size_t g = 0; g < groups.size(); ++g) {
    const GroupArgument& group = groups[g];
    SequenceWords words = describe_words(open_sequence(group.sequence), database, skip_unreadable,
                                         part_of(monitor, group.name, g, groups.size()));
    words.sequence.name = group.name;
    add_group(database, {std::move(words.sequence), group.is_place}, words.words);
  }
  index_views(database);
}

SequenceWords describe_words(const SequenceSource& source, const FabmapDatabase& database,
                             bool skip_unreadable, const Monitor& monitor) {
  const Vocabulary vocabulary = make_vocabulary(database.vocabulary);
  auto [sequence, found] = for_each_descriptors<WordSet>(
      source, database.settings.features, skip_unreadable, monitor,
      [&](const cv::Mat& descriptors) { return quantize(vocabulary, descriptors); });
  SequenceWords words{std::move(sequence), std::move(found)};
  warn_featureless(source.argument.path.string() + range_text(source.argument.range),
                   featureless_frames(words), words.sequence.frames,
                   database.settings.features.kind, monitor);
  const Selection shown = warped(source.argument.warp, words.sequence.frames, source.argument.seed);
  return selected(std::move(words), shown);
}

}  // namespace vpr
