#include "database/openfabmap.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <memory>
#include <optional>
#include <string_view>

#include <fmt/format.h>
#include <opencv2/core.hpp>
#include <zlib.h>

#include "base/counted.h"
#include "base/error.h"
#include "database/tree_rows.h"
#include "images/sequence_names.h"

namespace vpr {
namespace {

namespace fs = std::filesystem;

constexpr uint64_t kMostUnpacked = uint64_t{128} << 20;  // bytes of a compressed file
constexpr size_t kMostValues = 40;                       // a matrix has ten, in XML thirteen

[[noreturn]] void fail(const fs::path& path, const std::string& what) {
  throw Error(ErrorKind::data, fmt::format("{}: {}", path.string(), what));
}

/// Reads a text piece by piece and says what is in it that no matrix of OpenCV's YAML, XML or JSON
/// has. OpenCV's parser calls itself for every nested value, takes a matrix for as large as it
/// says, and neither ends nor survives on every text.
class TextCheck {
 public:
  /// Nothing, or what is wrong.
  std::optional<std::string> add(std::string_view text) {
    for (const char c : text) {
      const bool is_text = (c >= ' ' && c <= '~') || c == '\n' || c == '\r' || c == '\t';
      if (!is_text) return "a byte that no such text has";
      if (c == '-') {
        if (dashes_++ == 0) before_ = last_;
      } else if (dashes_ > 0) {
        if (!may_follow_dashes(c)) return kNestedList;
        dashes_ = 0;
      }
      if (dashes_ > 3) return kNestedList;
      // None is nested deeper than that, whatever quotes and comments hide.
      if (c == '[' || c == '{' || c == '<' || c == ':') ++values_;
      if (values_ > kMostValues)
        return fmt::format("more than {} nested or named values", kMostValues);
      last_ = c;
    }
    return std::nullopt;
  }

  /// Nothing, or what is wrong with a text that ends here.
  std::optional<std::string> end() const {
    return dashes_ == 0 ? std::nullopt : std::optional<std::string>(kNestedList);
  }

 private:
  static constexpr const char* kNestedList = "nested values: a '-' that is no sign";

  static bool is_letter(char c) { return c >= 'a' && c <= 'z'; }

  // A sign, "opencv-matrix", or the line "---" of YAML.
  bool may_follow_dashes(char c) const {
    if (dashes_ == 3) return before_ == '\n' && (c == '\n' || c == '\r');
    const bool is_sign = (c >= '0' && c <= '9') || c == '.';
    return dashes_ == 1 && (is_sign || (is_letter(before_) && is_letter(c)));
  }

  size_t values_ = 0;
  size_t dashes_ = 0;   ///< just read
  char before_ = '\n';  ///< these
  char last_ = '\n';
};

// OpenCV's parser of XML does not survive every first line.
void check_start(const fs::path& path, std::string_view text) {
  for (const std::string_view start :
       {"%YAML:1.0\n", "%YAML:1.0\r\n", "<?xml version=\"1.0\"?>", "{"})
    if (text.starts_with(start)) return;
  fail(path, "expected one of OpenFABMAP's matrices in OpenCV's YAML, XML or JSON");
}

void check_text(const fs::path& path) {
  const std::unique_ptr<gzFile_s, int (*)(gzFile)> file(::gzopen(path.c_str(), "rb"), ::gzclose);
  if (!file)
    throw Error(ErrorKind::input,
                fmt::format("{}: can't be read: {}", path.string(), system_error_text(errno)));
  std::vector<char> bytes(size_t{1} << 16);
  TextCheck check;
  uint64_t size = 0;
  for (;;) {
    const int got = ::gzread(file.get(), bytes.data(), static_cast<unsigned>(bytes.size()));
    if (got < 0) fail(path, "its compressed data are damaged");
    if (got == 0) break;
    if (size == 0) check_start(path, {bytes.data(), static_cast<size_t>(got)});
    size += static_cast<uint64_t>(got);
    if (size > kMostUnpacked && ::gzdirect(file.get()) == 0)
      fail(path, fmt::format("holds more than {} MiB when it is unpacked; if that is meant, unpack "
                             "it and name the file that gunzip makes",
                             kMostUnpacked >> 20));
    if (const auto wrong = check.add({bytes.data(), static_cast<size_t>(got)}))
      fail(path, "expected one of OpenFABMAP's matrices, found " + *wrong);
  }
  if (const auto wrong = check.end())
    fail(path, "expected one of OpenFABMAP's matrices, found " + *wrong);
}

// OpenCV makes room for as many rows and columns as are claimed before it looks at the values.
bool is_as_large_as_it_says(const cv::FileNode& matrix) {
  const int rows = static_cast<int>(matrix["rows"]);
  const int columns = static_cast<int>(matrix["cols"]);
  return rows >= 0 && columns >= 0 && size_t(rows) * size_t(columns) == matrix["data"].size();
}

cv::Mat read_node(const fs::path& path, const std::string& name, int type) {
  std::error_code error;
  if (!fs::is_regular_file(path, error))
    throw Error(ErrorKind::input, fmt::format("{}: no such file", path.string()));
  check_text(path);
  cv::Mat mat;
  try {
    const cv::FileStorage file(path.string(), cv::FileStorage::READ);
    if (file.isOpened() && is_as_large_as_it_says(file[name])) file[name] >> mat;
  } catch (const std::exception&) {  // of OpenCV, or what its parser lets pass
    mat.release();
  }
  if (mat.empty() || mat.type() != type)
    fail(path, fmt::format("expected OpenFABMAP's matrix \"{}\" of {} in OpenCV YAML", name,
                           type == CV_32F ? "floats" : "doubles"));
  return mat;
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
  cv::Mat words = read_node(path, "Vocabulary", CV_32F);
  if (!cv::checkRange(words)) fail(path, "a word is not finite");
  return words;
}

ChowLiuTree read_openfabmap_tree(const fs::path& path) {
  const cv::Mat mat = read_node(path, "ChowLiuTree", CV_64F);
  if (mat.rows != 4) fail(path, fmt::format("a tree has 4 rows, found {}", mat.rows));
  return tree_of_rows({mat.ptr<double>(), mat.total()}, path.string());
}

std::vector<WordSet> read_openfabmap_frames(const SequenceArgument& argument, size_t words) {
  const cv::Mat mat = read_node(argument.path, "BOWImageDescs", CV_32F);
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
