#include "query/clustering.h"

#include <algorithm>
#include <atomic>
#include <set>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "base/random.h"

using namespace vpr;

namespace {

// Pairs of (query, train), in order.
std::vector<Match> cells(const std::vector<std::pair<uint32_t, uint32_t>>& pairs) {
  std::vector<Match> recognitions;
  for (const auto& [query, train] : pairs)
    recognitions.push_back({query, 0, train, 0, double(query + train)});
  return recognitions;
}

// Textbook DBSCAN with min_points 1: breadth-first over all pairs.
std::vector<size_t> slow_labels(const std::vector<Match>& recognitions,
                                const ClusterSettings& settings) {
  std::vector<size_t> label(recognitions.size(), recognitions.size());
  for (size_t start = 0; start < recognitions.size(); ++start) {
    if (label[start] != recognitions.size()) continue;
    std::vector<size_t> open = {start};
    label[start] = start;
    while (!open.empty()) {
      const Match a = recognitions[open.back()];
      open.pop_back();
      for (size_t k = 0; k < recognitions.size(); ++k) {
        const int64_t dq = int64_t{a.query} - recognitions[k].query;
        const int64_t dt = int64_t{a.train} - recognitions[k].train;
        const int64_t squared = dq * dq + dt * dt;
        const int64_t bound = settings.eps * settings.eps;
        const bool near = settings.eps_inclusive ? squared <= bound : squared < bound;
        if (label[k] == recognitions.size() && near) {
          label[k] = start;
          open.push_back(k);
        }
      }
    }
  }
  return label;
}

}  // namespace

TEST_CASE("clustering can be stopped") {
  const std::atomic<bool> stop{true};
  Monitor monitor;
  monitor.stop = &stop;
  CHECK_THROWS_AS(cluster_recognitions(cells({{7, 9}}), {}, monitor), Error);
}

TEST_CASE("no recognitions yield no places, one recognition is one place") {
  CHECK(cluster_recognitions({}, {}).all.empty());
  const auto places = cluster_recognitions(cells({{7, 9}}), {}).all;
  REQUIRE(places.size() == 1);
  CHECK(places[0] == Cluster{0, 7, 7, 7, 9, 9, 9, 1, 16});
}

TEST_CASE("a distance of exactly eps is inside, except with the rule of the published program") {
  const auto straight = cells({{0, 0}, {0, 2}});
  CHECK(cluster_recognitions(straight, {}).all.size() == 1);
  CHECK(cluster_recognitions(straight, {2, false}).all.size() == 2);
  CHECK(cluster_recognitions(cells({{0, 0}, {0, 3}}), {}).all.size() == 2);
  CHECK(cluster_recognitions(cells({{0, 0}, {2, 0}}), {}).all.size() == 1);
  CHECK(cluster_recognitions(cells({{0, 0}, {2, 1}}), {}).all.size() == 2);  // sqrt 5
  CHECK(cluster_recognitions(cells({{0, 1}, {1, 0}}), {}).all.size() == 1);  // decreasing in train
}

TEST_CASE("indices 0 and 1 do not wrap around") {
  CHECK(cluster_recognitions(cells({{0, 0}, {1, 1}, {2, 4294967295U}}), {}).all.size() == 2);
}

TEST_CASE("means are rounded half up, extents and best distance are kept") {
  const auto places = cluster_recognitions(cells({{10, 20}, {11, 21}, {11, 22}, {12, 22}}), {}).all;
  REQUIRE(places.size() == 1);
  CHECK(places[0].query_window == 11);
  CHECK(places[0].train_window == 21);  // 21.25
  CHECK((places[0].query_first == 10 && places[0].query_last == 12));
  CHECK((places[0].train_first == 20 && places[0].train_last == 22));
  CHECK((places[0].recognitions == 4 && places[0].best_score == 30));
  CHECK(cluster_recognitions(cells({{0, 0}, {1, 0}}), {}).all[0].query_window == 1);  // 0.5
}

