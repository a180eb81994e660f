// Reports of vpr-eval (vpr.report/1), read back.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/enum_names.h"
#include "base/json_fwd.h"
#include "evaluation/outcomes.h"

namespace vpr {

/// What a comparison needs of a report.
struct StoredReport {
  std::string method;
  std::string query;
  std::string ground_truth;  ///< in words
  /// Of the labels of all pairs; reports of older versions have none.
  std::optional<std::string> ground_truth_fingerprint;
  std::string walk;                     ///< how the query was replayed, in words; empty: as it is
  bool has_places = false;              ///< references are places of FAB-MAP, and not frames
  std::string fingerprint;              ///< of the result or the scores
  std::optional<std::string> name;      ///< that the user gave
  Outcomes outcomes;                    ///< without the references of best matches
  std::optional<double> share;          ///< of all frames of the path, those with a right fix
  std::optional<uint64_t> wrong;        ///< frames with a wrong fix
  std::optional<uint64_t> longest_gap;  ///< frames in a row without a right one
  bool is_oracle = false;               ///< fixes are by a threshold from the ground truth
  std::string fixes;                    ///< a letter a frame; reports of older versions have none
};

/// Reads a report for comparison. Throws Error(input) if the file can't be read, Error(usage) for a
/// result, Error(data) if it is something else, or damaged.
StoredReport read_report(const std::filesystem::path& path);
/// The same of a report that was read; `where` is what messages call it.
StoredReport stored_report(const Json& json, const std::string& where);

/// Whether a report is of the same walk as another: of the query as it is, or replayed likewise.
bool is_same_walk(const StoredReport& a, const StoredReport& b);

/// Whether reports are judged by one ground truth. of_places_and_frames: places of some, frames of
/// others, each kind by one; they say of different things, and can agree by query only.
enum class GroundTruths { same, different, unknown, of_places_and_frames };
template <>
inline constexpr std::array<std::string_view, 4> kEnumNames<GroundTruths> = {
    "same", "different", "unknown", "of-places-and-frames"};

/// Whether reports have one ground truth, by fingerprints, and where their walks differ by words;
/// unknown where those that are there agree
/// and one is missing.
GroundTruths compare_ground_truths(const std::vector<StoredReport>& reports);

/// What tables call the reports, whose files `paths` are: the names that users gave, which always
/// stay, and otherwise the methods. Of these, those that clash with another become the files'
/// names, and, if that does not help, numbers are added.
std::vector<std::string> report_names(const std::vector<StoredReport>& reports,
                                      const std::vector<std::string>& paths);

}  // namespace vpr
