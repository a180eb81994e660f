// Calibrations (vpr.calibration/3) as JSON, table and text.
#pragma once

#include <optional>
#include <string>

#include "base/json_fwd.h"
#include "files/run_info.h"
#include "present/table.h"
#include "tune/calibrate_sequence.h"

namespace vpr {

struct CalibrationRequest {
  double precision = 1;
  std::optional<double> fps;  ///< of the query, if known
};

/// "settings" is a configuration for vpr-query --config, or null.
Json calibration_json(const CalibratedSequence& calibrated, const CalibrationRequest& request,
                      const RunInfo& run, double seconds);

/// A row per window length; the chosen one has a star.
Table calibration_table(const CalibratedSequence& calibrated);

/// The margin and the false recognitions to expect, or calibration_failure. Ends with a line feed.
std::string calibration_text(const CalibratedSequence& calibrated,
                             const CalibrationRequest& request);

/// The reason for a missing margin, and a remedy.
std::string calibration_failure(const CalibratedSequence& calibrated);

}  // namespace vpr
