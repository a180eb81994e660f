#include "reference/reference_words.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <tuple>
#include <utility>

#include <opencv2/core/mat.hpp>

#include "fabmap/word_clustering.h"

namespace vpr {
namespace {

/// An edge between words a < b.
struct Edge {
  double information = 0;
  uint32_t a = 0;
  uint32_t b = 0;
};

bool shows(const WordSet& frame, size_t word) {
  return std::binary_search(frame.begin(), frame.end(), word);
}

double smoothed(size_t n, size_t of) {
  return 0.98 * (of == 0 ? 0 : static_cast<double>(n) / static_cast<double>(of)) + 0.01;
}

// Sets the parents of all words that the edges connect with `word`.
void orient(const std::vector<Edge>& edges, uint32_t word, std::vector<uint32_t>& parent) {
  for (const Edge& edge : edges) {
    if (edge.a != word && edge.b != word) continue;
    const uint32_t next = edge.a == word ? edge.b : edge.a;
    if (next == parent[word]) continue;
    parent[next] = word;
    orient(edges, next, parent);
  }
}

}  // namespace

ChowLiuTree reference_chow_liu(std::span<const WordSet> frames, size_t words) {
  const auto count = [&](size_t a, size_t b) {
    return static_cast<size_t>(
        std::count_if(frames.begin(), frames.end(),
                      [&](const WordSet& frame) { return shows(frame, a) && shows(frame, b); }));
  };
  std::vector<size_t> counts;
  for (size_t q = 0; q < words; ++q) counts.push_back(count(q, q));
  const MutualInformation information(frames.size());
  std::vector<Edge> all;
  for (uint32_t a = 0; a < words; ++a)
    for (uint32_t b = a + 1; b < words; ++b)
      all.push_back({information(counts[a], counts[b], count(a, b)), a, b});
  std::sort(all.begin(), all.end(), [](const Edge& x, const Edge& y) {
    return std::tuple(-x.information, x.a, x.b) < std::tuple(-y.information, y.a, y.b);
  });
  std::vector<size_t> component(words);
  std::iota(component.begin(), component.end(), size_t{0});
  std::vector<Edge> edges;
  for (const Edge& edge : all) {
    const size_t from = component[edge.a];
    const size_t to = component[edge.b];
    if (from == to) continue;
    edges.push_back(edge);
    std::replace(component.begin(), component.end(), from, to);
  }
  ChowLiuTree tree;
  tree.parent.resize(words);
  const uint32_t root = edges.empty() ? 0 : edges.front().a;
  tree.parent[root] = root;
  orient(edges, root, tree.parent);
  for (size_t q = 0; q < words; ++q) {
    const uint32_t parent = tree.parent[q];
    const size_t both = count(q, parent);
    tree.p.push_back(smoothed(counts[q], frames.size()));
    tree.p_given.push_back(parent == q ? tree.p[q] : smoothed(both, counts[parent]));
    tree.p_given_not.push_back(
        parent == q ? tree.p[q] : smoothed(counts[q] - both, frames.size() - counts[parent]));
  }
  return tree;
}

cv::Mat reference_radius_words(const cv::Mat& descriptors, double radius) {
  const double limit = descriptors.type() == CV_8U ? radius : radius * radius;
  std::vector<size_t> centers;
  const auto nearest_of = [&](size_t i) {
    size_t best = centers.size();
    double least = std::numeric_limits<double>::infinity();
    for (size_t c = 0; c < centers.size(); ++c) {
      const double distance = squared_distance(descriptors, i, centers[c]);
      if (distance >= least) continue;
      least = distance;
      best = c;
    }
    return std::pair(best, least);
  };
  const auto n = static_cast<size_t>(descriptors.rows);
  for (size_t i = 0; i < n; ++i)
    if (centers.empty() || nearest_of(i).second > limit) centers.push_back(i);
  std::vector<NearestCenter> assigned;
  for (size_t i = 0; i < n; ++i)
    assigned.push_back({0, static_cast<uint32_t>(nearest_of(i).first)});
  cv::Mat words = rows_of(descriptors, centers);
  move_centers(descriptors, assigned, words, {});
  return words;
}

}  // namespace vpr
