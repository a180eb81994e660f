#include "fabmap/word_training.h"

#include <algorithm>
#include <mutex>

#include <fmt/format.h>
#include <opencv2/core.hpp>

#include "base/checksum.h"
#include "base/error.h"
#include "base/monitor.h"
#include "base/npy.h"
#include "base/parallel.h"
#include "base/text.h"
#include "database/imported.h"
#include "fabmap/word_clustering.h"
#include "recordings/frames.h"
#include "recordings/sequence_source.h"

namespace vpr {
namespace {

constexpr size_t kMaxWords = 10'000'000;
constexpr size_t kMaxReadWords = 100'000'000;
constexpr size_t kWarnedShare = 10;  // warn from a tenth of the frames without features

// A sequence with one value per frame, which `make` computes from descriptors.
template <class T, class Make>
std::pair<Sequence, std::vector<T>> for_each_descriptors(const SequenceSource& source,
                                                         const FeatureSettings& settings,
                                                         bool skip_unreadable,
                                                         const Monitor& monitor, Make&& make) {
  std::vector<T> values(source.files.size());
  std::mutex mutex;  // the length of a video is unknown before its end
  const Unreadable unreadable = skip_unreadable ? Unreadable::skip : Unreadable::fail;
  Sequence sequence = for_each_frame(source, PixelFormat::gray, unreadable, monitor,
                                     [&](size_t index, const cv::Mat& image) {
                                       T value = make(find_features(image, settings));
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
       "{}: {} of {} ({:.0f} %) have no {} features, so FAB-MAP cannot recognize them; use larger "
       "images, or train with another kind of --features",
       frames_of, featureless, counted(frames, "frame"),
       100 * static_cast<double>(featureless) / static_cast<double>(frames), enum_name(kind));
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

cv::Mat make_words(const std::vector<cv::Mat>& frames, const FabmapTrainSettings& settings,
                   uint64_t seed, const Monitor& monitor) {
  cv::Mat descriptors(0, descriptor_length(settings.features.kind),
                      is_binary(settings.features.kind) ? CV_8U : CV_32F);
  for (const cv::Mat& frame : frames)
    if (!frame.empty()) descriptors.push_back(frame);
  if (descriptors.empty() && !frames.empty())
    throw Error(ErrorKind::usage,
                "none of the {} --pretrain frames has a {} feature for the vocabulary; use larger "
                "images, or another kind of --features",
                frames.size(), enum_name(settings.features.kind));
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
                   static_cast<size_t>(std::ranges::count_if(descriptors, &cv::Mat::empty)),
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

[[noreturn]] void fail(const std::filesystem::path& path, const std::string& what) {
  throw Error(ErrorKind::data, "{}: {}", path.string(), what);
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
                            const std::vector<NamedArgument>& train,
                            const FabmapTrainSettings& settings, uint64_t seed,
                            const Monitor& monitor) {
  check_feature_settings(settings.features);
  if (settings.words < 2 || settings.words > kMaxWords)
    throw Error(ErrorKind::usage, "words must be from 2 to {}, found {}", kMaxWords,
                settings.words);
  if (settings.iterations < 1)
    throw Error(ErrorKind::usage, "iterations must be 1 or more, found 0");
  FabmapDatabase database;
  database.settings = settings;
  database.seed = seed;
  learn_words(database, pretrain_descriptors(pretrain, settings, monitor), monitor);
  add_views(database, train, settings.skip_unreadable, monitor);
  return database;
}

void add_views(FabmapDatabase& database, const std::vector<NamedArgument>& groups,
               bool skip_unreadable, const Monitor& monitor) {
  for (size_t g = 0; g < groups.size(); ++g) {
    const NamedArgument& group = groups[g];
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
  const Selection shown =
      at_speed(source.argument.speed, words.sequence.frames, source.argument.seed);
  return selected(std::move(words), shown);
}

cv::Mat read_openfabmap_vocabulary(const std::filesystem::path& path) {
  const NpyArray array(path);
  const auto values = array.values<float>(2);
  if (values.empty() || array.shape()[0] > kMaxReadWords) fail(path, "has no words, or too many");
  const auto rows = static_cast<int>(array.shape()[0]);
  cv::Mat words(rows, static_cast<int>(array.shape()[1]), CV_32F);
  std::copy(values.begin(), values.end(), words.begin<float>());
  if (!cv::checkRange(words)) fail(path, "a word is not finite");
  return words;
}

ChowLiuTree read_openfabmap_tree(const std::filesystem::path& path) {
  const NpyArray array(path);
  const auto rows = array.values<double>(2);
  if (array.shape()[0] != 4)
    fail(path, fmt::format("a tree has 4 rows, found {}", array.shape()[0]));
  return tree_of_rows(rows, path.string());
}

std::vector<WordSet> read_openfabmap_frames(const SequenceArgument& argument, size_t words) {
  const NpyArray array(argument.path);
  const NumberType* const type = find_number_type(array.type());
  if (type == nullptr || array.shape().size() != 2 || array.is_column_major())
    fail(argument.path, "expected frames x words of numbers in C order");
  if (array.shape()[1] != words)
    fail(argument.path, fmt::format("has {} columns, but the vocabulary has {} words; arrays for "
                                    "FAB-MAP have one column per word",
                                    array.shape()[1], words));
  const size_t rows = rows_in_range(argument, array.shape()[0]);
  std::vector<WordSet> frames;
  std::vector<double> shown(words);
  for (size_t i = 0; i < rows; ++i) {
    const size_t row = argument.range.first + i * argument.range.step;
    type->read(array.value_bytes().data() + row * words * type->bytes, type->bytes, words,
               shown.data(), 1);
    WordSet& frame = frames.emplace_back();
    for (size_t word = 0; word < words; ++word)
      if (shown[word] > 0) frame.push_back(static_cast<uint32_t>(word));
  }
  return frames;
}

FabmapDatabase import_openfabmap(const OpenFabmapFiles& files,
                                 const FabmapTrainSettings& settings) {
  check_feature_settings(settings.features);
  FabmapDatabase database;
  database.settings = settings;
  database.vocabulary = read_openfabmap_vocabulary(files.vocabulary);
  database.tree = read_openfabmap_tree(files.tree);
  database.settings.words = database.tree.words();
  if (static_cast<size_t>(database.vocabulary.rows) != database.tree.words())
    throw Error(ErrorKind::data, "{}: has {} words, but the tree has {}", files.vocabulary.string(),
                database.vocabulary.rows, database.tree.words());
  if (is_binary(settings.features.kind) ||
      database.vocabulary.cols != descriptor_length(settings.features.kind))
    throw Error(ErrorKind::usage,
                "{}: its words have {} dimensions, which {} does not; select the matching features "
                "with --features",
                files.vocabulary.string(), database.vocabulary.cols,
                enum_name(settings.features.kind));
  for (const WordSet& frame : read_openfabmap_frames(files.pretrain, database.tree.words()))
    database.pretrain.add(frame);
  const std::vector<WordSet> frames = read_openfabmap_frames(files.train, database.tree.words());
  Sequence sequence{sequence_names({files.train}).front(), frames.size()};
  for (size_t f = 0; f < frames.size(); ++f) sequence.frame_names.push_back(fmt::format("#{}", f));
  add_group(database, {std::move(sequence)}, frames);
  index_views(database);
  return database;
}

}  // namespace vpr
