#include "database/kmeans.h"

#include <algorithm>
#include <vector>

#include <fmt/format.h>

#include "base/error.h"
#include "base/parallel.h"
#include "database/kmeans_seeds.h"
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

// Moves every centre to its members; says which ones moved.
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

}  // namespace

cv::Mat kmeans_words(const cv::Mat& descriptors, const KmeansSettings& settings,
                     const Monitor& monitor) {
  const auto n = static_cast<size_t>(descriptors.rows);
  if (settings.words == 0 || settings.words > n)
    throw Error(ErrorKind::usage,
                fmt::format("{} words can't be made of {} descriptors; give fewer --words or more "
                            "--pretrain frames",
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
