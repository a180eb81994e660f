// Sweeps (vpr.sweep/1) as JSON and pictures; sweep_table.h has the tables.
#pragma once

#include "base/json_fwd.h"
#include "evaluation/sweep.h"
#include "report/chart.h"
#include "report/run_info.h"

namespace vpr {

/// The whole file: the settings that stay the same for all cells, the cells of all sweeps ("cells",
/// each with its "query"), and of each sweep what to choose ("queries", which name cells by their
/// index in the whole list). `base`: settings of which the sweeps vary two.
Json sweep_json(std::string_view method, const QuerySettings& base,
                const std::vector<Sweep>& sweeps, const RunInfo& run, double seconds);

/// Settings as vpr-query --config takes them (vpr.config/1).
std::string config_text(const QuerySettings& settings);

/// Correct against incorrect hits, a line a window.
Chart sweep_chart(const Sweep& sweep);

/// Correct and incorrect hits over the grid, side by side, one sweep below the other: a PNG file.
std::string heat_map_png(const std::vector<Sweep>& sweeps);

}  // namespace vpr
