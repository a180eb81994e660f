// The charts of an evaluation, and maps of recognitions as in the paper's figures.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/monitor.h"
#include "evaluate/judgment.h"
#include "evaluate/report.h"
#include "present/chart.h"
#include "present/matrix_chart.h"
#include "truth/positions.h"

namespace vpr {

/// The axes of precision against recall, without a series.
Chart precision_recall_chart(const std::string& title);

/// The curve in steps, of which AP is the area: the precision of each point holds from the recall
/// of the previous one to its own. At no more than 1000 points, selected by `thinned`.
std::vector<std::pair<double, double>> curve_points(const Curve& curve);

/// Consecutive frames with the same verdict other than none.
std::vector<ChartStretch> verdict_stretches(const std::vector<Verdict>& verdicts);

/// Precision against recall of best matches by score, by margin if known, and of all pairs if there
/// is a matrix. No series if no query has a match.
Chart curve_chart(const Report& report, const Judgment& judgment);

/// The share of incorrect among accepted best matches, against the share of accepted best matches;
/// by score and, if known, by margin. No series if no query has a match.
Chart risk_chart(const Report& report, const Judgment& judgment);

/// The numbers of best matches that a threshold accepts (correct, incorrect, not judged), from the
/// strictest to the loosest threshold, in the unit of the threshold's flag.
Chart threshold_chart(const Report& report, const Judgment& judgment);

/// Best matches accepted at a threshold, in the unit of threshold_chart.
struct ThresholdStep {
  double threshold = 0;
  std::array<size_t, 3> accepted = {};  ///< correct, incorrect, not judged
};

/// A step per distinct threshold from the strictest to the loosest, thinned to about `most`,
/// always including the last.
std::vector<ThresholdStep> threshold_steps(const Report& report, const Judgment& judgment,
                                           size_t most);

/// The margin of each query frame's best match by outcome and, if the decision is by margin, the
/// required margin as a line. No series if margins are unknown.
Chart margin_chart(const Report& report, const Judgment& judgment);

/// Frames from the closest frame of the same place to the best match, in the best match's sequence;
/// 0 if it is the same place, without the tolerance. Unset if no frame shows the same place.
std::optional<int64_t> frames_off(const GroundTruth& truth, const QueryOutcome& query);

/// frames_off of recognized best matches. No series if none is off, and for places.
Chart frames_off_chart(const Report& report, const Judgment& judgment, const GroundTruth& truth);

/// Whether a matrix shows more than the timeline: scores, or recognitions besides best matches.
bool has_matrix(const Evaluation& evaluation);

/// Best matches and ground truth along the query (x) over the frames of all training sequences (y),
/// with a bar of verdicts below.
Chart timeline_chart(const Report& report, const Judgment& judgment, const GroundTruth& truth,
                     const Monitor& monitor = {});

/// The scores of all pairs, if there is a matrix, in at most `most_pixels` x `most_pixels`, with
/// ground truth and recognitions.
Chart matrix_chart(const Evaluation& evaluation, const Report& report, size_t most_pixels,
                   const Monitor& monitor);

/// The share of correct best matches at tolerances from 0 to 10 frames, or to twice the tolerance
/// of the ground truth. No series without frames with a match, and for labels and places.
Chart tolerance_chart(const Report& report, const Judgment& judgment, const GroundTruth& truth);

ScoreUnit score_unit(const Report& report);

/// Writes precision-recall, risk-coverage, recall@K (if ranks are known), R@1 by tolerance,
/// timeline, frames off (if some are), margins (if known) and matrix (if has_matrix) as SVG, PDF
/// and PNG into the folder of an output. Throws Error(output).
void draw_evaluation(const Evaluation& evaluation, const Report& report,
                     const std::filesystem::path& folder, const FigureSettings& figure,
                     const Monitor& monitor);

struct MapPanel {
  std::string title;
  std::vector<Meaning> meanings;  ///< one per query frame: meanings_of
  bool shows_places = false;      ///< draws FAB-MAP's training places
};

struct RouteMap {
  std::vector<WallLine> walls;
  std::vector<std::vector<std::optional<RoutePoint>>> train;  ///< by sequence
  std::vector<RoutePoint> places;
  std::vector<std::optional<RoutePoint>> query;
};

/// The meaning of each query frame: its verdict or, without one, `unmapped` (no match in a known
/// ground truth) or `missed`.
std::vector<Meaning> meanings_of(const Judgment& judgment, const GroundTruth& truth);

/// A chart with equal scales and a bar for a round number of meters, about a quarter as long as the
/// content. Empty series are omitted.
Chart plan_chart(const std::string& file, const std::string& title, std::vector<Series> series);

/// A row of charts per floor of the query's path, in order of first visit, with a column per panel.
/// Only training paths and places of this floor are drawn.
std::vector<Chart> route_charts(const RouteMap& map, const std::vector<MapPanel>& panels,
                                const Monitor& monitor = {});

/// Writes map.svg, map.pdf and map.png into the folder of an output. Throws Error(output).
void draw_route_map(const RouteMap& map, const std::vector<MapPanel>& panels,
                    const std::filesystem::path& folder, const Monitor& monitor);

}  // namespace vpr
