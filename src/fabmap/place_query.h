// A FAB-MAP query, from words to posteriors and recognitions.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "base/monitor.h"
#include "fabmap/database.h"
#include "fabmap/model.h"
#include "fabmap/word_training.h"
#include "query/fabmap_settings.h"
#include "query/result.h"
#include "query/run_query.h"
#include "query/setting_rows.h"

namespace vpr {

/// Receives the posterior of every frame, in order: the new place, then the views; empty for an
/// unreadable frame. With `loop` it grows: the views of query frames follow in the order of frames,
/// each once it may be matched.
using PosteriorObserver = std::function<void(size_t frame, std::span<const double> posterior)>;

/// The heading of FAB-MAP's flags in the help.
inline constexpr const char* kFabmapGroup = "FAB-MAP";

/// The settings of FAB-MAP that have flags.
std::span<const SettingRow> fabmap_setting_rows();

/// Throws Error(usage) for a setting out of range.
void check_query_settings(const FabmapQuerySettings& settings);

/// Appends the places with a view above t_p for `window_length` consecutive frames (c_w), each by
/// the likeliest such view. `posterior`: the new place first; empty for a frame that recognizes
/// nothing.
void append_recognitions(std::vector<Match>& recognitions, size_t frame,
                         std::span<const double> posterior, const ViewWindow& window,
                         uint64_t window_length, const std::vector<uint32_t>& place_of);

/// Recognizes every frame of the query in order. An unreadable frame and a frame without words have
/// no best match and no recognition, and interrupt a window of c_w frames. Throws Error(usage) for
/// settings out of range, or a database without places unless `loop`.
QueryRun query_fabmap(const FabmapDatabase& database, const SequenceWords& query,
                      const std::string& query_name, const FabmapQuerySettings& settings,
                      uint64_t seed, const PosteriorObserver& observe, const Monitor& monitor);

/// The part of a query that is the same for all frames. `database` and `settings` must outlive it.
/// Not copyable, because its indices refer to its lists.
struct FabmapMatcher {
  FabmapModel model;
  FabmapIndex index;
  ViewWords samples;  ///< pretraining frames; their average likelihood is the new place's
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
