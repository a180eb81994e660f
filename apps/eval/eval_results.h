// What vpr-eval prints of one report or several.
#pragma once

#include <string>
#include <vector>

#include "base/json_fwd.h"
#include "report/table.h"

namespace vpr {

/// All tables of the reports, one below the other; of several, rows of one kind stand in one table,
/// each with its name from `names`. CSV is one table, whatever the reports are of.
std::string report_text(const std::vector<Json>& reports, const std::vector<std::string>& names,
                        TableFormat format);

}  // namespace vpr
