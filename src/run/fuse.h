// A database of sequences with FAB-MAP's database of the same training frames.
#pragma once

#include <mutex>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "base/monitor.h"
#include "decide/query_settings.h"
#include "fabmap/database.h"
#include "fabmap/vocabulary.h"
#include "store/sequence_database.h"

namespace vpr {

/// Lets scores of the database be fused with what FAB-MAP says of the same frames
/// (match/fusion.h), and its queries be described for both. Each training sequence needs a group
/// of the same name, frame names and unreadable frames, of frames that are places or of views of
/// one place; other groups count for nothing. The database has its statistics (ensure_statistics).
/// Throws Error(data), which starts with `name`, where a sequence is missing or has other frames,
/// and for descriptors that were imported.
void fuse_views(SequenceDatabase& database, FabmapDatabase fabmap, const std::string& name);

/// The same, from the folder of FAB-MAP's database; nothing for an empty path. Throws Error(usage)
/// where there is a weight and no database, and what read_fabmap_database throws.
void fuse_views(SequenceDatabase& database, const SequenceQuerySettings& settings,
                const std::string& path);

/// Warns that automatic margins accept more wrong places if scores are fused.
void warn_of_automatic(const SequenceQuerySettings& settings, const Monitor& monitor);

/// What the database is fused with, or null.
const FusedViews* fused_views(const SequenceDatabase& database);

/// The frames of a sequence by both databases, of one that is fused. They are decoded once, but for
/// descriptors that are illumination invariant, which need colors: FAB-MAP's features are those of
/// the gray picture that decoders make.
DescriptorSet describe_both(const SequenceSource& sequence, const SequenceDatabase& database,
                            Unreadable unreadable, const Monitor& monitor);

/// Takes gray frames in any order, from several threads, and keeps the words that they show.
class WordCollector {
 public:
  /// Both must outlive it.
  WordCollector(const FeatureSettings& features, const Vocabulary& vocabulary)
      : features_(features), vocabulary_(vocabulary) {}

  void operator()(size_t index, const cv::Mat& gray);

  /// One entry a frame: empty for one without features, or that did not come.
  std::vector<WordSet> take(size_t frames);

 private:
  const FeatureSettings& features_;
  const Vocabulary& vocabulary_;
  std::mutex mutex_;
  std::vector<WordSet> words_;
};

}  // namespace vpr
