// Times FAB-MAP's lines of the speed table, on random words and descriptors:
//   vpr-timing-fabmap [places]
#include <cmath>
#include <cstdlib>

#include <fmt/format.h>
#include <opencv2/core.hpp>

#include "base/parallel.h"
#include "base/random.h"
#include "base/statistics.h"
#include "base/stopwatch.h"
#include "database/chow_liu.h"
#include "database/kmeans.h"
#include "matching/fabmap.h"

namespace {

using namespace vpr;

constexpr size_t kWords = 10'000;
constexpr size_t kWordsPerFrame = 200;

// Some words are common and most are rare, as in real vocabularies.
WordSet random_frame(RandomEngine& engine) {
  WordSet words;
  while (words.size() < kWordsPerFrame) {
    const double u = uniform_unit(engine);
    words.push_back(static_cast<uint32_t>(u * u * kWords));
  }
  std::sort(words.begin(), words.end());
  words.erase(std::unique(words.begin(), words.end()), words.end());
  return words;
}

void report(const std::string& what, std::vector<double> ms) {
  fmt::print("{:<52} {:9.4f} ms (quartiles {:.4f} {:.4f})\n", what, median(ms), quantile(ms, 0.25),
             quantile(ms, 0.75));
  std::fflush(stdout);
}

void time_queries(const ChowLiuTree& tree, size_t places) {
  RandomEngine engine(2);
  ViewWords views;
  for (size_t v = 0; v < places; ++v) views.add(random_frame(engine));
  const FabmapModel model = make_fabmap_model(tree, {}, WordModel::tree);
  const WordIndex index_lists = make_word_index(views, model.words());
  const FabmapIndex index = make_fabmap_index(model, views, index_lists);
  const std::vector<WordSet> queries = {random_frame(engine), random_frame(engine),
                                        random_frame(engine)};
  for (const FabmapVariant& variant : fabmap_variants()) {
    const bool slow = variant.name == "fabmap1" || variant.name == "lut";
    if (slow && places > 10'000) continue;
    std::vector<double> ms;
    for (int repeat = 0; repeat < (slow ? 3 : 60); ++repeat) {
      const Stopwatch watch;
      variant.log_likelihoods(
          {model, views, index, queries[static_cast<size_t>(repeat) % 3], places});
      ms.push_back(watch.elapsed_ms());
    }
    report(fmt::format("{} query, {} places", variant.name, places), ms);
  }
}

}  // namespace

int main(int argc, char** argv) {
  RandomEngine engine(1);
  std::vector<WordSet> frames;
  for (int f = 0; f < 1000; ++f) frames.push_back(random_frame(engine));
  Stopwatch watch;
  ChowLiuTree tree;
  {
    const ThreadLimit one(1);
    tree = train_chow_liu(frames, kWords, {});
    report("Chow-Liu tree, 10000 words x 1000 frames", {watch.elapsed_ms()});
    if (argc > 1) {
      time_queries(tree, std::strtoull(argv[1], nullptr, 10));
    } else {
      for (const size_t places : {10'000, 100'000}) time_queries(tree, places);
    }
  }
  cv::Mat descriptors(200'000, 64, CV_32F);
  for (int r = 0; r < descriptors.rows; ++r)
    for (int c = 0; c < descriptors.cols; ++c)
      descriptors.at<float>(r, c) = static_cast<float>(uniform_unit(engine));
  watch = {};
  kmeans_words(descriptors, {kWords, 20, 1}, {});
  report("k-means, 200000 x 64 into 10000, 20 iterations", {watch.elapsed_ms()});
  return 0;
}
