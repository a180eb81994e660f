// Comparisons of reports on one query: as JSON (vpr.comparison/1), tables, charts and a page.
#pragma once

#include <array>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/enum_names.h"
#include "base/json_fwd.h"
#include "evaluate/comparison.h"
#include "present/evaluation_report.h"
#include "present/table.h"

namespace vpr {

/// Whether reports are judged by one ground truth. of_places_and_frames: places of some, frames of
/// others, each kind by one; they say of different things, and can agree by query only.
enum class GroundTruths { same, different, of_places_and_frames };
template <>
inline constexpr std::array<std::string_view, 3> kEnumNames<GroundTruths> = {
    "same", "different", "of-places-and-frames"};

/// Whether reports have one ground truth, by fingerprints, and where their walks differ by words.
GroundTruths compare_ground_truths(std::span<const Report> reports);

/// What tables call the reports, whose files `paths` are: the names that users gave, which always
/// stay, and otherwise the methods. Of these, those that clash with another become the files'
/// names, and, if that does not help, numbers are added.
std::vector<std::string> report_names(std::span<const Report> reports,
                                      const std::vector<std::string>& paths);

/// Reports on one query, of which the first is what the others are compared with.
struct ComparisonReport {
  std::vector<Report> reports;
  std::vector<std::string> names;  ///< one for each
  Comparison found;
  size_t resamples = 0;
  Provenance made_by;

  std::string query() const;
  /// Whether a report is of the same walk as the first: of the query as it is, or replayed
  /// likewise.
  bool is_paired(size_t report) const { return reports[report].walk() == reports.front().walk(); }
};

/// Everything of the file but "machine" and "timing".
Json comparison_json(const ComparisonReport& comparison);

/// The table of a paper: a row for each report, the field's metrics as columns, the best of each in
/// bold, of those that are paired. What a report does not know is "-". A column of notes says which
/// reports are of another walk or another ground truth, where there are some.
Table paper_table(const ComparisonReport& comparison);

/// Differences to the first report and their intervals: a row for each metric that a report knows.
Table comparison_table(const ComparisonReport& comparison);
/// Whose best matches are right where, of reports that are paired with the first.
Table paired_table(const ComparisonReport& comparison);

/// Everything in long form, for data frames: a row for each report and metric, numbers in full.
/// What is not known is empty.
Table comparison_rows(const ComparisonReport& comparison);

/// One file that needs nothing else: the table of a paper, curves and paths of all reports, and the
/// intervals of their differences.
std::string comparison_page(const ComparisonReport& comparison);

/// Curves and paths of all reports on one query, as a part of a page.
std::string methods_html(const std::string& title, std::span<const Report> reports,
                         const std::vector<std::string>& names);

/// Writes precision-recall and lanes as SVG and PNG into the folder of an output. Throws
/// Error(output).
void draw_comparison(const ComparisonReport& comparison, const std::filesystem::path& folder);

}  // namespace vpr
