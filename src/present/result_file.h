// Result files (vpr.result/2): RESULT.json and, named after it, RESULT.recognitions.npy,
// RESULT.best.npy and the other arrays of kResultArrays. Also the lines of a live query
// (vpr.live/1).
#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "base/json.h"
#include "base/output.h"
#include "decide/result.h"
#include "present/run_info.h"

namespace vpr {

/// What else goes into the JSON.
struct ResultContext {
  RunInfo run;
  std::string database_fingerprint;
  std::string query_fingerprint;
  std::string fused_fingerprint;  ///< of FAB-MAP's database; empty: it was not asked
  std::map<std::string, double> seconds;
  std::optional<size_t> verified_cells;  ///< recomputed by definition, without a difference
  std::optional<Json> matrix;            ///< layout of a saved matrix
  std::map<std::string, Json> files;     ///< of a saved matrix or posteriors: rows and checksum
  std::map<std::filesystem::path, std::string> checksums =
      {};                           ///< of outputs that were summed already
  std::optional<Json> scores;       ///< what whole numbers stand for, of a given matrix
  std::optional<Json> explanation;  ///< of one frame, by FAB-MAP
};

/// The arrays that a result may have beside it.
inline constexpr std::array<const char*, 11> kResultArrays = {"recognitions.npy",
                                                              "recognition_scores.npy",
                                                              "best.npy",
                                                              "best_scores.npy",
                                                              "margins.npy",
                                                              "path.npy",
                                                              "views.npy",
                                                              "new_place.npy",
                                                              "source_frames.npy",
                                                              "best_rates.npy",
                                                              "train_source_frames.npy"};

/// RESULT.recognitions.npy for RESULT.json.
std::filesystem::path companion_path(const std::filesystem::path& result, const std::string& kind);

/// Claims the result and its companions.
void claim_result(const std::filesystem::path& path, Outputs& outputs);

/// The checksum of a whole file, which may be larger than memory.
std::string file_checksum(const std::filesystem::path& path, const Monitor& monitor = {});

/// The object of a whole file in the JSON.
Json file_entry(const std::filesystem::path& path, size_t rows, const Monitor& monitor);

/// The checksum of everything but "machine", "timing" and the checksum itself.
std::string result_checksum(Json json);

/// A result file as it stands, its checksum verified. Throws as read_result does.
Json read_result_json(const std::filesystem::path& path);

/// "clusters" of a result.
Json clusters_json(const Clusters& clusters, size_t window_length);

/// The JSON without its companions' checksums.
Json result_json(const Result& result, const ResultContext& context);

/// Writes the arrays and the JSON, which it returns; the caller commits. Files that were requested
/// before, in the folder of the result (a matrix, its image), are tied to it by their checksums.
Json write_result(const std::filesystem::path& path, const Result& result,
                  const ResultContext& context, Outputs& outputs);

/// A result file as it was read.
struct StoredResult {
  Result result;
  std::string fingerprint;  ///< of everything but "machine" and "timing"
  /// Of the matrix that was saved with it; none in a result without.
  std::optional<std::string> matrix_checksum = {};
  /// Paths of the run by role, such as "query" and "database"; files may have moved since.
  std::map<std::string, std::string> paths = {};
};

/// A result of any method. Throws Error(input) if a file is missing, Error(data) if one is damaged
/// or of another version, if a companion is not the one that the JSON was written with, or an index
/// is out of range.
StoredResult read_result(const std::filesystem::path& path, const Monitor& monitor = {});

/// The newest frame of a query.
struct LineFrame {
  size_t number = 0;
  std::string name;
  bool is_readable = true;
};

/// docs/live.schema.json. `window`: the query window of the result that ends with the frame; none
/// where the frames before it do not fill one.
Json live_line(const LineFrame& frame, const Result* result, size_t window);

}  // namespace vpr
