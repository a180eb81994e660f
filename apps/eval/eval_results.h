// What vpr-eval prints of one report or several.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "common/command.h"
#include "report/table.h"

namespace vpr {

/// All tables of the reports, one below the other; of several, rows of one kind stand in one table,
/// each with its name from `names`. CSV is one table, whatever the reports are of.
std::string report_text(const std::vector<Json>& reports, const std::vector<std::string>& names,
                        TableFormat format);

/// Names of rows: what the user gave with --name, else the files' own names, with a number where
/// two are equal. `given`: empty, or one for each.
std::vector<std::string> row_names(const std::vector<std::string>& given,
                                   const std::vector<std::string>& paths);

/// What is printed: for people, and for scripts.
struct SeveralReports {
  std::string text;
  Json json;
};

/// Evaluates several results: a table with a row for each, and vpr.reports/1. `evaluate` gives the
/// report of result i, without "machine".
SeveralReports evaluate_several(Session& session, const std::vector<std::string>& results,
                                const std::vector<std::string>& names, TableFormat format,
                                const std::function<Json(size_t i)>& evaluate);

}  // namespace vpr
