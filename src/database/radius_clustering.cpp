#include "database/radius_clustering.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <opencv2/core/mat.hpp>

#include "base/error.h"
#include "base/json.h"
#include "database/point_groups.h"
#include "descriptors/vocabulary.h"

namespace vpr {
namespace {

constexpr size_t kRowsAtOnce = 2048;  // that meet the centres so far together

// In units of squared_distance.
double squared_radius(const cv::Mat& points, double radius) {
  return points.type() == CV_8U ? radius : radius * radius;
}

// Squared distances of the rows [begin, end) to the centres so far.
std::vector<double> distances_to(const cv::Mat& points, const std::vector<size_t>& centres,
                                 size_t begin, size_t end, const Monitor& monitor) {
  std::vector<double> distances(end - begin, std::numeric_limits<double>::infinity());
  if (centres.empty()) return distances;
  const Vocabulary vocabulary = make_vocabulary(rows_of(points, centres));
  parallel_for(distances.size(), monitor, [&](size_t i) {
    const auto row = static_cast<uint32_t>(begin + i);
    NearestCentre nearest;
    find_nearest_words(vocabulary, points, {&row, 1}, &nearest);
    distances[i] = squared_distance(points, row, points, centres[nearest.centre]);
  });
  return distances;
}

cv::Mat centre_means(const cv::Mat& points, cv::Mat centres, const Monitor& monitor) {
  const Vocabulary vocabulary = make_vocabulary(centres.clone());
  std::vector<NearestCentre> nearest(static_cast<size_t>(points.rows));
  for_chunks(nearest.size(), monitor, [&](size_t begin, size_t end) {
    find_nearest_words(vocabulary, points, row_range(begin, end), nearest.data() + begin);
  });
  move_centres(points, nearest, centres, monitor);
  return centres;
}

}  // namespace

cv::Mat radius_words(const cv::Mat& descriptors, double radius, size_t most_words,
                     const Monitor& monitor) {
  if (!(radius > 0))
    throw Error(ErrorKind::usage, fmt::format("the radius must be above 0, found {}", radius));
  if (descriptors.empty())
    throw Error(ErrorKind::usage,
                "words can't be made of no descriptors; give more --pretrain "
                "frames");
  const auto n = static_cast<size_t>(descriptors.rows);
  const double limit = squared_radius(descriptors, radius);
  std::vector<size_t> centres;
  StepCounter counter(monitor, "cluster", n);
  for (size_t begin = 0; begin < n; begin += kRowsAtOnce) {
    const size_t end = std::min(n, begin + kRowsAtOnce);
    const size_t known = centres.size();
    const std::vector<double> distances = distances_to(descriptors, centres, begin, end, monitor);
    for (size_t i = begin; i < end; ++i) {
      bool is_far = centres.empty() || distances[i - begin] > limit;
      for (size_t c = known; is_far && c < centres.size(); ++c)
        is_far = squared_distance(descriptors, i, descriptors, centres[c]) > limit;
      if (is_far) centres.push_back(i);
      counter.add();
    }
    if (centres.size() > most_words)
      throw Error(ErrorKind::usage,
                  fmt::format("a radius of {} makes more than {} words; give a larger one", radius,
                              most_words));
  }
  return centre_means(descriptors, rows_of(descriptors, centres), monitor);
}

}  // namespace vpr
