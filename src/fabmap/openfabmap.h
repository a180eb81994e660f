// OpenFABMAP's files, which scripts/convert/openfabmap.py writes as .npy arrays.
#pragma once

#include <filesystem>
#include <vector>

#include "fabmap/chow_liu.h"
#include "fabmap/database.h"
#include "sequence/sequence_argument.h"

namespace vpr {

/// Vocabulary: words x dimensions, float32. All readers throw Error(input) if the file can't be
/// read and Error(data) if it is not such an array or its values are impossible.
cv::Mat read_openfabmap_vocabulary(const std::filesystem::path& path);

/// Tree: 4 x words, float64: parent, P(z), P(z|parent), P(z|not parent).
ChowLiuTree read_openfabmap_tree(const std::filesystem::path& path);

/// BOW matrix: frames x words, of any number type; a frame shows the words above 0. The range picks
/// rows. `words`: the expected number of columns.
std::vector<WordSet> read_openfabmap_frames(const SequenceArgument& argument, size_t words);

/// What a database is imported from; BOW matrices may have ranges.
struct OpenFabmapFiles {
  std::filesystem::path vocabulary;
  std::filesystem::path tree;
  SequenceArgument pretrain;
  SequenceArgument train;
};

/// A database whose places are the rows of the training matrix. Throws Error(data) where the files
/// do not fit together, Error(usage) where the words are not descriptors of the given features, and
/// the errors of the readers.
FabmapDatabase import_openfabmap(const OpenFabmapFiles& files, const FabmapTrainSettings& settings);

}  // namespace vpr
