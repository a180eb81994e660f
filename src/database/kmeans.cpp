#include "database/kmeans.h"

#include <algorithm>
#include <vector>

#include <fmt/format.h>
#include <opencv2/core/mat.hpp>

#include "base/error.h"
#include "base/json.h"
#include "base/parallel.h"
#include "database/kmeans_seeds.h"
#include "database/point_groups.h"
#include "descriptors/vocabulary.h"

namespace vpr {
namespace {

/// Some of the centres, whose nearest one is named by its index among all.
class CentreSubset {
 public:
  CentreSubset(const cv::Mat& centres, std::vector<size_t> indices) : indices_(std::move(indices)) {
    if (!indices_.empty()) vocabulary_ = make_vocabulary(rows_of(centres, indices_));
  }
  bool empty() const { return indices_.empty(); }
  void find_nearest(const cv::Mat& points, std::span<const uint32_t> rows,
                    NearestCentre* nearest) const {
    find_nearest_words(vocabulary_, points, rows, nearest);
    for (size_t i = 0; i < rows.size(); ++i)
      nearest[i].centre = static_cast<uint32_t>(indices_[nearest[i].centre]);
  }

 private:
  std::vector<size_t> indices_;  // rising, so that ties stay ties
  Vocabulary vocabulary_;
};

/// Which centres moved since points were assigned to them.
struct MovedCentres {
  std::vector<char> has_moved;
  CentreSubset moved;
  CentreSubset stayed;
};

MovedCentres split_centres(const cv::Mat& centres, const std::vector<char>& has_moved) {
  std::vector<size_t> moved;
  std::vector<size_t> stayed;
  for (size_t c = 0; c < has_moved.size(); ++c) (has_moved[c] != 0 ? moved : stayed).push_back(c);
  return {has_moved, {centres, std::move(moved)}, {centres, std::move(stayed)}};
}

// Makes `nearest` right again after centres moved. A centre that stayed is as far as it was, so
// not nearer than the point's own centre was: it is met only by points whose own centre moved, and
// for which no moved one is nearer than that. Exact, for a score depends on point and centre alone.
void reassign(const cv::Mat& points, const MovedCentres& centres,
              std::vector<NearestCentre>& nearest, const Monitor& monitor) {
  for_chunks(nearest.size(), monitor, [&](size_t begin, size_t end) {
    const std::vector<uint32_t> rows = row_range(begin, end);
    std::vector<NearestCentre> found(rows.size());
    centres.moved.find_nearest(points, rows, found.data());
    std::vector<uint32_t> open;
    for (size_t i = 0; i < rows.size(); ++i) {
      NearestCentre& own = nearest[begin + i];
      const bool stayed = centres.has_moved[own.centre] == 0;
      if (!stayed && !(found[i].score < own.score)) open.push_back(rows[i]);
      if (!stayed || nearer(found[i], own)) own = found[i];
    }
    if (open.empty() || centres.stayed.empty()) return;
    found.resize(open.size());
    centres.stayed.find_nearest(points, open, found.data());
    for (size_t i = 0; i < open.size(); ++i)
      if (nearer(found[i], nearest[open[i]])) nearest[open[i]] = found[i];
  });
}

}  // namespace

cv::Mat kmeans_words(const cv::Mat& descriptors, const KmeansSettings& settings,
                     const Monitor& monitor) {
  const auto n = static_cast<size_t>(descriptors.rows);
  if (settings.words == 0 || settings.words > n)
    throw Error(
        ErrorKind::usage,
        fmt::format("{} words can't be made of {} descriptors; give fewer --words, more --pretrain "
                    "frames, larger pictures, or another kind of --features",
                    settings.words, n));
  RandomEngine engine(settings.seed);
  cv::Mat centres = choose_seeds(descriptors, settings.words, engine, monitor);
  std::vector<NearestCentre> nearest(n);
  std::vector<char> has_moved(settings.words, 1);
  StepCounter counter(monitor, "cluster", settings.iterations);
  for (size_t step = 0; step < settings.iterations; ++step) {
    reassign(descriptors, split_centres(centres, has_moved), nearest, monitor);
    has_moved = move_centres(descriptors, nearest, centres, monitor);
    if (std::find(has_moved.begin(), has_moved.end(), 1) == has_moved.end()) break;
    counter.add();
  }
  return centres;
}

}  // namespace vpr
