// Reports as tables, and their titles.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "evaluate/report.h"
#include "present/table.h"

namespace vpr {

/// "-" without a value.
std::string metric_cell(const Metric& metric, std::optional<double> value);

/// c_l, c_w or window, t_r, margin or t_p, and further settings of the method, by their symbols.
using NamedSetting = std::pair<std::string_view, std::string>;
std::vector<NamedSetting> settings_of(const Report& report);

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

/// All tables of a report in text and Markdown, otherwise its row of methods_table. Several reports
/// are the full methods_table.
std::string reports_text(std::span<const Report> reports, TableFormat format);

}  // namespace vpr
