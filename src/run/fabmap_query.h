// FAB-MAP in one call: words in, posteriors and recognitions out.
#pragma once

#include <functional>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "base/monitor.h"
#include "decide/query_settings.h"
#include "decide/result.h"
#include "fabmap/database.h"
#include "fabmap/model.h"
#include "fabmap/train.h"

namespace vpr {

/// A result, and how long each step took.
struct FabmapRun {
  Result result;
  std::map<std::string, double> seconds;  ///< by step
};

/// Takes the posterior of every frame in order (new place first); empty for an unreadable frame.
/// With `loop` it grows: views come in the order of frames, and are no part of it before they are
/// known.
using PosteriorObserver = std::function<void(size_t frame, std::span<const double> posterior)>;

/// Checks settings. Throws Error(usage) for what is out of range.
void check_query_settings(const FabmapQuerySettings& settings);

/// Appends the places whose views have been above t_p for so many frames in a row, each by its
/// likeliest such view. `posterior`: new place first; of a frame that recognizes nothing, empty.
void append_recognitions(std::vector<Match>& recognitions, size_t frame,
                         std::span<const double> posterior, const ViewWindow& window,
                         uint64_t frames_in_a_row, const std::vector<uint32_t>& place_of);

/// The database with every frame of the query as a place of its own behind it: what `loop`
/// searches.
FabmapDatabase with_query(const FabmapDatabase& database, const SequenceWords& query,
                          const std::string& query_name);

/// Recognizes every frame of the query in order. An unreadable frame and a frame without words have
/// no best match and no recognition, and break a window of c_w frames. The same for any number of
/// threads. Throws Error(usage) for settings out of range, or a database without places unless
/// `loop`.
FabmapRun query_fabmap(const FabmapDatabase& database, const SequenceWords& query,
                       const std::string& query_name, const FabmapQuerySettings& settings,
                       uint64_t seed, const PosteriorObserver& observe, const Monitor& monitor);

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
