#include "fabmap/openfabmap.h"

#include <algorithm>

#include <fmt/format.h>
#include <opencv2/core.hpp>

#include "base/error.h"
#include "base/npy.h"
#include "base/text.h"
#include "fabmap/chow_liu.h"
#include "sequence/sequence_source.h"

namespace vpr {
namespace {

namespace fs = std::filesystem;

constexpr size_t kMaxWords = 100'000'000;

[[noreturn]] void fail(const fs::path& path, const std::string& what) {
  throw Error(ErrorKind::data, fmt::format("{}: {}", path.string(), what));
}

}  // namespace

cv::Mat read_openfabmap_vocabulary(const fs::path& path) {
  const NpyArray array(path);
  const auto values = array.values<float>(2);
  if (values.empty() || array.shape()[0] > kMaxWords) fail(path, "has no words, or too many");
  const auto rows = static_cast<int>(array.shape()[0]);
  cv::Mat words(rows, static_cast<int>(array.shape()[1]), CV_32F);
  std::copy(values.begin(), values.end(), words.begin<float>());
  if (!cv::checkRange(words)) fail(path, "a word is not finite");
  return words;
}

ChowLiuTree read_openfabmap_tree(const fs::path& path) {
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
    fail(argument.path, fmt::format("has {} words, but the tree has {}", array.shape()[1], words));
  const uint64_t rows = array.shape()[0];
  const uint64_t last = argument.range.last.value_or(rows);
  if (argument.range.first >= rows || last > rows)
    throw Error(ErrorKind::usage,
                fmt::format("{}: has {}, which the range {} exceeds", argument.path.string(),
                            counted(rows, "frame"), range_text(argument.range)));
  std::vector<WordSet> frames;
  std::vector<double> shown(words);
  for (uint64_t row = argument.range.first; row < last;
       row += std::min(argument.range.step, last - row)) {
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
    throw Error(ErrorKind::data,
                fmt::format("{}: has {} words, but the tree has {}", files.vocabulary.string(),
                            database.vocabulary.rows, database.tree.words()));
  if (is_binary(settings.features.kind) ||
      database.vocabulary.cols != descriptor_length(settings.features.kind))
    throw Error(ErrorKind::usage, fmt::format("{}: its words have {} dimensions, which {} does "
                                              "not; select the matching features with --features",
                                              files.vocabulary.string(), database.vocabulary.cols,
                                              enum_name(settings.features.kind)));
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
