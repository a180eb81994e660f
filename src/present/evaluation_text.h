// Evaluations in a few lines for a terminal: at most 12 lines of 80 columns.
#pragma once

#include <string>

#include "evaluate/report.h"

namespace vpr {

/// wrapped_line for a terminal of 80 columns, with a line feed. Lines after the first are indented.
std::string wrapped_text(const std::string& text, size_t indent = 0);

/// The headline `summary`, then lines with settings, ground truth, best matches, metrics by the
/// confidence of the decision, and the recognized ranges with their errors. `most_ranges`: the
/// maximum number of ranges.
std::string evaluation_text(const Evaluation& evaluation, const Report& report,
                            const std::string& summary, size_t most_ranges);

}  // namespace vpr
