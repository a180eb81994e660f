// Matches, and what they become: connected components (DBSCAN with min_points 1), confirmed tracks,
// or runs of places.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/monitor.h"

namespace vpr {

/// Windows are named by their first frame; those of FAB-MAP are single frames.
struct Match {
  uint32_t query = 0;   ///< window of the query
  uint32_t target = 0;  ///< training sequence; 0, the only one, of places
  uint32_t train = 0;   ///< window of the sequence; index of a place
  uint32_t view = 0;    ///< of a place, its likeliest; 0 of a window
  double score = 0;     ///< as ScoreKind says: a whole number summed over the window, or the
                        ///< probability of the view

  bool operator==(const Match&) const = default;
};

/// Which recognitions are neighbors.
struct ClusterSettings {
  int64_t eps = 2;            ///< Euclidean, in frames of the (train, query) plane; 0 to kMaxEps
  bool eps_inclusive = true;  ///< is a distance of exactly eps inside? (published program: no)
};
/// The largest eps.
inline constexpr int64_t kMaxEps = 1000;

template <class Visitor>
void visit_fields(ClusterSettings& settings, Visitor&& visit) {
  visit("eps", settings.eps);
  visit("eps_inclusive", settings.eps_inclusive);
}

/// A cluster of recognitions: one recognized place. Windows by their first frame; means rounded
/// half up.
struct Cluster {
  uint32_t target = 0;
  uint32_t query_window = 0;  ///< mean over the recognitions; of a track, its middle recognition
  uint32_t query_first = 0;
  uint32_t query_last = 0;
  uint32_t train_window = 0;  ///< the same
  uint32_t train_first = 0;
  uint32_t train_last = 0;
  uint64_t recognitions = 0;
  double best_score = 0;  ///< the smallest

  bool operator==(const Cluster&) const = default;
};

/// What recognitions become.
struct Clusters {
  std::vector<Cluster> all;
  std::vector<uint32_t> of_recognition;  ///< one a recognition: the index of its cluster
};

/// `recognitions`: of one training sequence, sorted by query window then train window, each pair
/// once. Clusters in the order of their first recognition. Time near-linear in the recognitions for
/// a given eps. Throws Error(interrupted) on a stop.
Clusters cluster_recognitions(std::span<const Match> recognitions, const ClusterSettings& settings,
                              const Monitor& monitor = {});

/// The same for recognitions of `targets` training sequences, sorted by query window, sequence,
/// train window: clusters of each sequence, one after the other.
Clusters cluster_by_target(std::span<const Match> recognitions, size_t targets,
                           const ClusterSettings& settings, const Monitor& monitor = {});

/// Confirmed tracks of the filter: successive recognitions on the same track in the same target are
/// one cluster; a recognition without a track is a cluster of its own. `recognitions`: sorted by
/// query frame. `tracks`: track number per query frame, 0 for none. query_window and train_window
/// of a cluster are those of its middle recognition (of an even number, the later one). Clusters
/// are in the order of their first recognitions.
Clusters cluster_tracks(std::span<const Match> recognitions, std::span<const uint32_t> tracks);

/// Training frames per query frame along a track; none for a track of one query frame.
std::optional<double> mean_rate(const Cluster& track);

/// Recognitions that belong together.
struct PlaceRun {
  size_t first_frame = 0;
  size_t last_frame = 0;
  uint32_t first_place = 0;  ///< the smallest index
  uint32_t last_place = 0;
  size_t recognitions = 0;
  double probability = 0;  ///< the largest

  bool operator==(const PlaceRun&) const = default;
};

/// `recognitions` are a result's: by frame, then place. A recognition belongs to the latest run
/// that has a recognition at most `reach` (at least 1) frames before it, in a place whose index is
/// at most `reach_places` away: 0 for places of many views, more where each training frame is a
/// place of its own. Runs are in the order of their first recognitions.
std::vector<PlaceRun> place_runs(std::span<const Match> recognitions, size_t reach,
                                 size_t reach_places);

}  // namespace vpr
