// The likelihoods of one frame: of every view, and of the new place.
#pragma once

#include <vector>

#include "database/fabmap_database.h"
#include "matching/fabmap.h"
#include "recognition/query_settings.h"

namespace vpr {

/// Everything that stays the same for all frames of a query. `database` and `settings` must outlive
/// it; it is not copied, for its indices refer to its lists.
struct FabmapMatcher {
  FabmapModel model;
  FabmapIndex index;
  ViewWords samples;  ///< pretraining frames whose average likelihood is the new place's
  WordIndex sample_lists;
  FabmapIndex sample_index;
  std::vector<size_t> unreadable;  ///< views, rising
  const FabmapDatabase& database;
  const FabmapQuerySettings& settings;

  FabmapMatcher(const FabmapDatabase& db, const FabmapQuerySettings& s, uint64_t seed);
  FabmapMatcher(const FabmapMatcher&) = delete;

  /// Log-likelihoods of the first `known_views` views; minus infinity for an undecodable view.
  std::vector<double> views(const WordSet& words, size_t known_views) const;
  /// Log-likelihood of the new place.
  double new_place(const WordSet& words) const;
};

}  // namespace vpr
