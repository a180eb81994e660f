// The folder NAME.vprdb, which holds any kind of database: manifest.json and checksummed files.
#pragma once

#include <array>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/enum_names.h"
#include "base/json.h"
#include "base/npy.h"
#include "base/output.h"

namespace vpr {

/// The file of a database folder that lists all other files.
inline constexpr std::string_view kManifestName = "manifest.json";

/// The paths of training sequences, one per line; it may be missing, and is not content.
inline constexpr std::string_view kPathsName = "paths.txt";

/// Whether a folder holds a database of any kind or version and nothing else.
bool is_database_folder(const std::filesystem::path& folder);

/// The text of a manifest, with the checksum of the preceding text as its last key.
std::string sealed_manifest(const Json& manifest);

/// A file of a database folder, in its manifest.
struct ArchiveFile {
  uint64_t bytes = 0;
  std::string checksum;
};
VPR_FIELDS(ArchiveFile, (bytes, "Size in bytes."), (checksum, "Checksum of the file.", kIsChecksum))

/// The schema of a manifest with the keys that ArchiveWriter::finish adds.
Json with_files(Json schema);

/// Writes files into an output, then the manifest. Without a folder, it only computes checksums.
class ArchiveWriter {
 public:
  explicit ArchiveWriter(Output* folder) : folder_(folder) {}

  template <class T>
  void add_array(const std::string& name, std::span<const T> values,
                 const std::vector<size_t>& shape) {
    add(name, npy_header(npy_type<T>(), shape), std::as_bytes(values));
  }
  void add_text(const std::string& name, std::string_view text) { add(name, text, {}); }

  /// Adds "files" (sizes and checksums) and "checksum" (of the manifest's own text) to `manifest`.
  /// Returns that checksum, the fingerprint of the database.
  std::string finish(Json manifest);

 private:
  void add(const std::string& name, std::string_view start, std::span<const std::byte> rest);

  Output* folder_;
  nlohmann::ordered_map<std::string, ArchiveFile> files_;
};

/// An opened folder with an intact manifest. Throws Error(input) if it is missing; Error(data) with
/// the name of the file if it is damaged, of another kind or of another version.
class Archive {
 public:
  explicit Archive(std::filesystem::path path);

  const Json& manifest() const { return manifest_; }
  const std::string& name() const { return source_.where; }
  /// An object of the manifest, which must outlive the result.
  Fields fields(const Json& object) const { return {object, source_}; }
  /// Changes with every bit of content.
  std::string fingerprint() const;

  /// Memory-mapped. Throws Error(data) if size or checksum differ from the manifest.
  NpyArray array(const std::string& name) const;
  std::string text(const std::string& name) const;

  /// Throws Error(data) "<path>: the manifest is damaged: <what>".
  [[noreturn]] void fail(std::string_view what) const { source_.fail(what); }

 private:
  void verify(const std::string& name, std::span<const std::byte> bytes) const;

  std::filesystem::path path_;
  JsonSource source_;
  Json manifest_;
};

/// The family of methods that a database serves.
enum class DatabaseFamily { sequences, fabmap };
/// The names in manifests.
template <>
inline constexpr std::array<std::string_view, 2> kEnumNames<DatabaseFamily> = {"fastable",
                                                                               "fabmap"};

/// "database of sequences", "FAB-MAP database".
std::string_view family_text(DatabaseFamily family);

/// Reads only the manifest. Throws Error(input) if it is missing, Error(data) if it is damaged or
/// names an unknown family.
DatabaseFamily database_family(const std::filesystem::path& path);

/// Throws Error(data) unless the database is of this family.
void require_family(const Archive& archive, DatabaseFamily family);

}  // namespace vpr