TEST_CASE("clusters equal textbook DBSCAN") {
  RandomEngine engine(1);
  for (int round = 0; round < 60; ++round) {
    const uint64_t side = 8 + uniform_below(engine, 30);
    std::set<std::pair<uint32_t, uint32_t>> pairs;
    for (uint64_t i = 0; i < side * side / 6; ++i)
      pairs.emplace(uniform_below(engine, side), uniform_below(engine, side));
    const std::vector<Match> recognitions = cells({pairs.begin(), pairs.end()});
    const ClusterSettings settings{static_cast<int64_t>(uniform_below(engine, 5)), round % 2 == 0};
    const std::vector<size_t> label = slow_labels(recognitions, settings);
    const auto [places, of_recognition] = cluster_recognitions(recognitions, settings);
    const std::set<size_t> roots(label.begin(), label.end());
    REQUIRE(places.size() == roots.size());
    for (size_t h = 0; h < recognitions.size(); ++h)
      REQUIRE(of_recognition[h] == size_t(std::distance(roots.begin(), roots.find(label[h]))));
    size_t place = 0;
    for (const size_t root : roots) {  // in the order of first recognitions, like the places
      REQUIRE(places[place].recognitions == size_t(std::count(label.begin(), label.end(), root)));
      REQUIRE(places[place].query_first == recognitions[root].query);
      ++place;
    }
  }
}

TEST_CASE(
    "places of several sequences follow each other, and every recognition refers to its own "
    "place") {
  // By query window, sequence, train window.
  const std::vector<Match> recognitions = {
      {0, 0, 0, 1}, {0, 2, 0, 1}, {1, 0, 1, 1}, {1, 2, 30, 1}, {9, 0, 9, 1}};
  const Clusters clusters = cluster_recognitions(recognitions, {});
  REQUIRE(clusters.all.size() == 4);
  CHECK((clusters.all[0].sequence == 0 && clusters.all[0].recognitions == 2));
  CHECK((clusters.all[2].sequence == 2 && clusters.all[3].train_window == 30));
  CHECK(clusters.of_recognition == std::vector<uint32_t>{0, 2, 0, 3, 1});
}

TEST_CASE("recognitions on one path are one place, for any steps and gaps between them") {
  // Query frames 3 to 6 on path 1, where frame 5 is not recognized; 8 and 9 on path 2; and 10 on
  // no path.
  const std::vector<uint32_t> paths = {0, 0, 0, 1, 1, 1, 1, 0, 2, 2, 0, 0};
  const std::vector<Match> recognitions = {{3, 1, 40, 0, -5}, {4, 1, 43, 0, -9}, {6, 1, 47, 0, -2},
                                           {8, 0, 9, 0, -4},  {9, 0, 9, 0, -4},  {10, 0, 9, 0, -4},
                                           {11, 0, 9, 0, -4}};
  const Clusters clusters = cluster_paths(recognitions, paths);
  REQUIRE(clusters.all.size() == 4);
  CHECK(clusters.all[0] == Cluster{1, 4, 3, 6, 43, 40, 47, 3, -9});
  CHECK(clusters.all[1] == Cluster{0, 9, 8, 9, 9, 9, 9, 2, -4});
  CHECK(clusters.all[2] == Cluster{0, 10, 10, 10, 9, 9, 9, 1, -4});
  CHECK(clusters.of_recognition == std::vector<uint32_t>{0, 0, 0, 1, 1, 2, 3});
  CHECK(mean_rate(clusters.all[0]) == 7 / 3.0);
  CHECK(mean_rate(clusters.all[1]) == 0);
  CHECK_FALSE(mean_rate(clusters.all[2]));
  CHECK(cluster_paths({}, paths).all.empty());
}

TEST_CASE("a place is one run while it is recognized in consecutive frames") {
  const std::vector<Match> recognitions = {{3, 0, 1, 0, 0.5}, {4, 0, 0, 0, 0.6}, {4, 0, 1, 0, 0.9},
                                           {5, 0, 1, 0, 0.7}, {6, 0, 0, 0, 0.8}, {7, 0, 1, 0, 0.4}};
  CHECK(place_runs(recognitions, 1, 0) == std::vector<PlaceStretch>{{3, 5, 1, 1, {0, 2, 3}, 0.9},
                                                                    {4, 4, 0, 0, {1}, 0.6},
                                                                    {6, 6, 0, 0, {4}, 0.8},
                                                                    {7, 7, 1, 1, {5}, 0.4}});
  CHECK(place_runs({}, 1, 0).empty());
}

TEST_CASE("if each frame is a place, a run is a range of consecutive places") {
  const std::vector<Match> recognitions = {{0, 0, 11, 0, 0.5}, {1, 0, 12, 0, 0.6},
                                           {2, 0, 36, 0, 0.7}, {3, 0, 12, 0, 0.7},
                                           {4, 0, 14, 0, 0.8}, {8, 0, 15, 0, 0.9}};
  CHECK(place_runs(recognitions, 2, 2) ==
        std::vector<PlaceStretch>{
            {0, 4, 11, 14, {0, 1, 3, 4}, 0.8}, {2, 2, 36, 36, {2}, 0.7}, {8, 8, 15, 15, {5}, 0.9}});
}
