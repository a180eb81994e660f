#include "database/point_groups.h"

#include <algorithm>
#include <array>

#include <opencv2/core/mat.hpp>

#include "descriptors/vocabulary.h"

namespace vpr {
namespace {

/// Points grouped by centre: members of c are points[offsets[c]] .. points[offsets[c + 1]], rising.
struct Members {
  std::vector<size_t> offsets;
  std::vector<uint32_t> points;
};

Members group_members(const std::vector<NearestCentre>& assigned, size_t centres) {
  Members members;
  members.offsets.assign(centres + 1, 0);
  for (const NearestCentre& own : assigned) ++members.offsets[own.centre + 1];
  for (size_t c = 0; c < centres; ++c) members.offsets[c + 1] += members.offsets[c];
  members.points.resize(assigned.size());
  std::vector<size_t> at(members.offsets.begin(), members.offsets.end() - 1);
  for (size_t i = 0; i < assigned.size(); ++i)
    members.points[at[assigned[i].centre]++] = static_cast<uint32_t>(i);
  return members;
}

// The mean of floats, summed in index order in double.
void mean_of(const cv::Mat& points, std::span<const uint32_t> members, cv::Mat centre) {
  std::vector<double> sums(static_cast<size_t>(points.cols), 0);
  for (const uint32_t i : members) {
    const auto* row = points.ptr<float>(static_cast<int>(i));
    for (size_t k = 0; k < sums.size(); ++k) sums[k] += static_cast<double>(row[k]);
  }
  for (size_t k = 0; k < sums.size(); ++k)
    centre.at<float>(0, static_cast<int>(k)) =
        static_cast<float>(sums[k] / static_cast<double>(members.size()));
}

// The bit that more than half of the members have set; 0 on a tie.
void majority_of(const cv::Mat& points, std::span<const uint32_t> members, cv::Mat centre) {
  std::vector<size_t> ones(static_cast<size_t>(points.cols) * 8, 0);
  for (const uint32_t i : members) {
    const uint8_t* row = points.ptr(static_cast<int>(i));
    for (size_t bit = 0; bit < ones.size(); ++bit) ones[bit] += row[bit / 8] >> bit % 8 & 1;
  }
  centre.setTo(0);
  for (size_t bit = 0; bit < ones.size(); ++bit)
    if (2 * ones[bit] > members.size())
      centre.data[bit / 8] = static_cast<uint8_t>(centre.data[bit / 8] | 1 << bit % 8);
}

}  // namespace

cv::Mat rows_of(const cv::Mat& points, const std::vector<size_t>& indices) {
  cv::Mat rows(static_cast<int>(indices.size()), points.cols, points.type());
  for (size_t i = 0; i < indices.size(); ++i)
    points.row(static_cast<int>(indices[i])).copyTo(rows.row(static_cast<int>(i)));
  return rows;
}

double squared_distance(const cv::Mat& a, size_t i, const cv::Mat& b, size_t j) {
  if (a.type() == CV_8U)
    return hamming_bytes(a.ptr(static_cast<int>(i)), b.ptr(static_cast<int>(j)),
                         static_cast<size_t>(a.cols));
  const auto* x = a.ptr<float>(static_cast<int>(i));
  const auto* y = b.ptr<float>(static_cast<int>(j));
  // Four sums in a fixed order, so that additions do not wait for each other.
  std::array<float, 4> sums{};
  int k = 0;
  for (; k + 4 <= a.cols; k += 4)
    for (int s = 0; s < 4; ++s)
      sums[static_cast<size_t>(s)] += (x[k + s] - y[k + s]) * (x[k + s] - y[k + s]);
  for (; k < a.cols; ++k) sums[0] += (x[k] - y[k]) * (x[k] - y[k]);
  return static_cast<double>((sums[0] + sums[1]) + (sums[2] + sums[3]));
}

std::vector<char> move_centres(const cv::Mat& points, const std::vector<NearestCentre>& assigned,
                               cv::Mat& centres, const Monitor& monitor) {
  const auto count = static_cast<size_t>(centres.rows);
  const Members members = group_members(assigned, count);
  std::vector<char> has_moved(count, 0);
  parallel_for(count, monitor, [&](size_t c) {
    const std::span<const uint32_t> own(members.points.data() + members.offsets[c],
                                        members.offsets[c + 1] - members.offsets[c]);
    if (own.empty()) return;
    cv::Mat row = centres.row(static_cast<int>(c));
    const cv::Mat before = row.clone();
    points.type() == CV_32F ? mean_of(points, own, row) : majority_of(points, own, row);
    has_moved[c] = !std::equal(row.data, row.data + row.elemSize() * row.total(), before.data);
  });
  return has_moved;
}

}  // namespace vpr
