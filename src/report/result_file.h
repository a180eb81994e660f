// Result files (vpr.result/1): RESULT.json and, named after it, RESULT.hits.npy, RESULT.best.npy
// and RESULT.views.npy.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "base/checksum.h"
#include "base/json.h"
#include "base/npy.h"
#include "base/output_transaction.h"
#include "recognition/sequence_result.h"
#include "report/run_info.h"

namespace vpr {

/// What else goes into the JSON.
struct ResultContext {
  RunInfo run;
  std::string database_fingerprint;
  std::string query_fingerprint;
  std::map<std::string, double> seconds;
  std::optional<size_t> verified_cells;  ///< recomputed by definition, without a difference
  std::optional<Json> matrix;            ///< layout of a saved matrix
  std::map<std::string, Json> files;     ///< of a saved matrix or posteriors: rows and checksum
  std::optional<Json> explanation;       ///< of one frame, by FAB-MAP
};

/// RESULT.hits.npy for RESULT.json.
std::filesystem::path companion_path(const std::filesystem::path& result, const std::string& kind);

/// Writes an array beside a result. Returns its object in the JSON.
template <class T>
Json write_companion(OutputFile& file, std::span<const T> values,
                     const std::vector<size_t>& shape) {
  const std::string header = npy_header(npy_type<T>(), shape);
  ChecksumStream sum;
  sum.add(std::as_bytes(std::span(header)));
  sum.add(std::as_bytes(values));
  file.write(header);
  file.write(std::as_bytes(values));
  return {{"rows", shape.front()}, {"checksum", sum.text()}};
}

/// Claims the result and its companions.
void claim_result(const std::filesystem::path& path, OutputTransaction& outputs);

/// The object of a whole file in the JSON.
Json file_entry(const std::filesystem::path& path, size_t rows, const Monitor& monitor);

/// Parts of a result that do not depend on the method: provenance, machine and timing.
void add_context(Json& json, const ResultContext& context);

/// Of everything but "machine" and "timing".
std::string result_checksum(Json json);

/// Adds "checksum", of everything but "machine" and "timing", as the last key.
void add_result_checksum(Json& json);

/// A result of any method, its checksum verified. Throws as read_result does.
Json read_result_json(const std::filesystem::path& path);

/// The method of a result file: "fastable", "openable", "fabmap", ... Throws as read_result does.
std::string result_method(const std::filesystem::path& path);

/// The JSON without its companions' checksums.
Json result_json(const SequenceResult& result, const ResultContext& context);

/// Writes the companions and the JSON, which it returns; the caller commits.
Json write_result(const std::filesystem::path& path, const SequenceResult& result,
                  const ResultContext& context, OutputTransaction& outputs);

struct StoredResult {
  SequenceResult result;
  std::string fingerprint;  ///< of everything but "machine" and "timing"
  /// Of the matrix that was saved with it; none in a result without, or of older date.
  std::optional<std::string> matrix_checksum = {};
};

/// Throws Error(input) if a file is missing, Error(data) if one is damaged, of another method or a
/// newer version, if a companion is not the one that the JSON was written with, or an index is out
/// of range.
StoredResult read_result(const std::filesystem::path& path, const Monitor& monitor = {});

}  // namespace vpr
