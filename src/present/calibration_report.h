// What a labeled walk says of thresholds, as JSON and as text.
#pragma once

#include <optional>
#include <string>

#include "base/json_fwd.h"
#include "present/run_info.h"
#include "present/table.h"
#include "run/calibrate.h"

namespace vpr {

/// How the calibration was asked for.
struct CalibrationRequest {
  double precision = 1;
  std::optional<double> fps;  ///< frames of the query a second; none: not known
};

/// The schema "vpr.calibration/1"; `settings` in it is what vpr-query --config takes, or null.
Json calibration_json(const CalibratedWalk& walk, const CalibrationRequest& request,
                      const RunInfo& run, double seconds);

/// A row for each window length; the chosen one has a star.
Table calibration_table(const CalibratedWalk& walk);

/// The threshold in words, with the false recognitions to expect, or why there is none. Ends with a
/// line feed.
std::string calibration_text(const CalibratedWalk& walk, const CalibrationRequest& request);

/// Why no threshold was found, and what to do.
std::string calibration_failure(const CalibratedWalk& walk);

}  // namespace vpr
