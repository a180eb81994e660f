#include "tune/calibration_report.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/json.h"
#include "base/text.h"
#include "sequence/sequence_json.h"

namespace vpr {
namespace {

constexpr double kSecondsPerHour = 3600;

/// False recognitions to expect in another number of windows.
struct ScaledRate {
  double expected = 0;
  Interval interval;
};

ScaledRate rate_of(const CalibratedLength& length, double windows) {
  const FalseRecognitions& found = length.calibration.expected;
  const double factor = windows / static_cast<double>(length.windows);
  return {static_cast<double>(found.seen) * factor,
          {found.interval.low * factor, found.interval.high * factor}};
}

Json rate_json(const ScaledRate& rate) {
  return {{"expected", rate.expected}, {"interval", {rate.interval.low, rate.interval.high}}};
}

Json length_json(const CalibratedLength& length) {
  const Calibration& found = length.calibration;
  Json json = {{"c_l", length.settings.window_length},
               {"windows", length.windows},
               {"queries", length.queries},
               {"advice", enum_name(found.advice)},
               {"margin", nullptr}};
  if (!found.strength) return json;
  json["margin"] = *length.settings.margin;
  json["recognized"] = {{"correct", found.correct}, {"incorrect", found.incorrect}};
  json["false_recognitions"] = {
      {"block", length.block},
      {"seen", found.expected.seen},
      {"interval", {found.expected.interval.low, found.expected.interval.high}}};
  return json;
}

}  // namespace

Json calibration_json(const CalibratedSequence& calibrated, const CalibrationRequest& request,
                      const RunInfo& run, double seconds) {
  Json json = {{"schema", "vpr.calibration/3"},
               {"settings", nullptr},
               {"query", {{"name", calibrated.query.name}, {"ground_truth", calibrated.protocol}}},
               {"precision", request.precision},
               {"chosen", or_null(calibrated.chosen)},
               {"lengths", Json::array()}};
  json["query"].update(value_to_json(calibrated.query.selection, kDataForm));
  for (const CalibratedLength& length : calibrated.lengths)
    json["lengths"].push_back(length_json(length));
  if (calibrated.chosen) {
    const CalibratedLength& length = calibrated.lengths[*calibrated.chosen];
    json["settings"] = settings_in_force(length.settings);
    json["in_1000_windows"] = rate_json(rate_of(length, 1000));
    if (request.fps) {
      json["fps"] = *request.fps;
      json["in_an_hour"] = rate_json(rate_of(length, *request.fps * kSecondsPerHour));
    }
  }
  json["provenance"] = provenance_json(run);
  add_run(json, run, {{"calibrate", seconds}});
  return json;
}

Table calibration_table(const CalibratedSequence& calibrated) {
  Table table;
  table.title = fmt::format("{}: windows recognized at the margin found{}", calibrated.query.name,
                            calibrated.chosen ? " (* chosen)" : "");
  table.columns = {"c_l", "margin", "correct", "incorrect", "of", "false recognitions", "95 %"};
  for (size_t l = 0; l < calibrated.lengths.size(); ++l) {
    const CalibratedLength& length = calibrated.lengths[l];
    const Calibration& found = length.calibration;
    const std::string name =
        fmt::format("{}{}", length.settings.window_length, calibrated.chosen == l ? "*" : "");
    if (!found.strength) {
      add_row(table, name, "-", "-", "-", length.windows, "-", "-");
      continue;
    }
    const Interval& interval = found.expected.interval;
    add_row(table, name, fmt::format("{:.4g}", *length.settings.margin), found.correct,
            found.incorrect, length.windows, found.expected.seen,
            fmt::format("{:.1f} to {:.1f}", interval.low, interval.high));
  }
  return table;
}

std::string calibration_text(const CalibratedSequence& calibrated,
                             const CalibrationRequest& request) {
  if (!calibrated.chosen)
    return fmt::format("{}: no margin: {}.\n", calibrated.query.name,
                       calibration_failure(calibrated));
  const CalibratedLength& length = calibrated.lengths[*calibrated.chosen];
  const Calibration& found = length.calibration;
  std::string text = fmt::format(
      "{}: margin {:.4g} at c_l {}: {} recognized correctly and {} incorrectly, of {} whose place "
      "is trained.\n",
      calibrated.query.name, *length.settings.margin, length.settings.window_length,
      counted(found.correct, "window"), found.incorrect, length.queries);
  const ScaledRate rate =
      request.fps ? rate_of(length, *request.fps * kSecondsPerHour) : rate_of(length, 1000);
  text += fmt::format("False recognitions to expect in {}: {:.0f} (95 %: {:.0f} to {:.0f}).\n",
                      request.fps ? "an hour" : "1000 windows", rate.expected, rate.interval.low,
                      rate.interval.high);
  return text + "Expect more in other rooms and at another speed.\n";
}

std::string calibration_failure(const CalibratedSequence& calibrated) {
  // The length with the most queries is the best explanation.
  const CalibratedLength& length =
      *std::ranges::max_element(calibrated.lengths, {}, &CalibratedLength::queries);
  if (length.calibration.advice == CalibrationAdvice::no_right_recognition)
    return "no window is recognized correctly; check that the ground truth belongs to this query";
  return "at every setting that recognizes a window correctly, others are incorrect, or would be "
         "if their place were not trained";
}

}  // namespace vpr
