// Metrics, localization and outcomes as parts of an evaluation report (vpr.report/1), and their
// tables.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "base/json_fwd.h"
#include "evaluate/judgement.h"
#include "present/table.h"

namespace vpr {

/// The metrics of one curve, what there is to find, and at which thresholds they are reached.
Json curve_metrics_json(const Curve& curve);

/// A curve as reports hold it: how many thresholds it has, and at most 100 of its points.
Json curve_json(const Curve& curve);

/// Adds "metrics", "localisation", "curves" and "outcomes".
void add_judgement(Json& report, const Judgement& judgement);

/// Adds to "protocol", in words, what the metrics count. `is_result`: a result of ours, whose hits
/// are the fixes.
void add_metrics_protocol(Json& protocol, const Judgement& judgement, bool is_result);

/// The text of a number or null in a table: "-", an integer, or a number with `digits` decimals.
std::string shown(const Json& value, int digits = 4);

/// Metrics of best matches and pairs, recall@K where there are ranks, and localisation, titled with
/// what their numbers count.
std::vector<Table> metrics_tables(const Json& report);

/// The same as columns of one row, for CSV.
void append_metrics(Table& table, const Json& report);

/// Recall and precision at no more than `most` of the curve's points, evenly spaced by their place,
/// first and last among them.
std::vector<std::pair<double, double>> curve_points(const Curve& curve, size_t most);

}  // namespace vpr
