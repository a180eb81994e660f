// Methods side by side: a row per report, a column per measure.
#pragma once

#include <span>
#include <string>
#include <vector>

#include <unistd.h>

#include "evaluate/comparison.h"
#include "evaluate/report.h"
#include "present/table.h"

namespace vpr {

/// Reports on one query. Every command that prints several reports prints this table of them; a
/// second query would add a group of columns.
struct SideBySide {
  std::span<const Report> reports;  ///< with the names of their rows
  std::string query;
  std::string frames;                  ///< of the numbers: "80 common frames with a match"
  std::vector<bool> is_comparable;     ///< by report: over these frames
  std::vector<std::string> notes;      ///< by report; empty: none
  bool omits_frames = false;           ///< these are not all frames of the query
  std::vector<size_t> recall_at = {};  ///< K of the columns; empty: all known
  std::span<const ComparedValue> compared = {};  ///< marks the best values; empty: the largest
  bool has_intervals = false;                    ///< in cells, of `compared`
};

/// Restrictions on a comparison of the report: its selection of frames, a threshold that was chosen
/// from the ground truth, cautions and, if `differ`, its ground truth. Empty: none.
std::string note_of(const Report& report, bool is_comparable, bool differ);

/// Reports over all of their frames. Those with the ground truth of the first one are comparable.
SideBySide side_by_side(std::span<const Report> reports);

/// The measures that any report has, by the table of metrics, in words or, for data, in full
/// precision without unknown values. Frames recognized at a threshold from the ground truth are
/// unknown. Pairs and places are counted over all frames of the query, and pairs are shown if any
/// is incorrect of a method that may accept several per frame. The best values are those of best
/// matches; none is marked without two comparable reports, if a best match is not labeled where
/// others are, or if an interval of a difference contains 0. A cell with an interval is "0.9260
/// [0.911, 0.941]".
Table methods_table(const SideBySide& methods, TableDetail detail);

/// full for text and Markdown.
TableDetail detail_of(TableFormat format);

/// The table as text of 80 columns. On a terminal, the names in its first column are cut to 22
/// characters.
std::string short_text(Table table, bool is_terminal = ::isatty(STDOUT_FILENO) != 0);

}  // namespace vpr
