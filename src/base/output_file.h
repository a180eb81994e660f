// Outputs that are complete or absent: written under a temporary name beside the target, renamed
// when done, removed when work fails.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string_view>

namespace vpr {

enum class Existing { refuse, replace };

/// Throws Error(usage) when `path` exists and is to be refused, or is a folder, and Error(output)
/// when its parent folder is missing. Call it before long work; commit checks again.
void check_output_file(const std::filesystem::path& path, Existing existing);

/// One file. Throws Error(output) on any failure, a full disk included.
class OutputFile {
 public:
  OutputFile(std::filesystem::path path, Existing existing);
  ~OutputFile();
  OutputFile(OutputFile&& other) noexcept;
  OutputFile& operator=(OutputFile&&) = delete;

  void write(std::span<const std::byte> bytes);
  void write(std::string_view text);
  /// Reserves the space, so that a full disk shows before hours of work do.
  void reserve(uint64_t size);
  /// Several threads may write at once to places that do not overlap.
  void write_at(uint64_t offset, std::span<const std::byte> bytes);
  /// Closes and renames. Without a commit, nothing stays.
  void commit();

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
  std::filesystem::path temporary_;
  Existing existing_;
  int file_ = -1;
};

/// Whether a folder holds nothing but an output of ours, so that nobody's home is replaced by a
/// slip.
using FolderCheck = bool (*)(const std::filesystem::path& folder);

/// Throws like check_output_file; with `replace`, a folder that stands there must be empty or pass
/// `is_ours`.
void check_output_folder(const std::filesystem::path& path, Existing existing, FolderCheck is_ours);

/// A folder. Write into temporary(), then commit: the whole folder appears, or is exchanged with
/// the old one, in one step.
class OutputFolder {
 public:
  OutputFolder(const std::filesystem::path& path, Existing existing, FolderCheck is_ours);
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  const std::filesystem::path& temporary() const { return temporary_; }
  void commit();

 private:
  std::filesystem::path path_;
  std::filesystem::path temporary_;
  Existing existing_;
};

/// Writes a whole file in one go: open, write, commit.
void write_file(const std::filesystem::path& path, std::string_view text, Existing existing);

}  // namespace vpr
