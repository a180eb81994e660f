// The words of frames, whoever decodes them.
#pragma once

#include <mutex>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "descriptors/vocabulary.h"

namespace vpr {

/// Takes grey frames in any order, from several threads, and keeps the words that they show.
class WordCollector {
 public:
  /// Both must outlive it.
  WordCollector(const FeatureSettings& features, const Vocabulary& vocabulary)
      : features_(features), vocabulary_(vocabulary) {}

  void operator()(size_t index, const cv::Mat& grey);

  /// One entry a frame: empty for one without features, or that did not come.
  std::vector<WordSet> take(size_t frames);

 private:
  const FeatureSettings& features_;
  const Vocabulary& vocabulary_;
  std::mutex mutex_;
  std::vector<WordSet> words_;
};

}  // namespace vpr
