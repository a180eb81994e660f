// Sweeps: as JSON (vpr.sweep/1), pictures, tables, and the recommendation in words.
#pragma once

#include <string>
#include <vector>

#include "base/json_fwd.h"
#include "evaluate/sweep.h"
#include "present/chart.h"
#include "present/run_info.h"
#include "present/table.h"

namespace vpr {

/// The whole file: the settings that stay the same for all cells, the cells of all sweeps ("cells",
/// each with its "query"), and of each sweep what to choose ("queries", which name cells by their
/// index in the whole list). `base`: settings of which the sweeps vary two.
Json sweep_json(std::string_view method, const QuerySettings& base,
                const std::vector<Sweep>& sweeps, const RunInfo& run, double seconds);

/// Settings as vpr-query --config takes them (vpr.config/1).
std::string config_text(const QuerySettings& settings);

/// Correct against incorrect recognitions, a line a window.
Chart sweep_chart(const Sweep& sweep);

/// Correct and incorrect recognitions over the grid, side by side, one sweep below the other: a PNG
/// file.
std::string heat_map_png(const std::vector<Sweep>& sweeps);

/// Recognitions, places (of sequences, with the number of mixed ones) and best matches, in the
/// layout of the paper's tables: a row a query and threshold, two columns a window; the recommended
/// cell has a star. All sweeps have the same grid, and there is at least one.
std::vector<Table> sweep_tables(const std::vector<Sweep>& sweeps);

/// One row a cell and one column a number, for CSV. The two families differ in the names of their
/// two settings only; FAB-MAP's cells of places are empty.
Table cells_table(const std::vector<Sweep>& sweeps);

/// Why the setting is recommended, or why there is none and what to do about it.
std::string reason_text(const Sweep& sweep);

/// The recommendation with the first error and what is known of its uncertainty. Ends with a line
/// feed.
std::string recommendation_text(const Sweep& sweep);

/// The counts of the recommended setting on the query of a validation (Sweep::validation).
std::string validation_text(const ValidatedCell& validation);

}  // namespace vpr
