// Clusters of recognitions: connected components (DBSCAN with min_points 1), recognized paths,
// and runs of places.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/monitor.h"
#include "query/query_settings.h"

namespace vpr {

/// A match. Windows are identified by their first frame; FAB-MAP has windows of one frame.
struct Match {
  uint32_t query = 0;     ///< window of the query
  uint32_t sequence = 0;  ///< index of the training sequence; 0 for places
  uint32_t train = 0;     ///< window of the sequence, or index of a place
  uint32_t view = 0;      ///< the likeliest view of a place; 0 for a window
  double score = 0;       ///< an integer, summed over the window, or the probability of the view

  bool operator==(const Match&) const = default;
};

/// A cluster of recognitions: one distinct recognition. Means are rounded half up.
struct Cluster {
  uint32_t sequence = 0;
  uint32_t query_window = 0;  ///< mean of the recognitions; for a path, the middle one
  uint32_t query_first = 0;
  uint32_t query_last = 0;
  uint32_t train_window = 0;  ///< likewise
  uint32_t train_first = 0;
  uint32_t train_last = 0;
  uint64_t recognitions = 0;
  double best_score = 0;  ///< the smallest

  bool operator==(const Cluster&) const = default;
};

struct Clusters {
  std::vector<Cluster> all;
  std::vector<uint32_t> of_recognition;  ///< by recognition: the index of its cluster
};

/// Clusters the recognitions of each training sequence, sorted by query window, sequence, train
/// window, each pair once. Clusters are in the order of sequences, then of their first recognition.
/// For a fixed eps, the time is nearly linear in the recognitions. Throws Error(interrupted) on a
/// stop.
Clusters cluster_recognitions(std::span<const Match> recognitions, const ClusterSettings& settings,
                              const Monitor& monitor = {});

/// Consecutive recognitions of one path in one training sequence are a cluster. A recognition
/// without a path is a cluster of its own. `recognitions`: sorted by query frame. `paths`: number
/// of the path by query frame; 0: none. query_window and train_window of a cluster are from its
/// middle recognition (of two, the later one). Clusters are in the order of their first
/// recognition.
Clusters cluster_paths(std::span<const Match> recognitions, std::span<const uint32_t> paths);

/// Training frames per query frame along a path; nullopt for a path of one query frame.
std::optional<double> mean_rate(const Cluster& path);

/// Recognitions of nearby places in nearby frames.
struct PlaceStretch {
  size_t first_frame = 0;
  size_t last_frame = 0;
  uint32_t first_place = 0;  ///< the smallest index
  uint32_t last_place = 0;
  std::vector<uint32_t> recognitions = {};  ///< indices
  double probability = 0;                   ///< the largest

  bool operator==(const PlaceStretch&) const = default;
};

/// `recognitions`: sorted by frame, then place. A recognition belongs to the latest run whose last
/// recognition is at most `reach` (at least 1) frames earlier, with a place index that differs by
/// at most `reach_places`: 0 for places of many views, more if each training frame is a place. Runs
/// are in the order of their first recognition.
std::vector<PlaceStretch> place_runs(std::span<const Match> recognitions, size_t reach,
                                     size_t reach_places);

}  // namespace vpr
