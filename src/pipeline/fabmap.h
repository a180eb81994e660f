// FAB-MAP from frames to recognised places (paper, figure 1 A).
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "base/monitor.h"
#include "database/fabmap_database.h"
#include "images/sequence.h"
#include "recognition/fabmap_result.h"

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
};

/// Local features of the pretraining frames become a vocabulary and a Chow-Liu tree; training
/// frames become views. Throws Error(usage) for settings out of range, no pretraining or training
/// frames, or more words than descriptors, and what for_each_frame throws.
FabmapDatabase train_fabmap(const std::vector<SequenceArgument>& pretrain,
                            const std::vector<GroupArgument>& train,
                            const FabmapTrainSettings& settings, uint64_t seed,
                            const Monitor& monitor);

/// The words that a sequence shows, in the database's vocabulary.
SequenceWords describe_words(const Sequence& sequence, const FabmapDatabase& database,
                             bool skip_unreadable, const Monitor& monitor);

struct FabmapRun {
  FabmapResult result;
  std::map<std::string, double> seconds;  ///< by step
};

/// Takes the posterior of every frame in order (new place first); empty for an unreadable frame.
using PosteriorObserver = std::function<void(size_t frame, std::span<const double> posterior)>;

/// Throws Error(usage) for settings out of range.
FabmapRun query_fabmap(const FabmapDatabase& database, const SequenceWords& query,
                       const std::string& query_name, const FabmapQuerySettings& settings,
                       uint64_t seed, const PosteriorObserver& observe, const Monitor& monitor);

}  // namespace vpr
