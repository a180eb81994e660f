// Training of FAB-MAP from frames: local features, vocabulary, Chow-Liu tree, words; and import of
// the files of OpenFABMAP.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "base/monitor.h"
#include "fabmap/database.h"
#include "recordings/sequence_source.h"

namespace vpr {

/// A sequence with the words of every frame.
struct SequenceWords {
  Sequence sequence;
  std::vector<WordSet> words;  ///< empty for an unreadable frame or one without features
};

/// The selected frames.
SequenceWords selected(SequenceWords recorded, const Selection& selection);

/// The number of readable frames without words.
size_t featureless_frames(const SequenceWords& words);

/// The fingerprint of the query in results, computed from the words of its frames.
std::string words_fingerprint(const SequenceWords& words);

/// Trains a vocabulary and a Chow-Liu tree on the features of the pretraining frames; training
/// frames become views. Throws Error(usage) for settings out of range, pretraining frames without
/// any feature, or more words than descriptors; also throws as for_each_frame does. Warns if at
/// least a tenth of the frames have no features.
FabmapDatabase train_fabmap(const std::vector<SequenceArgument>& pretrain,
                            const std::vector<NamedArgument>& train,
                            const FabmapTrainSettings& settings, uint64_t seed,
                            const Monitor& monitor);

/// Adds frames as views of new groups, without describing the existing views again.
void add_views(FabmapDatabase& database, const std::vector<NamedArgument>& groups,
               bool skip_unreadable, const Monitor& monitor);

/// The words of a sequence in the database's vocabulary. Warns if at least a tenth of its frames
/// have no features.
SequenceWords describe_words(const SequenceSource& source, const FabmapDatabase& database,
                             bool skip_unreadable, const Monitor& monitor);

/// OpenFABMAP's vocabulary, after conversion to .npy by scripts/convert/openfabmap.py: words x
/// dimensions, float32. All three readers throw Error(input) if the file cannot be
/// read, and Error(data) if it is another array or holds invalid values.
cv::Mat read_openfabmap_vocabulary(const std::filesystem::path& path);

/// OpenFABMAP's tree: 4 x words, float64: parent, P(z), P(z|parent), P(z|not parent).
ChowLiuTree read_openfabmap_tree(const std::filesystem::path& path);

/// OpenFABMAP's BOW matrix: frames x words, of any number type; a frame shows the words with values
/// above 0. The range selects rows. `words`: the expected number of columns.
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
