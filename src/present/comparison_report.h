// Comparisons of reports on one query (vpr.comparison/5), or on several (vpr.comparisons/5).
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
#include "evaluate/report.h"
#include "present/chart.h"
#include "present/methods_table.h"

namespace vpr {

/// Whether all reports have the same ground truth. of_places_and_frames: one for places and one for
/// frames, which label different things and may agree per query only.
enum class GroundTruths { same, different, of_places_and_frames };
template <>
inline constexpr std::array<std::string_view, 3> kEnumNames<GroundTruths> = {
    "same", "different", "of-places-and-frames"};

/// Compares fingerprints, and for queries with different selections the protocols' words.
GroundTruths compare_ground_truths(std::span<const Report> reports);

/// Reports on one query. The first is the baseline.
struct ComparisonReport {
  std::string data_set;         ///< its name, or the name of the query
  std::vector<Report> reports;  ///< with the names of their rows
  std::vector<std::string> paths;
  ComparisonSettings settings;
  Comparison found;
  Provenance made_by;
  bool omits_frames = false;  ///< from the numbers of paired reports

  std::string query() const;
  /// The frames of all numbers of paired reports: "80 common frames with a match".
  std::string frames() const;
  /// Whether the report has the same selection of the query as the first report.
  bool is_paired(size_t report) const {
    return selection_text(reports[report].selection) == selection_text(reports.front().selection);
  }
};

/// The reports by data set, in the order of their first reports. Reports are on one data set if
/// their queries have one name, or none, or if their ground truths are the same, unless their data
/// sets have different names. `paths`: the files, after which rows without a name are called.
std::vector<ComparisonReport> by_data_set(std::vector<Report> reports,
                                          const std::vector<std::string>& paths);

/// Compares the reports. Columns of recall@K are those of the settings or, without any, of the
/// reports. Disputed frames are also omitted if the ground truths are of places and of frames. If
/// frames are omitted, restricts paired reports to
/// the compared ones, so that all of their numbers are over these, except accepted pairs. Throws as
/// compare_outcomes does.
void compare_reports(ComparisonReport& comparison, const Monitor& monitor);

/// The file without "machine" and "timing".
Json comparison_json(const ComparisonReport& comparison);
/// The comparison of one data set, or the list of several.
Json comparisons_json(std::span<const ComparisonReport> comparisons);
Json comparison_schema();
Json comparisons_schema();

/// The reports side by side. If frames are omitted, numbers that are known for the whole query only
/// are absent.
SideBySide side_by_side(const ComparisonReport& comparison);

/// A row per method and, of several data sets, a group of columns per data set, which are at most
/// brief if `detail` is full.
Table compared_methods(std::span<const ComparisonReport> comparisons, TableDetail detail,
                       bool has_intervals);

/// The methods as short_text, and of each data set the intervals of R@1 and the differences in R@1
/// to the first report.
std::string comparison_text(std::span<const ComparisonReport> comparisons);

/// Per data set with paired methods after the first, a row per such method: its differences in the
/// main metrics, with intervals.
std::vector<Table> difference_tables(std::span<const ComparisonReport> comparisons);

/// The methods with intervals, and difference_tables. CSV is one table with the intervals and the
/// differences of all metrics.
std::string comparison_tables(std::span<const ComparisonReport> comparisons, TableFormat format);

/// One file without external references: verdicts along the path, curves, and the tables.
std::string comparison_page(std::span<const ComparisonReport> comparisons);

/// Writes precision-recall and lanes as SVG, PDF and PNG into the folder of an output; of several
/// data sets, with their numbers in the names. Throws Error(output).
void draw_comparison(std::span<const ComparisonReport> comparisons,
                     const std::filesystem::path& folder, const FigureSettings& figure);

}  // namespace vpr
