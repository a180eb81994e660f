// Result files (vpr.result): RESULT.json and its arrays, RESULT.npz.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/json.h"
#include "base/output.h"
#include "database/sequence_database.h"
#include "query/matrix_file.h"
#include "query/result.h"
#include "query/result_arrays.h"
#include "query/run_info.h"

namespace vpr {

/// The parts of the JSON that are not in Result. Files may have moved or changed since the run.
struct ResultContext {
  RunInfo run;
  std::string database_fingerprint;
  std::string query_fingerprint;
  std::map<std::string, double> seconds;  ///< written only
  std::optional<MatrixLayout> matrix;     ///< of a saved matrix
  FileEntries files;  ///< a saved matrix or posteriors; write_result adds the arrays
  std::map<std::filesystem::path, std::string> checksums = {};  ///< of outputs, as far as known
  /// Checksums of other files of the run in the folder of the result, by name.
  nlohmann::ordered_map<std::string, std::string> companions = {};
  /// The training sequences of a database in memory; null: those of the database at its path. Not
  /// in the file.
  std::shared_ptr<const std::vector<TrainSequence>> train = {};
};

/// Claims the result and its arrays.
void claim_result(const std::filesystem::path& path, Outputs& outputs);

/// Claims another output: of a result that it replaces, the arrays are removed as well.
void claim_over_result(const std::filesystem::path& path, Outputs& outputs);

/// The checksum of everything but "machine", "timing" and the checksum itself.
std::string result_checksum(Json json);

/// "settings" of a result or a report, by its "method". Throws Error(data).
QuerySettings read_query_settings(const Fields& file);

/// A result file with a valid checksum. Throws as read_result does.
Json read_result_json(const std::filesystem::path& path);

/// The JSON, with the files that the context has, and its schema.
Json result_json(const Result& result, const ResultContext& context);
Json result_schema();

/// Writes the arrays and the JSON, which it returns; the caller commits. The JSON has the checksums
/// of all earlier outputs in the folder of the result, such as a matrix.
Json write_result(const std::filesystem::path& path, const Result& result, ResultContext context,
                  Outputs& outputs);

/// The content of a result file.
struct StoredResult {
  Result result;
  ResultContext context;
  /// Checksum except "machine" and "timing"; empty: the result is not from a file.
  std::string fingerprint;
};

/// The checksum that the file of a result in memory would have.
std::string fingerprint_of(const StoredResult& stored);

/// Throws Error(input) if a file is missing, and Error(data) if a file is damaged, has another
/// version or belongs to another run, or if an index is out of range.
StoredResult read_result(const std::filesystem::path& path, const Monitor& monitor = {});

}  // namespace vpr
