#include "pipeline/frame_words.h"

namespace vpr {

void WordCollector::operator()(size_t index, const cv::Mat& grey) {
  WordSet words = quantise(vocabulary_, find_features(grey, features_).descriptors);
  const std::lock_guard lock(mutex_);
  if (index >= words_.size()) words_.resize(index + 1);
  words_[index] = std::move(words);
}

std::vector<WordSet> WordCollector::take(size_t frames) {
  words_.resize(frames);
  return std::move(words_);
}

}  // namespace vpr
