// What a query by a sequence method gives: the content of a result file.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "recognition/clustering.h"
#include "recognition/row_scan.h"
#include "recognition/threshold.h"

namespace vpr {

/// Everything that can change a result. JSON keys are the names of the flags.
struct SequenceQuerySettings {
  std::string method = "fastable";
  uint64_t window_length = 40;                                ///< c_l
  std::optional<double> distance_threshold;                   ///< t_r; none: automatic
  ThresholdScale threshold_scale = ThresholdScale::relative;  ///< of a number; automatic is bits
  std::optional<double> safety_factor;      ///< of automatic t_r; none: the database's
  std::vector<std::string> only_sequences;  ///< empty: all
  bool skip_unreadable = false;
  ClusterSettings clustering;
  LshSettings lsh;  ///< of the method lsh
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
}

/// A training sequence of the database, and the threshold used for it.
struct SequenceThreshold {
  std::string name;
  size_t frames = 0;
  size_t windows = 0;
  bool searched = true;             ///< false: left out by only_sequences
  std::optional<double> threshold;  ///< t_r on its scale; none: no automatic one exists
  ThresholdScale scale = ThresholdScale::bits;
  uint32_t distance_limit = 0;           ///< a hit has D below
  std::optional<uint32_t> max_distance;  ///< max(D), where the scale is relative
};

/// What an approximate method found of what there is.
struct SearchRecall {
  size_t windows = 0;     ///< query windows that have a best match
  size_t found_best = 0;  ///< whose smallest distance was found
  size_t hits = 0;        ///< that there are below the thresholds
};

struct SequenceResult {
  SequenceQuerySettings settings;
  std::string query_name;
  size_t query_frames = 0;
  std::vector<size_t> query_unreadable;
  size_t query_windows = 0;  ///< query_frames - c_l + 1; those with an unreadable frame included
  std::vector<SequenceThreshold> sequences;
  std::vector<Cell> hits;                 ///< by query window, sequence, train window
  std::vector<std::optional<Cell>> best;  ///< per query window
  std::vector<Recognition> places;        ///< by sequence, then first hit
  std::optional<SearchRecall> recall;     ///< of an approximate method

  /// Where the user is at the end of a window that starts at this frame.
  size_t anchor(size_t window) const { return window + settings.window_length - 1; }
};

}  // namespace vpr
