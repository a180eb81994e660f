// What a query gives, by any method: the content of a result file.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "decide/clustering.h"
#include "decide/margin_scan.h"
#include "decide/query_settings.h"
#include "decide/row_scan.h"
#include "sequence/sequence.h"

namespace vpr {

/// What a query is compared with: a training sequence of the database, and the threshold used for
/// it; or, of FAB-MAP, all its places, which have indices as frames have.
struct Target {
  Sequence sequence;                ///< its frames may be places
  size_t windows = 0;               ///< without an unreadable frame
  bool searched = true;             ///< false: left out by only_sequences
  std::optional<double> threshold;  ///< t_r on its scale; none: no automatic one exists, or t_p
  ThresholdScale scale = ThresholdScale::bits;
  uint32_t distance_limit = 0;           ///< a recognition has D (a biased sum of scores) below
  std::optional<uint32_t> max_distance;  ///< max(D), where the scale is relative
  std::optional<double> margin = {};     ///< X, where the decision is by margin
};

/// The training statistics that z-scores started from.
struct UsedStatistics {
  StatisticsSettings settings;
  double typical_distance = 0;
};

/// What an approximate method found of what there is.
struct SearchRecall {
  size_t windows = 0;       ///< query windows that have a best match
  size_t found_best = 0;    ///< whose smallest distance was found
  size_t recognitions = 0;  ///< that there are below the thresholds
};

/// Where stretches of frames that look alike begin.
struct ResultViews {
  std::vector<uint32_t> query;               ///< first frames, rising, from 0 on
  std::vector<std::vector<uint32_t>> train;  ///< the same, per training sequence
};

/// What the only target's indices are, where they are no frames: places, each of one view or more.
struct ResultPlaces {
  std::vector<std::string> names;  ///< by index
  size_t views = 0;                ///< of all places
  size_t featureless = 0;          ///< query frames that could be decoded, but show no word
  std::vector<double> new_place;   ///< probability, per frame; 0 for an unreadable one
};

/// What the filter reports per query frame besides the best match.
struct ResultPath {
  std::vector<double> nowhere;   ///< score of being at no training frame; NaN: unreadable frame
  std::vector<double> rates;     ///< training frames per query frame; NaN: not known yet
  std::vector<uint32_t> tracks;  ///< number of the confirmed track, from 1 on; 0: none

  /// `frames` query frames that nothing is known of.
  explicit ResultPath(size_t frames = 0);
};

/// What a query gave, whatever its method.
struct Result {
  QuerySettings settings;
  Sequence query;
  size_t query_windows = 0;     ///< frames - window_length() + 1; those with an unreadable frame
                                ///< included
  std::vector<Target> targets;  ///< training sequences, or one: places
  std::vector<Match> recognitions;         ///< by query, target, train; each once
  std::vector<std::optional<Match>> best;  ///< per query window; ties to the first. None: a window
                                           ///< with an unreadable frame, or a frame without words
  std::vector<double> best_rates;  ///< of windows of several rates: training frames a query frame
                                   ///< of each best match; no number where there is none
  /// By how much the best match of each query window is better than the best one elsewhere, in its
  /// score; none where there is no elsewhere. Empty where margins are not known: of approximate
  /// methods, of FAB-MAP, and of results of older date.
  std::vector<std::optional<double>> margins;
  std::optional<Clusters> clusters;    ///< of the recognitions: by target, then first recognition;
                                       ///< tracks by first recognition
  std::optional<SearchRecall> recall;  ///< of an approximate method
  std::optional<UsedStatistics> statistics;  ///< of z-scores
  std::optional<ResultPath> path;            ///< of the filter
  std::optional<ResultViews> views;          ///< none where no typical distance is known
  std::optional<ResultPlaces> places;        ///< of FAB-MAP

  const ScoreKind& score() const { return score_of(settings); }
  size_t window_length() const { return window_length_of(settings); }
};

/// The margin of a query window, in score a frame; none where it has none.
std::optional<double> frame_margin(const Result& result, size_t query_window);

/// Clusters the recognitions of a sequence method: by distance, or by track for the filter.
void cluster(Result& result, const Monitor& monitor = {});

/// The frame at which a window is judged, where the user is: its last one.
inline size_t anchor_of(size_t window, size_t window_length) { return window + window_length - 1; }

/// Query windows with at least one recognition.
size_t recognized_windows(const Result& result);

}  // namespace vpr
