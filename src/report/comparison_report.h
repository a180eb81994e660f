// Comparisons of reports (vpr.comparison/1).
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/json_fwd.h"
#include "evaluation/comparison.h"
#include "report/run_info.h"
#include "report/table.h"

namespace vpr {

/// What a comparison needs of a report.
struct StoredReport {
  std::string method;
  std::string query;
  std::string ground_truth;  ///< in words
  /// Of the labels of all pairs; reports of older versions have none.
  std::optional<std::string> ground_truth_fingerprint;
  bool has_places = false;          ///< references are places of FAB-MAP, and not frames
  std::string fingerprint;          ///< of the result or the scores
  std::optional<std::string> name;  ///< that the user gave
  Outcomes outcomes;                ///< without the references of best matches
};

/// Reads a report for comparison. Throws Error(input) if the file can't be read, Error(data) if it
/// is no report, or damaged.
StoredReport read_report(const std::filesystem::path& path);

/// Whether reports are judged by one ground truth. of_places_and_frames: places of some, frames of
/// others, each kind by one; they say of different things, and can agree by query only.
enum class GroundTruths { same, different, unknown, of_places_and_frames };
template <>
inline constexpr std::array<std::string_view, 4> kEnumNames<GroundTruths> = {
    "same", "different", "unknown", "of-places-and-frames"};

/// Whether reports have one ground truth, by fingerprints; unknown where those that are there agree
/// and one is missing.
GroundTruths compare_ground_truths(const std::vector<StoredReport>& reports);

/// What tables call the reports, whose files `paths` are: the names that users gave, which always
/// stay, and otherwise the methods. Of these, those that clash with another become the files'
/// names, and, if that does not help, numbers are added.
std::vector<std::string> report_names(const std::vector<StoredReport>& reports,
                                      const std::vector<std::string>& paths);

/// Everything of the file but "machine" and "timing".
Json comparison_json(const Comparison& comparison, const std::vector<StoredReport>& reports,
                     const std::vector<std::string>& names, size_t resamples, const RunInfo& run);

/// A row for each metric and method.
Table comparison_table(const Json& comparison);
/// Whose best matches are right where.
Table paired_table(const Json& comparison);

}  // namespace vpr
