// Sweeps for people and spreadsheets: tables, one row a cell, and the recommendation in words.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "report/sweep_file.h"
#include "report/table.h"

namespace vpr {

/// One cell, as tables and pictures show it.
struct SweepCell {
  std::string window;
  std::string threshold;
  std::optional<double> looseness;  ///< of the threshold, see looseness_of
  std::string scale;                ///< of the threshold: relative, bits, mean-z, probability
  LabelCounts hits;
  std::optional<LabelCounts> places;  ///< of sequences
  uint64_t mixed_places = 0;
  uint64_t distinct = 0;
  BestMatchCounts best_match;
  std::optional<uint64_t> untrained;  ///< as CellCounts has it
};

/// What the settings of a sweep are called.
struct SweepSymbols {
  std::string window;     ///< c_l or c_w
  std::string threshold;  ///< t_r or t_p
};

/// The cells of a sweep, in its order.
std::vector<SweepCell> sweep_cells(const Sweep& sweep);
/// c_l and t_r, or c_w and t_p.
SweepSymbols sweep_symbols(const Sweep& sweep);

/// The values of one setting, in the order in which they first come.
std::vector<std::string> distinct_values(const std::vector<SweepCell>& cells,
                                         std::string SweepCell::*value);

/// Hits, places (of sequences, with the number of mixed ones) and best matches, in the layout of
/// the paper's tables: a row a query and threshold, two columns a window; the recommended cell has
/// a star. All sweeps have the same grid, and there is at least one.
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
