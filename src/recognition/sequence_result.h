// What a query by a sequence method gives: the content of a result file.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/json_fwd.h"
#include "recognition/clustering.h"
#include "recognition/row_scan.h"
#include "recognition/score_kind.h"
#include "recognition/threshold.h"

namespace vpr {

/// Everything that can change a result. JSON keys are the names of the flags.
struct SequenceQuerySettings {
  std::string method = "fastable";
  uint64_t window_length = 40;               ///< c_l
  std::optional<double> distance_threshold;  ///< t_r; none: automatic
  /// Of a number; automatic ones are mean, bits or mean_z. None: relative, or mean_z.
  std::optional<ThresholdScale> threshold_scale;
  std::optional<double> safety_factor;      ///< of automatic t_r; none: the database's
  std::vector<std::string> only_sequences;  ///< empty: all
  bool skip_unreadable = false;
  ClusterSettings clustering;
  LshSettings lsh;  ///< of the method lsh
  Score score = Score::raw;
  double safety_margin = 0;  ///< subtracted from automatic t_r of standardized scores
  StandardizationSettings standardization;
};

template <class Visitor>
void visit_fields(SequenceQuerySettings& settings, Visitor&& visit) {
  visit("method", settings.method);
  visit("c_l", settings.window_length);
  visit("t_r", settings.distance_threshold);
  visit("t_r_scale", settings.threshold_scale);
  visit("safety_factor", settings.safety_factor);
  visit("only_sequence", settings.only_sequences);
  visit("skip_unreadable", settings.skip_unreadable);
  visit("clustering", settings.clustering);
  visit("lsh", settings.lsh);
  visit("score", settings.score);
  visit("safety_margin", settings.safety_margin);
  visit("standardization", settings.standardization);
}

/// The scale that a number is on: the one that was given, or the score's default.
ThresholdScale scale_of(const SequenceQuerySettings& settings);

/// The settings as files hold them: the default scale filled in, and those of other scores left out
/// (score_settings).
Json settings_in_force(const SequenceQuerySettings& settings);

/// A training sequence of the database, and the threshold used for it.
struct SequenceThreshold {
  std::string name;
  size_t frames = 0;
  size_t windows = 0;
  bool searched = true;             ///< false: left out by only_sequences
  std::optional<double> threshold;  ///< t_r on its scale; none: no automatic one exists
  ThresholdScale scale = ThresholdScale::bits;
  uint32_t distance_limit = 0;            ///< a hit has D (a biased sum of scores) below; on the
                                          ///< scale mean, the largest that a query window has
  std::optional<uint32_t> max_distance;   ///< max(D), where the scale is relative
  std::vector<double> window_means = {};  ///< M by query window, where the scale is mean; not in
                                          ///< files
};

/// The training statistics that standardized scores started from.
struct UsedStatistics {
  StatisticsSettings settings;
  double typical_distance = 0;
};

/// What an approximate method found of what there is.
struct SearchRecall {
  size_t windows = 0;     ///< query windows that have a best match
  size_t found_best = 0;  ///< whose smallest distance was found
  size_t hits = 0;        ///< that there are below the thresholds
};

/// Where stretches of frames that look alike begin (matching/views.h).
struct ResultViews {
  std::vector<uint32_t> query;               ///< first frames, rising, from 0 on
  std::vector<std::vector<uint32_t>> train;  ///< the same, per training sequence
};

struct SequenceResult {
  SequenceQuerySettings settings;
  std::string query_name;
  size_t query_frames = 0;
  std::vector<size_t> query_unreadable;
  size_t query_windows = 0;  ///< query_frames - c_l + 1; those with an unreadable frame included
  std::vector<SequenceThreshold> sequences;
  std::vector<Cell> hits;                    ///< by query window, sequence, train window
  std::vector<std::optional<Cell>> best;     ///< per query window
  std::vector<Recognition> places;           ///< by sequence, then first hit
  std::vector<uint32_t> place_of;            ///< one a hit: the index of its place
  std::optional<SearchRecall> recall;        ///< of an approximate method
  std::optional<UsedStatistics> statistics;  ///< of standardized scores
  std::optional<ResultViews> views;          ///< none where no typical distance is known

  /// By how much the sums of rows are above the scores that files hold.
  int64_t score_offset() const { return score_kind(settings.score).offset(settings.window_length); }
  /// Where the user is at the end of a window that starts at this frame.
  size_t anchor(size_t window) const { return window + settings.window_length - 1; }
};

/// Clusters the hits into `places`, and notes in `place_of` which hit is in which.
void cluster(SequenceResult& result, const Monitor& monitor = {});

}  // namespace vpr
