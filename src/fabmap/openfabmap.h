// Readers of OpenFABMAP's files, after conversion to .npy arrays by scripts/convert/openfabmap.py.
#pragma once

#include <filesystem>
#include <vector>

#include "fabmap/chow_liu.h"
#include "fabmap/database.h"
#include "sequence/sequence_source.h"

namespace vpr {

/// Vocabulary: words x dimensions, float32. All readers throw Error(input) if the file cannot be
/// read, and Error(data) if it is another array or holds invalid values.
cv::Mat read_openfabmap_vocabulary(const std::filesystem::path& path);

/// Tree: 4 x words, float64: parent, P(z), P(z|parent), P(z|not parent).
ChowLiuTree read_openfabmap_tree(const std::filesystem::path& path);

/// BOW matrix: frames x words, of any number type; a frame shows the words with values above 0. The
/// range selects rows. `words`: the expected number of columns.
std::vector<WordSet> read_openfabmap_frames(const SequenceArgument& argument, size_t words);

/// The files to import; BOW matrices may have ranges.
struct OpenFabmapFiles {
  std::filesystem::path vocabulary;
  std::filesystem::path tree;
  SequenceArgument pretrain;
  SequenceArgument train;
};

/// Imports a database whose places are the rows of the training matrix. Throws Error(data) if the
/// files do not match, Error(usage) if the words are not descriptors of the selected features, and
/// the errors of the readers.
FabmapDatabase import_openfabmap(const OpenFabmapFiles& files, const FabmapTrainSettings& settings);

}  // namespace vpr
