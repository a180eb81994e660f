// Comparisons of reports on one query (vpr.comparison/5).
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

/// Names the rows of reports: by the user or after the file, with a number if a name occurs twice.
/// `paths`: the files.
void name_rows(std::vector<Report>& reports, const std::vector<std::string>& paths);

/// Reports on one query. The first is the baseline.
struct ComparisonReport {
  std::vector<Report> reports;
  ComparisonSettings settings;
  Comparison found;
  Provenance made_by;
  bool omits_frames = false;  ///< from the numbers of paired reports

  std::string query() const;
  /// The frames of all numbers of paired reports: "80 common frames with a match".
  std::string frames() const;
  /// Whether the report has the same selection of the query as the first report.
  bool is_paired(size_t report) const {
    return reports[report].selection_words() == reports.front().selection_words();
  }
};

/// The settings of a comparison of these reports. `block`: 0 chooses the longest window, but at
/// least 10 frames. Disputed frames are also omitted if the ground truths are of places and of
/// frames.
ComparisonSettings comparison_settings(std::span<const Report> reports, uint64_t block,
                                       uint64_t seed, bool only_common, bool omit_disputed);

/// Compares the reports, whose rows have names. If frames are omitted, restricts paired reports to
/// the compared ones, so that all of their numbers are over these, except accepted pairs. Throws as
/// compare_outcomes does.
void compare_reports(ComparisonReport& comparison, const Monitor& monitor);

/// The file without "machine" and "timing".
Json comparison_json(const ComparisonReport& comparison);

/// The reports side by side. If frames are omitted, numbers that are known for the whole query only
/// are absent.
SideBySide side_by_side(const ComparisonReport& comparison);

/// The methods as short_text, and the differences in R@1 to the first report.
std::string comparison_text(const ComparisonReport& comparison);

/// A row per paired method after the first: its differences in the main metrics, with intervals.
Table difference_table(const ComparisonReport& comparison);

/// The methods and difference_table. LaTeX has the methods only, and CSV is one table with the
/// differences of all metrics.
std::string comparison_tables(const ComparisonReport& comparison, TableFormat format);

/// One file without external references: verdicts along the path, curves, and the tables.
std::string comparison_page(const ComparisonReport& comparison);

/// Writes precision-recall and lanes as SVG and PNG into the folder of an output. Throws
/// Error(output).
void draw_comparison(const ComparisonReport& comparison, const std::filesystem::path& folder);

}  // namespace vpr
