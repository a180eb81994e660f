// Outputs that are complete or absent: written under a temporary name beside the target, flushed,
// renamed when done, removed when work fails. One run's outputs are committed together by an
// OutputTransaction (output_transaction.h).
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/pending_output.h"

namespace vpr {

/// Checks whether a file can be written. Throws Error(usage) when `path` exists and is to be
/// refused, or is a folder or no regular file, and Error(output) when its parent folder is missing,
/// or its name is too long. Call it before long work; commit checks again.
void check_output_file(const std::filesystem::path& path, Existing existing);

/// One file. Throws Error(output) on any failure, a full disk included.
class OutputFile {
 public:
  OutputFile(const std::filesystem::path& path, Existing existing);

  void write(std::span<const std::byte> bytes);
  void write(std::string_view text);
  /// Reserves the space, so that a full disk shows before hours of work do.
  void reserve(uint64_t size);
  /// Several threads may write at once to places that do not overlap.
  void write_at(uint64_t offset, std::span<const std::byte> bytes);
  /// Puts this file alone in its place. Without a commit, nothing stays.
  void commit();

  const std::filesystem::path& path() const { return pending_.target(); }
  /// Where what was written so far can be read.
  const std::filesystem::path& temporary() const { return pending_.temporary().path(); }
  PendingOutput& pending() { return pending_; }

 private:
  PendingOutput pending_;
};

/// Whether a folder holds nothing but an output of ours, so that nobody's home is replaced by a
/// slip.
using FolderCheck = bool (*)(const std::filesystem::path& folder);

/// What is in a folder, in the order of the file system. Throws Error(output) if it can't be read.
std::vector<std::filesystem::directory_entry> entries_of(const std::filesystem::path& folder);

/// Whether everything in a folder is a regular file whose name passes. Throws Error(output) if it
/// can't be read.
bool holds_only_files(const std::filesystem::path& folder,
                      const std::function<bool(const std::string& name)>& is_ours);

/// The check of folders that have no other mark: their commit leaves a file `.vpr-files` in them,
/// with the names of all others, one a line; a folder passes if every file in it is named there.
bool is_marked_folder(const std::filesystem::path& folder);

/// Throws like check_output_file; with `replace`, a folder that stands there must be empty or pass
/// `is_ours`.
void check_output_folder(const std::filesystem::path& path, Existing existing, FolderCheck is_ours);

/// A folder. Write into temporary(), then commit: the whole folder appears, or is exchanged with
/// the old one, in one step.
class OutputFolder {
 public:
  OutputFolder(const std::filesystem::path& path, Existing existing, FolderCheck is_ours);

  const std::filesystem::path& temporary() const { return pending_.temporary().path(); }
  /// Puts this folder alone in its place.
  void commit();
  PendingOutput& pending() { return pending_; }
  /// Leaves the mark, where folders of this kind have one.
  void complete();

 private:
  FolderCheck is_ours_;
  PendingOutput pending_;
};

/// Writes a new file that is part of an OutputFolder, whose temporary() its path starts with: it
/// needs no temporary of its own, and is flushed with the folder. `parts` stand one after the
/// other. Throws Error(output).
void write_part(const std::filesystem::path& path,
                std::initializer_list<std::span<const std::byte>> parts);
void write_part(const std::filesystem::path& path, std::string_view text);
/// Makes a folder in an OutputFolder, which must not be there yet. Throws Error(output).
void make_part_folder(const std::filesystem::path& path);

}  // namespace vpr
