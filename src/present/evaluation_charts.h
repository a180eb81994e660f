// The charts of an evaluation, for its page and for papers.
#pragma once

#include <array>
#include <filesystem>
#include <utility>
#include <vector>

#include "base/monitor.h"
#include "evaluate/judgment.h"
#include "present/chart.h"
#include "present/evaluation_report.h"

namespace vpr {

/// The axes of precision against recall, without a series.
Chart precision_recall_chart(const std::string& title);

/// Recall and precision at no more than `most` of the curve's points, evenly spaced by their place,
/// first and last among them.
std::vector<std::pair<double, double>> curve_points(const Curve& curve, size_t most);

/// Runs of frames with the same fix, but none.
std::vector<ChartRun> fix_runs(const std::vector<Fix>& fixes);

/// Precision against recall: best matches, those by margin where margins are known, and, where
/// there are some, all pairs. It has no series where nothing is judged.
Chart curve_chart(const Report& report, const Judgment& judgment);

/// The share of mistakes among accepted best matches against the share of best matches that are
/// accepted, by score and, where margins are known, by margin. No series where nothing is judged.
Chart risk_chart(const Report& report, const Judgment& judgment);

/// Best matches that a threshold accepts, from the strictest to the loosest, in the unit in which
/// thresholds are given: right ones, wrong ones, and those that are not judged.
Chart threshold_chart(const Report& report, const Judgment& judgment);

/// Best matches that a threshold accepts, in the unit of that chart: right, wrong, not judged.
struct ThresholdStep {
  double threshold = 0;
  std::array<size_t, 3> accepted = {};
};

/// A step for each threshold that occurs, from the strictest to the loosest; of more than about
/// `most` some are left out, but never the last.
std::vector<ThresholdStep> threshold_steps(const Report& report, const Judgment& judgment,
                                           size_t most);

/// The margin of every query frame's best match, a frame of its window: right ones, wrong ones and
/// those that are not judged, and as a line the margin that was asked for, where the decision is by
/// margin. It has no series where no margins are known.
Chart margin_chart(const Report& report, const Judgment& judgment);

/// Best matches and ground truth along the query's path, frames of the training sequences upwards,
/// band by band, and below, a bar of fixes. It has no series where there are neither.
Chart timeline_chart(const Report& report, const Judgment& judgment, const GroundTruth& truth,
                     const Monitor& monitor = {});

/// The scores of all pairs in at most `most_pixels` a side, and what is recognized.
Chart matrix_chart(const Evaluation& evaluation, const Report& report, size_t most_pixels,
                   const Monitor& monitor);

/// The meanings that a chart shows, for a legend outside it.
std::vector<Meaning> meanings_of(const Chart& chart);

/// Writes precision-recall, risk-coverage, recall@K (where ranks are known), timeline, margins
/// (where they are known) and matrix as SVG and PNG into the folder of an output. Throws
/// Error(output).
void draw_evaluation(const Evaluation& evaluation, const Report& report,
                     const std::filesystem::path& folder, const Monitor& monitor);

}  // namespace vpr
