// Evaluation reports for people: titles, a sentence, and tables.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "evaluate/judgment.h"
#include "present/evaluation_report.h"
#include "present/table.h"

namespace vpr {

/// A value of a metric in a table; "-" for none.
std::string metric_cell(const Metric& metric, std::optional<double> value);

/// "method on query", for titles: the name that the user gave; else the method, and the score
/// where it is not raw distances.
std::string evaluation_title(const Report& report);
/// The same, and c_l and t_r, or c_w and t_p.
std::string title_with_settings(const Report& report);

/// What the references of a report's matches are: frames, or places of FAB-MAP.
std::string reference_word(const Report& report);

/// What the scores of a report's matches are, with their unit.
std::string score_words(const Report& report);

/// Of a result: "Recognized in 17 of 111 frames, 3 of them wrong; the first right one at frame 21
/// (2.1 s)." With frames_per_second, which is above 0, the time from the first frame to it. Where
/// the ground truth is not known, all recognitions count alike. Of scores: "Best match right in 53
/// of 111 frames (47.7 %)", and recognitions only by a threshold that the user chose; one chosen
/// from the ground truth is called that.
std::string summary_sentence(const Judgment& judgment, bool is_judged,
                             std::optional<double> frames_per_second);

/// One row: the setting and the counts of a result, or a matrix of scores and its best matches.
Table report_table(const Report& report);

/// One row: the counts of a report whose ground truth is not known.
Table unjudged_table(const Report& report);

/// Metrics of best matches and pairs, recall@K where there are ranks, and localization, titled with
/// what their numbers count.
std::vector<Table> metrics_tables(const Report& report);

/// All tables of the reports, one below the other; of several, rows of one kind stand in one table,
/// each with its name from `names`. CSV is one table, whatever the reports are of.
std::string reports_text(std::span<const Report> reports, const std::vector<std::string>& names,
                         TableFormat format);

/// One row a protocol; there is at least one.
Table protocols_table(const std::vector<ProtocolReport>& reports);

/// What each ground truth is, in words: a line a protocol.
std::string protocols_notes(const std::vector<ProtocolReport>& reports);

}  // namespace vpr
