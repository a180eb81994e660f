// OpenFABMAP's files (OpenCV YAML, also .gz).
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "base/output_transaction.h"
#include "database/chow_liu.h"
#include "database/fabmap_database.h"
#include "images/sequence_argument.h"

namespace vpr {

/// Node `Vocabulary`: words x dims, float. All readers throw Error(input) if the file can't be read
/// and Error(data) if the node is missing, of another type, or its values can't be meant.
cv::Mat read_openfabmap_vocabulary(const std::filesystem::path& path);

/// Node `ChowLiuTree`: 4 x words, double: parent, P(z), P(z|parent), P(z|not parent).
ChowLiuTree read_openfabmap_tree(const std::filesystem::path& path);

/// Node `BOWImageDescs`: frames x words, float; a frame shows the words above 0. The range picks
/// rows. `words`: how many there must be.
std::vector<WordSet> read_openfabmap_frames(const SequenceArgument& argument, size_t words);

/// Writes `vocabulary.yml`, `tree.yml`, `bow-pretrain.yml` and `bow-train.yml` (each word that a
/// frame shows is 1) into a new folder. Throws Error(usage) for binary words, which OpenFABMAP does
/// not have. The caller commits.
void write_openfabmap(const std::filesystem::path& folder, const FabmapDatabase& database,
                      OutputTransaction& outputs);

/// Whether a folder holds nothing but such files.
bool is_openfabmap_folder(const std::filesystem::path& folder);

/// What a database is imported from; BOW matrices may have ranges.
struct OpenFabmapFiles {
  std::filesystem::path vocabulary;
  std::filesystem::path tree;
  SequenceArgument pretrain;
  SequenceArgument train;
};

/// A database whose places are the rows of the training matrix. Throws Error(data) where the files
/// do not fit together, Error(usage) where the words are no descriptors of the features that are
/// set, and what the readers throw.
FabmapDatabase import_openfabmap(const OpenFabmapFiles& files, const FabmapTrainSettings& settings);

}  // namespace vpr
