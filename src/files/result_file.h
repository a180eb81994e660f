// Result files (vpr.result/3): RESULT.json and its arrays, such as RESULT.recognitions.npy. Also
// the lines of a live query (vpr.live/3).
#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/json.h"
#include "base/output.h"
#include "decide/result.h"
#include "files/run_info.h"
#include "store/sequence_database.h"

namespace vpr {

/// The parts of the JSON that are not in Result.
struct ResultContext {
  RunInfo run;
  std::string database_fingerprint;
  std::string query_fingerprint;
  std::string fused_fingerprint;  ///< of FAB-MAP's database; empty without fusion
  std::map<std::string, double> seconds;
  std::optional<size_t> verified_cells;  ///< recomputed by the reference implementation, all equal
  std::optional<Json> matrix;            ///< layout of a saved matrix
  std::map<std::string, Json> files;     ///< rows and checksum of a saved matrix or posteriors
  std::map<std::filesystem::path, std::string> checksums = {};  ///< of outputs, as far as known
  std::optional<Json> scores;       ///< the unit of integers, for a precomputed matrix
  std::optional<Json> explanation;  ///< of one frame, by FAB-MAP
};

/// The arrays that a result may have.
inline constexpr std::array<const char*, 11> kResultArrays = {"recognitions.npy",
                                                              "recognition_scores.npy",
                                                              "best.npy",
                                                              "best_scores.npy",
                                                              "margins.npy",
                                                              "path.npy",
                                                              "keyframes.npy",
                                                              "new_place.npy",
                                                              "source_frames.npy",
                                                              "best_rates.npy",
                                                              "train_source_frames.npy"};

/// An array of a result.
struct ResultArray {
  std::string name;       ///< of kResultArrays, without its extension
  std::string_view type;  ///< as npy_type
  size_t rows = 0;
  std::vector<std::string_view> columns;  ///< their names; one without a name: not a matrix
  std::span<const std::byte> values;      ///< row by row; valid during the visit
};

/// Visits the arrays of a result in the order of their files.
void visit_arrays(const Result& result, const std::function<void(const ResultArray&)>& visit);

/// RESULT.recognitions.npy for RESULT.json and recognitions.npy.
std::filesystem::path companion_path(const std::filesystem::path& result, const std::string& kind);

/// Claims the result and its companions.
void claim_result(const std::filesystem::path& path, Outputs& outputs);

/// The checksum of a file, which may be larger than memory.
std::string file_checksum(const std::filesystem::path& path, const Monitor& monitor = {});

/// The entry of a file in the JSON.
Json file_entry(const std::filesystem::path& path, size_t rows, const Monitor& monitor);

/// The checksum of everything but "machine", "timing" and the checksum itself.
std::string result_checksum(Json json);

/// "settings" of a result or a report, by its "method". Throws Error(data).
QuerySettings read_query_settings(const Fields& file);

/// A result file with a valid checksum. Throws as read_result does.
Json read_result_json(const std::filesystem::path& path);

/// "clusters" of a result.
Json clusters_json(const Clusters& clusters, size_t window_length);

/// The JSON without its companions' checksums.
Json result_json(const Result& result, const ResultContext& context);

/// Writes the arrays and the JSON, which it returns; the caller commits. The JSON has the checksums
/// of all earlier outputs in the folder of the result, such as a matrix.
Json write_result(const std::filesystem::path& path, const Result& result,
                  const ResultContext& context, Outputs& outputs);

/// The JSON that write_result writes if there are no other outputs.
Json sealed_result_json(const Result& result, const ResultContext& context);

/// Inputs of a run. Files may have moved or changed since.
struct RecordedRun {
  std::map<std::string, std::string> paths;        ///< by role, such as "query" and "database"
  std::map<std::string, std::string> frame_names;  ///< names_checksum of their frames
  std::string database_fingerprint;
  /// The training sequences of a database in memory; null: those of the database at its path.
  std::shared_ptr<const std::vector<TrainSequence>> train = {};

  /// A value by its role; empty: unknown.
  std::string path(const std::string& role) const;
};

/// The content of a result file.
struct StoredResult {
  Result result;
  std::string fingerprint;                          ///< of everything except "machine" and "timing"
  std::optional<std::string> matrix_checksum = {};  ///< of the saved matrix, if there is one
  RecordedRun run = {};
};

/// Throws Error(input) if a file is missing, and Error(data) if a file is damaged, has another
/// version or belongs to another run, or if an index is out of range.
StoredResult read_result(const std::filesystem::path& path, const Monitor& monitor = {});

/// The newest frame of a live query.
struct LineFrame {
  size_t number = 0;
  std::string name;
  bool is_readable = true;
};

/// docs/schemas/live.schema.json. `window`: the query window that ends at the frame. Null `result`:
/// the frame ends no window.
Json live_line(const LineFrame& frame, const Result* result, size_t window);

}  // namespace vpr
