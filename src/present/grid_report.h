// A grid of reports, methods by queries: as tables and a page.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "present/evaluation_report.h"
#include "present/table.h"

namespace vpr {

/// A report in the grid: one for each pair of a method and a query.
struct GridReport {
  std::string method;  ///< its row
  Report report;
};

/// What a report is called as a row: the name that the user gave, or the method with its window
/// length and score.
std::string grid_name(const Report& report);

/// For each of R@1, AP, R@100P and the shares of the path with a right and a wrong fix, a table
/// with methods as rows and queries as columns, the best of each query in bold, and the mean over
/// the queries that a method has all of. Numbers are over all frames of the query that have a match
/// (of the path: over all frames), so that a method gains nothing by frames without a window. A
/// share by a threshold from the ground truth is marked, and is the best of its like only.
std::vector<Table> grid_tables(std::span<const GridReport> reports);

/// The same as rows of a method, a query, a metric and its value in full, for data frames.
Table grid_rows(std::span<const GridReport> reports);

/// The tables, and for each query the curves and paths of all methods, as one page that needs
/// nothing else. `title`: what the data set is called.
std::string grid_page(const std::string& title, std::span<const GridReport> reports);

}  // namespace vpr
