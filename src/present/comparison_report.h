// Comparisons of reports (vpr.comparison/1), and their tables.
#pragma once

#include <string>
#include <vector>

#include "base/json_fwd.h"
#include "evaluate/comparison.h"
#include "present/run_info.h"
#include "present/stored_report.h"
#include "present/table.h"

namespace vpr {

/// Everything of the file but "machine" and "timing".
Json comparison_json(const Comparison& comparison, const std::vector<StoredReport>& reports,
                     const std::vector<std::string>& names, size_t resamples, const RunInfo& run);

/// The table of a paper: a row for each report, the field's metrics as columns, the best of each in
/// bold, of those that are paired. What a report does not know is "-". A column of notes says which
/// reports are of another walk or another ground truth, where there are some.
Table paper_table(const Json& comparison);

/// Differences to the first report and their intervals: a row for each metric that a report knows.
Table comparison_table(const Json& comparison);
/// Whose best matches are right where, of reports that are paired with the first.
Table paired_table(const Json& comparison);

/// Everything in long form, for data frames: a row for each report and metric, numbers in full.
/// What is not known is empty.
Table comparison_rows(const Json& comparison);

}  // namespace vpr
