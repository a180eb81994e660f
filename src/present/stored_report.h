// Reports of vpr-eval (vpr.report/1), read back.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/enum_names.h"
#include "base/json_fwd.h"
#include "evaluate/outcomes.h"

namespace vpr {

/// What a comparison needs of a report.
struct StoredReport {
  std::string method;
  std::string query;
  std::string ground_truth;              ///< in words
  std::string ground_truth_fingerprint;  ///< of the labels of all pairs
  std::string walk;                      ///< how the query was replayed, in words; empty: as it is
  bool has_places = false;               ///< references are places of FAB-MAP, and not frames
  std::string fingerprint;               ///< of the result or the scores
  std::optional<std::string> name;       ///< that the user gave
  Outcomes outcomes;                     ///< without the references of best matches
  std::optional<double> share;           ///< of all frames of the path, those with a right fix
  uint64_t wrong = 0;                    ///< frames with a wrong fix
  uint64_t longest_gap = 0;              ///< consecutive frames without a right fix
  bool is_oracle = false;                ///< fixes are by a threshold from the ground truth
  std::string fixes;                     ///< one letter per frame: r, w, i (not judged) or .
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
enum class GroundTruths { same, different, of_places_and_frames };
template <>
inline constexpr std::array<std::string_view, 3> kEnumNames<GroundTruths> = {
    "same", "different", "of-places-and-frames"};

/// Whether reports have one ground truth, by fingerprints, and where their walks differ by words.
GroundTruths compare_ground_truths(const std::vector<StoredReport>& reports);

/// What tables call the reports, whose files `paths` are: the names that users gave, which always
/// stay, and otherwise the methods. Of these, those that clash with another become the files'
/// names, and, if that does not help, numbers are added.
std::vector<std::string> report_names(const std::vector<StoredReport>& reports,
                                      const std::vector<std::string>& paths);

}  // namespace vpr
