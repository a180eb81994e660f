// A threshold for queries without ground truth, chosen on a query with ground truth, and its report
// (vpr.calibration/3).
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/enum_names.h"
#include "base/json_fwd.h"
#include "base/statistics.h"
#include "decide/exclusion_zones.h"
#include "evaluate/evaluation.h"
#include "files/run_info.h"
#include "present/table.h"
#include "run/query.h"
#include "truth/ground_truth.h"

namespace vpr {

/// The margins of query windows if neither their place nor its surroundings were trained. The
/// matches that they belong to are all incorrect. Takes rows as MarginScan does. Windows are judged
/// at their anchors; the surroundings are the frames within the exclusion radius of a frame labeled
/// same or ignore.
class UnknownPlaceScan {
 public:
  /// `truth` and `zones` must outlive the scan.
  UnknownPlaceScan(const GroundTruth& truth, const ExclusionZones& zones, size_t window_length,
                   size_t query_windows)
      : truth_(truth),
        zones_(zones),
        window_length_(window_length),
        untrained_(zones, query_windows) {}
  void operator()(std::span<const ScoreRow> row);
  /// One per query window; unset without a runner-up.
  std::vector<std::optional<uint32_t>> result() const { return untrained_.result(); }

 private:
  const GroundTruth& truth_;
  const ExclusionZones& zones_;
  size_t window_length_;
  MarginScan untrained_;
};

/// The strengths of one query window: margins, summed over the window.
struct CalibrationWindow {
  std::optional<int64_t> correct;        ///< the margin of its best match, if that is correct
  std::optional<int64_t> incorrect;      ///< the same, if that is incorrect
  std::optional<int64_t> unknown_place;  ///< the result of UnknownPlaceScan
};

enum class CalibrationAdvice {
  calibrated,
  no_right_recognition,  ///< not even at the minimum strength
  none_is_safe           ///< no strength with a correct recognition reaches the precision
};
template <>
inline constexpr std::array<std::string_view, 3> kEnumNames<CalibrationAdvice> = {
    "calibrated", "no_right_recognition", "none_is_safe"};

struct CalibrationSettings {
  double precision = 1;  ///< share of correct windows among recognized ones: above 0, at most 1
  int64_t least = 1;     ///< minimum strength
  size_t block = 1;      ///< consecutive windows that share frames: at least 1
  uint64_t seed = 1;     ///< of the bootstrap
};

/// Expected runs of consecutive incorrect windows in a query as long as the one of the calibration.
struct FalseRecognitions {
  uint64_t seen = 0;  ///< at strengths chosen without the part of the query that contains them
  Interval interval;  ///< 95 %
};

struct Calibration {
  CalibrationAdvice advice = CalibrationAdvice::no_right_recognition;
  std::optional<int64_t> strength;  ///< if the advice is `calibrated`
  uint64_t correct = 0;             ///< windows with a correct recognition
  uint64_t incorrect = 0;           ///< windows with an incorrect recognition
  FalseRecognitions expected;
};

/// The smallest strength that reaches the precision and has a correct window. For precision 1, it
/// is just above all `incorrect` and `unknown_place` strengths; for a lower precision, it is the
/// strength of a window, and `unknown_place` is ignored. Windows must be in the order of the query.
Calibration calibrate(std::span<const CalibrationWindow> windows,
                      const CalibrationSettings& settings);

/// The calibration of one window length.
struct CalibratedLength {
  SequenceQuerySettings settings;  ///< with the calibrated margin, if there is one
  Calibration calibration;
  size_t windows = 0;  ///< of the query
  size_t queries = 0;  ///< windows at a trained place
  size_t block = 1;    ///< consecutive windows of a bootstrap block
};

/// Reads the ground truth for the indices of a result.
using TruthReader = std::function<GroundTruth(const GroundTruthScope&)>;
/// Reads it as whole_truth_of does. The monitor must outlive the reader.
TruthReader reader_of(const EvaluationSettings& by, const Monitor& monitor);

/// The calibration of every window length, and the recommended length.
struct CalibratedSequence {
  Sequence query;
  std::string protocol;                   ///< of the ground truth, in words
  std::vector<CalibratedLength> lengths;  ///< increasing c_l
  /// The shortest with at least 0.7 of the correctly recognized windows of the best length; index.
  size_t chosen = 0;
  double precision = 1;
  std::optional<double> fps = {};  ///< of the query, if known, for the report
};

/// `base`: the settings except c_l and the margin. `lengths`: c_l; ignored for the filter, which
/// has windows of one frame. Throws Error(usage) for a precision that is not above 0 and at most 1,
/// and if the ground truth has no query window at a trained place; Error(expectation), with a
/// remedy, if no length has a margin; also throws what plan_query and run_query throw.
CalibratedSequence calibrate_sequence(const SequenceDatabase& database, const DescriptorSet& query,
                                      const std::string& query_name, const ResolvedSettings& base,
                                      std::vector<uint64_t> lengths, double precision,
                                      const TruthReader& read_truth,
                                      const QueryResources& resources, const Monitor& monitor);

/// "settings" is a configuration for vpr-query --config.
Json calibration_json(const CalibratedSequence& calibrated, const RunInfo& run, double seconds);

/// A row per window length; the chosen one has a star.
Table calibration_table(const CalibratedSequence& calibrated);

/// The margin and the false recognitions to expect. Ends with a line feed.
std::string calibration_text(const CalibratedSequence& calibrated);

}  // namespace vpr
