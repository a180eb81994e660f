// A comparison as a page, and as plots.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "base/json_fwd.h"
#include "report/stored_report.h"

namespace vpr {

/// One file that needs nothing else: the table of a paper, curves and paths of all reports, and the
/// intervals of their differences. `comparison` is a vpr.comparison/1, `names` are those in it.
std::string comparison_page(const Json& comparison, std::span<const StoredReport> reports,
                            const std::vector<std::string>& names);

/// Curves and paths of all reports, as a part of a page.
std::string methods_html(const std::string& title, std::span<const StoredReport> reports,
                         const std::vector<std::string>& names);

/// Writes precision-recall and lanes as SVG and PNG into the folder of an output. Throws
/// Error(output).
void draw_comparison(const Json& comparison, std::span<const StoredReport> reports,
                     const std::vector<std::string>& names, const std::filesystem::path& folder);

}  // namespace vpr
