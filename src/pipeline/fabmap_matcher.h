// The likelihoods of one frame: of every view, and of the new place.
#pragma once

#include <vector>

#include "base/share.h"
#include "database/fabmap_database.h"
#include "matching/fabmap.h"
#include "recognition/query_settings.h"

namespace vpr {

/// Views in a row of a database, and their inverted index.
struct ViewPart {
  ItemRange range;
  ViewWords views;
  WordIndex lists;
  std::vector<size_t> unreadable;  ///< rising, from the first of the part
};

/// Everything that stays the same for all frames of a query. `database` and `settings` must outlive
/// it; it is not copied, for its indices refer to its lists.
struct FabmapMatcher {
  FabmapModel model;
  ViewPart own;  ///< of one of several processes; of one alone, its lists are the database's
  FabmapIndex index;
  ViewWords samples;  ///< pretraining frames whose average likelihood is the new place's
  WordIndex sample_lists;
  FabmapIndex sample_index;
  const FabmapDatabase& database;
  const FabmapQuerySettings& settings;
  bool is_alone = true;

  /// Of several processes a step of all. Throws Error(usage) for a variant that they can't share.
  FabmapMatcher(const FabmapDatabase& db, const FabmapQuerySettings& s, uint64_t seed,
                const Share& share = {});
  FabmapMatcher(const FabmapMatcher&) = delete;

  /// Log-likelihoods of this process's ones of the first `known_views` views; minus infinity for
  /// one that could not be decoded, for it shows no words, which is no likeness.
  std::vector<double> views(const WordSet& words, size_t known_views) const;
  /// Log-likelihood of the new place.
  double new_place(const WordSet& words) const;
};

}  // namespace vpr
