#include "database/openfabmap.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>
#include <opencv2/core.hpp>

#include "base/counted.h"
#include "base/error.h"
#include "database/opencv_yaml.h"
#include "database/tree_rows.h"
#include "images/sequence_names.h"

namespace vpr {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const fs::path& path, const std::string& what) {
  throw Error(ErrorKind::data, fmt::format("{}: {}", path.string(), what));
}

constexpr std::array<const char*, 4> kFiles = {"vocabulary.yml", "tree.yml", "bow-pretrain.yml",
                                               "bow-train.yml"};

void write_node(const fs::path& path, const std::string& name, const cv::Mat& mat) {
  cv::FileStorage storage(".yml", cv::FileStorage::WRITE | cv::FileStorage::MEMORY);
  storage << name << mat;
  write_part(path, storage.releaseAndGetString());
}

cv::Mat tree_matrix(const ChowLiuTree& tree) {
  const std::vector<double> rows = tree_rows(tree);
  cv::Mat mat(4, static_cast<int>(tree.words()), CV_64F);
  std::copy(rows.begin(), rows.end(), mat.begin<double>());
  return mat;
}

cv::Mat bow_matrix(const ViewWords& views, size_t words) {
  cv::Mat mat = cv::Mat::zeros(static_cast<int>(views.views()), static_cast<int>(words), CV_32F);
  for (size_t v = 0; v < views.views(); ++v)
    for (const uint32_t word : views.view(v))
      mat.at<float>(static_cast<int>(v), static_cast<int>(word)) = 1;
  return mat;
}

}  // namespace

bool is_openfabmap_folder(const fs::path& folder) {
  return holds_only_files(folder, [](const std::string& name) {
    return std::find(kFiles.begin(), kFiles.end(), name) != kFiles.end();
  });
}

void write_openfabmap(const fs::path& folder, const FabmapDatabase& database,
                      OutputTransaction& outputs) {
  if (database.vocabulary.type() != CV_32F)
    throw Error(ErrorKind::usage,
                fmt::format("OpenFABMAP has no binary words; {} can't be exported",
                            enum_name(database.settings.features.kind)));
  const size_t words = database.tree.words();
  OutputFolder& output = outputs.folder(folder, is_openfabmap_folder);
  write_node(output.temporary() / kFiles[0], "Vocabulary", database.vocabulary);
  write_node(output.temporary() / kFiles[1], "ChowLiuTree", tree_matrix(database.tree));
  write_node(output.temporary() / kFiles[2], "BOWImageDescs", bow_matrix(database.pretrain, words));
  write_node(output.temporary() / kFiles[3], "BOWImageDescs", bow_matrix(database.views, words));
}

cv::Mat read_openfabmap_vocabulary(const fs::path& path) {
  cv::Mat words = read_opencv_matrix(path, "Vocabulary", CV_32F);
  if (!cv::checkRange(words)) fail(path, "a word is not finite");
  return words;
}

ChowLiuTree read_openfabmap_tree(const fs::path& path) {
  const cv::Mat mat = read_opencv_matrix(path, "ChowLiuTree", CV_64F);
  if (mat.rows != 4) fail(path, fmt::format("a tree has 4 rows, found {}", mat.rows));
  return tree_of_rows({mat.ptr<double>(), mat.total()}, path.string());
}

std::vector<WordSet> read_openfabmap_frames(const SequenceArgument& argument, size_t words) {
  const cv::Mat mat = read_opencv_matrix(argument.path, "BOWImageDescs", CV_32F);
  if (static_cast<size_t>(mat.cols) != words)
    fail(argument.path, fmt::format("has {} words, but the tree has {}", mat.cols, words));
  const auto rows = static_cast<uint64_t>(mat.rows);
  const uint64_t last = argument.range.last.value_or(rows);
  if (argument.range.first >= rows || last > rows)
    throw Error(ErrorKind::usage,
                fmt::format("{}: has {}, which the range {} exceeds", argument.path.string(),
                            counted(rows, "frame"), range_text(argument.range)));
  std::vector<WordSet> frames;
  for (uint64_t row = argument.range.first; row < last;
       row += std::min(argument.range.step, last - row)) {
    WordSet& frame = frames.emplace_back();
    for (int q = 0; q < mat.cols; ++q)
      if (mat.at<float>(static_cast<int>(row), q) > 0) frame.push_back(static_cast<uint32_t>(q));
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
    throw Error(
        ErrorKind::usage,
        fmt::format("{}: its words have {} dimensions, which {} does not; name the features "
                    "it was made of with --features",
                    files.vocabulary.string(), database.vocabulary.cols,
                    enum_name(settings.features.kind)));
  for (const WordSet& frame : read_openfabmap_frames(files.pretrain, database.tree.words()))
    database.pretrain.add(frame);
  const std::vector<WordSet> frames = read_openfabmap_frames(files.train, database.tree.words());
  ViewGroup group{sequence_names({files.train}).front(), false, {}};
  for (size_t f = 0; f < frames.size(); ++f) group.frame_names.push_back(fmt::format("#{}", f));
  add_group(database, group, frames);
  index_views(database);
  return database;
}

}  // namespace vpr
