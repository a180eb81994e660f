// Comparisons of reports on one query (vpr.comparison/4).
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
#include "files/report.h"
#include "present/table.h"

namespace vpr {

/// Whether all reports have the same ground truth. of_places_and_frames: one for places and one for
/// frames, which label different things and may agree per query only.
enum class GroundTruths { same, different, of_places_and_frames };
template <>
inline constexpr std::array<std::string_view, 3> kEnumNames<GroundTruths> = {
    "same", "different", "of-places-and-frames"};

/// Compares fingerprints, and for queries with different selections the protocols' words.
GroundTruths compare_ground_truths(std::span<const Report> reports);

/// Names the rows of reports: by the user or after the file, with a number if a name occurs twice.
/// `paths`: the files.
void name_rows(std::vector<Report>& reports, const std::vector<std::string>& paths);

/// Reports on one query. The first is the baseline.
struct ComparisonReport {
  std::vector<Report> reports;
  ComparisonSettings settings;
  Comparison found;
  Provenance made_by;

  std::string query() const;
  /// The frames of all numbers of paired reports: "80 common frames with a match".
  std::string frames() const;
  /// Whether the report has the same selection of the query as the first report.
  bool is_paired(size_t report) const {
    return reports[report].selection_words() == reports.front().selection_words();
  }
};

/// Compares the reports, whose rows have names. Restricts paired reports to the compared frames, so
/// that all of their numbers are over them. Throws as
/// compare_outcomes does.
void compare_reports(ComparisonReport& comparison, const Monitor& monitor);

/// The file without "machine" and "timing".
Json comparison_json(const ComparisonReport& comparison);

/// A row per report and a column per metric, as in a paper. The best values of paired reports are
/// bold, unknown values "-". Notes state a different selection or ground truth.
Table paper_table(const ComparisonReport& comparison);

/// A row per report with the columns that a paper prints: R@1, R@5 if it is known, AP, R@100P, and
/// frames recognized correctly and incorrectly ("-" at a threshold from the ground truth), all over
/// the same frames. The best metrics of paired reports are bold.
Table short_table(const ComparisonReport& comparison);

/// The method with the best R@1, short_table, and the differences in R@1 to the first report.
std::string comparison_text(const ComparisonReport& comparison);

/// Differences to the first report with their intervals: a row per metric and report.
Table comparison_table(const ComparisonReport& comparison);

/// A row per report and metric for data frames, in full precision; unknown values are empty.
Table comparison_rows(const ComparisonReport& comparison);

/// One file without external references: verdicts along the path, curves, paper_table, and a row of
/// differences per method.
std::string comparison_page(const ComparisonReport& comparison);

/// Writes precision-recall and lanes as SVG and PNG into the folder of an output. Throws
/// Error(output).
void draw_comparison(const ComparisonReport& comparison, const std::filesystem::path& folder);

}  // namespace vpr
