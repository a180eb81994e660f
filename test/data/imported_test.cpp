// Quantized descriptors have the recall of float64 on real images.
#include "database/imported.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>

#include <catch2/catch.hpp>
#include <fmt/format.h>
#include <opencv2/imgproc.hpp>
#include <opencv2/objdetect.hpp>

#include "database/frame_descriptors.h"
#include "match/frame_distances.h"
#include "recordings/frames.h"
#include "support.h"

using namespace vpr;
using namespace vpr::test;
namespace fs = std::filesystem;

namespace {

using Describe = std::function<cv::Mat(const cv::Mat& gray)>;  // to a row of CV_32F

cv::Mat describe(const fs::path& folder, const Describe& describe_frame) {
  std::vector<cv::Mat> rows(open_sequence({folder, {}}).files.size());
  for_each_frame(open_sequence({folder, {}}), PixelFormat::gray, Unreadable::fail, {},
                 [&](size_t index, const cv::Mat& gray) { rows[index] = describe_frame(gray); });
  cv::Mat all;
  cv::vconcat(rows, all);
  return all;
}

cv::Mat thumbnail(const cv::Mat& gray) {
  cv::Mat small;
  cv::resize(gray, small, {32, 24}, 0, 0, cv::INTER_AREA);
  cv::Mat row;
  small.reshape(1, 1).convertTo(row, CV_32F);
  return row;
}

cv::Mat hog(const cv::Mat& gray) {
  cv::Mat small;
  cv::resize(gray, small, {128, 64}, 0, 0, cv::INTER_AREA);
  std::vector<float> values;
  cv::HOGDescriptor({128, 64}, {16, 16}, {8, 8}, {8, 8}, 9).compute(small, values);
  return cv::Mat(values, true).reshape(1, 1);
}

// Projects onto the strongest components of the training frames.
void project(cv::Mat& train, cv::Mat& query, int components) {
  const cv::PCA pca(train, {}, cv::PCA::DATA_AS_ROW, components);
  train = pca.project(train);
  query = pca.project(query);
}

void write(const fs::path& path, const cv::Mat& rows) {
  write_array(path, std::vector<float>(rows.begin<float>(), rows.end<float>()),
              {static_cast<size_t>(rows.rows), static_cast<size_t>(rows.cols)});
}

/// Percent of queries with a correct match among the 1, 5 and 10 nearest training frames.
using Recalls = std::array<double, 3>;

// Ties go to the lower frame.
template <class DistanceOf>
Recalls recalls(size_t queries, size_t frames, size_t tolerance, DistanceOf&& distance_of) {
  constexpr std::array<size_t, 3> kNearest = {1, 5, 10};
  Recalls found = {};
  for (size_t q = 0; q < queries; ++q) {
    std::vector<double> distances(frames);
    for (size_t i = 0; i < frames; ++i) distances[i] = distance_of(q, i);
    std::vector<size_t> order(frames);
    std::iota(order.begin(), order.end(), size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](size_t a, size_t b) { return distances[a] < distances[b]; });
    for (size_t k = 0; k < kNearest.size(); ++k)
      found[k] += std::any_of(order.begin(), order.begin() + ptrdiff_t(kNearest[k]),
                              [&](size_t i) { return i + tolerance >= q && q + tolerance >= i; })
                      ? 100.0 / static_cast<double>(queries)
                      : 0;
  }
  return found;
}

// In float64, optionally rounded to multiples of `unit` (0: not rounded).
Recalls exact_recalls(const cv::Mat& train, const cv::Mat& query, size_t tolerance, double unit) {
  cv::Mat units[2];
  for (int s = 0; s < 2; ++s) {
    (s == 0 ? train : query).convertTo(units[s], CV_64F);
    for (int r = 0; r < units[s].rows; ++r) cv::normalize(units[s].row(r), units[s].row(r));
  }
  const cv::Mat cosines = units[1] * units[0].t();
  return recalls(static_cast<size_t>(query.rows), static_cast<size_t>(train.rows), tolerance,
                 [&](size_t q, size_t i) {
                   const double distance =
                       1 - cosines.at<double>(static_cast<int>(q), static_cast<int>(i));
                   return unit > 0 ? std::nearbyint(distance / unit) : distance;
                 });
}

