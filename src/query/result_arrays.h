// The arrays of a result file, RESULT.npz: one .npy file per array, not compressed.
#pragma once

#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/json.h"
#include "base/output.h"
#include "query/result.h"

namespace vpr {

struct FileEntry {
  size_t rows = 0;
  std::string checksum;

  bool operator==(const FileEntry&) const = default;
};

VPR_FIELDS(FileEntry, (rows, "Rows of the array."),
           (checksum, "Checksum of the file.", kIsChecksum))

/// By name, in the order in which they were written.
using FileEntries = nlohmann::ordered_map<std::string, FileEntry>;

/// RESULT.npz for RESULT.json.
std::filesystem::path array_path(const std::filesystem::path& result);

/// The checksum of a file, which may be larger than memory.
std::string file_checksum(const std::filesystem::path& path, const Monitor& monitor = {});

struct ResultArray {
  std::string name;       ///< without its extension
  std::string_view type;  ///< as npy_type
  size_t rows = 0;
  std::vector<std::string_view> columns;  ///< their names; one without a name: not a matrix
  std::span<const std::byte> values;      ///< row by row; valid during the visit
};

/// Visits the arrays of a result in the order of their file.
void visit_arrays(const Result& result, const std::function<void(const ResultArray&)>& visit);

/// Adds the entries of the arrays, and writes the arrays unless `file` is null.
void write_arrays(const Result& result, FileEntries& entries, Output* file);

/// Reads the arrays of `path` into a result that has everything else except clusters. Throws
/// Error(input) if their file is missing, and Error(data) or an error of `source` for damage and
/// values out of range.
void read_arrays(const std::filesystem::path& path, const FileEntries& entries,
                 const JsonSource& source, Result& result);

}  // namespace vpr
