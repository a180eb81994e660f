// Sweeps (vpr.sweep/5) as JSON, charts, tables and text.
#pragma once

#include <string>
#include <vector>

#include "base/json_fwd.h"
#include "present/chart.h"
#include "present/table.h"
#include "query/run_info.h"
#include "tune/sweep.h"

namespace vpr {

/// "cells": the cells of all sweeps, each with its "query". "queries": the recommendation of each
/// sweep, with cells by index. `base`: the settings that all cells share.
Json sweep_json(std::string_view method, const QuerySettings& base,
                const std::vector<Sweep>& sweeps, const RunInfo& run, double seconds);
/// Its schema, for docs/schemas.
Json sweep_schema();

/// A file for vpr-query --config (vpr.config/3).
std::string config_text(const QuerySettings& settings);

/// c_l or c_w of a cell, and its threshold or "auto".
std::string window_text(const CellCounts& cell);
std::string threshold_text(const CellCounts& cell);

/// Different values of one setting in order of first occurrence.
std::vector<std::string> distinct_texts(const Sweep& sweep, std::string (*text)(const CellCounts&));

/// A count in at most four characters: "847", "1.2k", "131k", "1.0M".
std::string short_count(uint64_t count);

/// Correct against incorrect recognitions, one line per window.
Chart sweep_chart(const Sweep& sweep);

/// A PNG file of correct and incorrect recognitions over the grid, one row per sweep.
std::string heat_map_png(const std::vector<Sweep>& sweeps);

/// Recognitions, places with the number of mixed ones (for sequences), and best matches, laid out
/// as in the paper: a row per query and threshold, two columns per window, a star at the
/// recommended cell. All sweeps have the same grid, and there is at least one.
std::vector<Table> sweep_tables(const std::vector<Sweep>& sweeps);

/// A row per cell for CSV. FAB-MAP's cells of places are empty.
Table cells_table(const std::vector<Sweep>& sweeps);

/// The reason for the recommendation or, without one, the reason and a remedy.
std::string reason_text(const Sweep& sweep);

/// One row per window, for at most ten: the cell with the best counts of frames (best_counts), with
/// its incorrect pairs. And a row for the recommended cell.
Table best_cells_table(const Sweep& sweep);

/// The recommendation in numbers of frames, with the first error and, on request, intervals of
/// pairs. Ends with a line feed.
std::string recommendation_text(const Sweep& sweep, bool with_intervals);

/// The frames and pairs of the recommended setting on the query of the validation, which is set.
std::string validation_text(const Sweep& sweep);

}  // namespace vpr
