// FAB-MAP from frames: local features, vocabulary, Chow-Liu tree, words.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/monitor.h"
#include "fabmap/database.h"
#include "sequence/selection.h"
#include "sequence/sequence.h"

namespace vpr {

/// Frames to train: a sequence, and whether it is one place.
struct GroupArgument {
  std::string name;
  SequenceArgument sequence;
  bool is_place = false;
};

/// Words of every frame of a sequence.
struct SequenceWords {
  std::vector<WordSet> frames;  ///< empty for a frame without features, or an unreadable one
  std::vector<std::string> names;
  std::vector<size_t> unreadable;
  std::optional<double> fps = {};     ///< frames a second, where known
  std::optional<Replay> replay = {};  ///< where frames are those of a recording that is replayed
};

/// The frames replayed by `warp`; as they are where that is empty. Throws as replay does.
SequenceWords replayed(SequenceWords words, const std::string& warp, uint64_t seed);

/// How many frames show no word, though they could be decoded.
size_t featureless_frames(const SequenceWords& words);

/// Of what frames show, as results have it of their query.
std::string words_fingerprint(const SequenceWords& words);

/// Local features of the pretraining frames become a vocabulary and a Chow-Liu tree; training
/// frames become views. Throws Error(usage) for settings out of range, pretraining frames without
/// any feature, or more words than descriptors, and what for_each_frame throws. Warns where a tenth
/// of the frames or more have no features.
FabmapDatabase train_fabmap(const std::vector<SequenceArgument>& pretrain,
                            const std::vector<GroupArgument>& train,
                            const FabmapTrainSettings& settings, uint64_t seed,
                            const Monitor& monitor);

/// Frames become views of new groups; nothing that the database holds is described again.
void add_views(FabmapDatabase& database, const std::vector<GroupArgument>& groups,
               bool skip_unreadable, const Monitor& monitor);

/// The words that a sequence shows, in the database's vocabulary. Warns where a tenth of its frames
/// or more have no features.
SequenceWords describe_words(const Sequence& sequence, const FabmapDatabase& database,
                             bool skip_unreadable, const Monitor& monitor);

}  // namespace vpr
