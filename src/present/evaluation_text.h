// Evaluations in a few lines for a terminal: at most 12 lines of 80 columns.
#pragma once

#include <span>
#include <string>

#include <unistd.h>

#include "files/report.h"
#include "present/table.h"

namespace vpr {

/// wrapped_line for a terminal of 80 columns, with a line feed. Lines after the first are indented.
std::string wrapped_text(const std::string& text, size_t indent = 0);

/// The headline `summary`, then lines with settings, ground truth, best matches, metrics by the
/// confidence of the decision, and the recognized ranges with their errors. `most_ranges`: the
/// maximum number of ranges.
std::string evaluation_text(const Evaluation& evaluation, const Report& report,
                            const std::string& summary, size_t most_ranges);

/// One row per report, their names in the column `key`: R@1, AP and R@100P over all frames with a
/// match; frames recognized correctly and incorrectly, and the first correct one, "-" at a
/// threshold from the ground truth; and incorrect pairs, if a report has any. Reports with
/// different ground truths have a column with their frames, and no best value.
Table overview_table(std::span<const Report> reports, const std::string& key);

/// The same as text, with the cautions of each report.
std::string overview_text(std::span<const Report> reports, const std::string& key);

/// The table as text. On a terminal, the names in its first column are cut to 22 characters.
std::string short_text(Table table, bool is_terminal = ::isatty(STDOUT_FILENO) != 0);

}  // namespace vpr
