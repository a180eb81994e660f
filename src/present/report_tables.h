// Reports as tables, and their titles.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "files/report.h"
#include "present/table.h"

namespace vpr {

/// "-" without a value.
std::string metric_cell(const Metric& metric, std::optional<double> value);

/// "name on query": the name set by the user, or the method, with the score if it is not raw.
std::string evaluation_title(const Report& report);
/// The same with c_l and the threshold.
std::string title_with_settings(const Report& report);

/// "training frame", or "training place" for FAB-MAP.
std::string reference_word(const Report& report);

/// One row: settings and counts.
Table report_table(const Report& report);

/// One row: totals, and counts by answers to places.
Table places_table(const Report& report);

/// Metrics of curves, ranks (if known), stretches and localization. Titles state what is counted.
std::vector<Table> metrics_tables(const Report& report);

/// All tables of the reports. Several reports share each table, with their names in the first
/// column. CSV is one table.
std::string reports_text(std::span<const Report> reports, TableFormat format);

}  // namespace vpr