// Euclidean distances in float64.
Recalls exact_point_recalls(const cv::Mat& train, const cv::Mat& query, size_t tolerance) {
  return recalls(static_cast<size_t>(query.rows), static_cast<size_t>(train.rows), tolerance,
                 [&](size_t q, size_t i) {
                   return cv::norm(query.row(static_cast<int>(q)), train.row(static_cast<int>(i)));
                 });
}

Recalls quantized_recalls(const cv::Mat& train, const cv::Mat& query, size_t tolerance,
                          std::string_view kind) {
  const TemporaryFolder folder;
  write(folder / "train.npy", train);
  write(folder / "query.npy", query);
  const SequenceSource walked = open_sequence({folder / "train.npy", {}});
  const double unit = descriptor_kind(kind).shape.element == ElementType::points16
                          ? coordinate_unit(kind, {&walked, 1}, {})
                          : 0;
  const auto import = [&](const char* name) {
    return import_descriptors(open_sequence({folder / name, {}}), kind, Unreadable::fail, {}, unit);
  };
  const DescriptorSet trained = import("train.npy");
  const DescriptorSet asked = import("query.npy");
  const DescribedFrames span = trained.span();
  const FrameDistances distances = frame_distances({&span, 1}, asked.span());
  std::vector<uint16_t> row(trained.rows().size() + kBlockFrames);
  uint32_t filled = ~0U;
  return recalls(asked.rows().size(), trained.rows().size(), tolerance, [&](size_t q, size_t i) {
    const auto frame = static_cast<uint32_t>(q);
    if (filled != frame) distances.tile({&frame, 1}, 0, trained.rows().size(), row.data(), 0);
    filled = frame;
    return row[i];
  });
}

}  // namespace

TEST_CASE("imported vectors have the best matches of float64") {
  struct Set {
    const char* train;
    const char* query;
    size_t tolerance;
  };
  for (const Set& set : {Set{"data/corridor/ref", "data/corridor/query", 3},
                         Set{"data/nordland/summer", "data/nordland/winter", 2}}) {
    const auto train_folder = real_data(set.train);
    const auto query_folder = real_data(set.query);
    if (!train_folder || !query_folder) return;
    for (const bool is_hog : {false, true}) {
      const Describe& describe_frame = is_hog ? hog : thumbnail;
      for (const int components : {0, 32, 64}) {
        cv::Mat train = describe(*train_folder, describe_frame);
        cv::Mat query = describe(*query_folder, describe_frame);
        if (components > 0) project(train, query, components);
        const Recalls exact = exact_recalls(train, query, set.tolerance, 0);
        const Recalls rounded = exact_recalls(train, query, set.tolerance, 2.0 / 65535);
        const Recalls wide = quantized_recalls(train, query, set.tolerance, kVectorKind);
        const Recalls narrow = quantized_recalls(train, query, set.tolerance, kNarrowVectorKind);
        const bool is_long = is_hog && components == 0;  // products of float64 take half a minute
        const Recalls exact_points =
            is_long ? Recalls{} : exact_point_recalls(train, query, set.tolerance);
        const Recalls points = quantized_recalls(train, query, set.tolerance, kPointKind);
        const Recalls directions = quantized_recalls(train, query, set.tolerance, kDirectionKind);
        for (size_t k = 0; k < exact.size(); ++k) {
          INFO(fmt::format("Euclidean: float64 {:.2f}, 16 bits {:.2f}; directions: {:.2f}",
                           exact_points[k], points[k], directions[k]));
          const std::string found = fmt::format(
              "{}, {}, {} components, K {}: float64 {:.2f}, rounded {:.2f}, 16 bits {:.2f}, 8 bits "
              "{:.2f}",
              set.query, is_hog ? "HOG" : "thumbnails", components, k, exact[k], rounded[k],
              wide[k], narrow[k]);
          INFO(found);
          // Distances of frames in tunnels are smaller than the unit of distances.
          const bool has_nearer = set.tolerance == 2 && !is_hog && components > 0;
          CHECK(std::abs(wide[k] - exact[k]) <= (has_nearer ? 0.6 : 0.1));
          CHECK(std::abs(wide[k] - rounded[k]) <= 0.1);
          CHECK(std::abs(narrow[k] - exact[k]) <= 1);
          if (!is_long) CHECK(std::abs(points[k] - exact_points[k]) <= 0.1);
          CHECK(std::abs(directions[k] - exact[k]) <= 0.1);
        }
      }
    }
  }
}
