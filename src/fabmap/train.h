// Training of FAB-MAP from frames: local features, vocabulary, Chow-Liu tree, words.
#pragma once

#include <string>
#include <vector>

#include "base/monitor.h"
#include "fabmap/database.h"
#include "sequence/sequence_source.h"

namespace vpr {

/// Frames to train: a sequence, and whether it is a single place.
struct GroupArgument {
  std::string name;
  SequenceArgument sequence;
  bool is_place = false;
};

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
                            const std::vector<GroupArgument>& train,
                            const FabmapTrainSettings& settings, uint64_t seed,
                            const Monitor& monitor);

/// Adds frames as views of new groups, without describing the existing views again.
void add_views(FabmapDatabase& database, const std::vector<GroupArgument>& groups,
               bool skip_unreadable, const Monitor& monitor);

/// The words of a sequence in the database's vocabulary. Warns if at least a tenth of its frames
/// have no features.
SequenceWords describe_words(const SequenceSource& source, const FabmapDatabase& database,
                             bool skip_unreadable, const Monitor& monitor);

}  // namespace vpr
