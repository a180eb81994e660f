// Output files and folders: written under a hidden name next to the target, flushed, then renamed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <initializer_list>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/error.h"

namespace vpr {

/// The treatment of an output that exists already.
enum class Existing { refuse, replace };

/// Whether a folder holds nothing but one of our outputs. Other folders are never replaced.
using FolderCheck = bool (*)(const std::filesystem::path& folder);

/// Removes what incomplete outputs have written, before a process ends that cannot continue.
void remove_temporaries();

/// The entries of a folder, in the order of the file system. Throws Error(kind) if it cannot be
/// read.
std::vector<std::filesystem::directory_entry> entries_of(const std::filesystem::path& folder,
                                                         ErrorKind kind = ErrorKind::output);

/// Whether a folder holds only regular files whose names pass `is_ours`. Throws Error(output) if it
/// cannot be read.
bool holds_only_files(const std::filesystem::path& folder,
                      const std::function<bool(const std::string& name)>& is_ours);

/// The check for folders without any other mark. Their commit adds a file `.vpr-files` with the
/// names of all other files, one per line; a folder passes if every file in it is listed there.
bool is_marked_folder(const std::filesystem::path& folder);

/// Writes a new file into the temporary() of a folder, all parts in order; commit flushes it.
/// Throws Error(output).
void write_part(const std::filesystem::path& path,
                std::initializer_list<std::span<const std::byte>> parts);
void write_part(const std::filesystem::path& path, std::string_view text);
/// Creates a new folder in the temporary() of a folder. Throws Error(output).
void make_part_folder(const std::filesystem::path& path);

/// One output file or folder. This object holds a lock on its temporary and removes the temporary
/// when it is destroyed. Throws Error(output) on any failure, including a full disk.
class Output {
 public:
  /// A file, or a folder if `is_ours` is set. First removes the temporaries of this target that
  /// killed processes left. Throws Error(usage) if the target exists and `existing` is refuse, is
  /// of the wrong kind, or is a folder that is neither empty nor passes `is_ours`; Error(output) if
  /// its folder is not writable.
  Output(const std::filesystem::path& target, Existing existing, FolderCheck is_ours = nullptr);
  ~Output();
  Output(const Output&) = delete;
  Output& operator=(const Output&) = delete;

  const std::filesystem::path& path() const { return target_; }
  /// The file or folder until commit.
  const std::filesystem::path& temporary() const { return temporary_; }
  bool is_folder() const { return is_ours_ != nullptr; }

  /// Appends to a file.
  void write(std::span<const std::byte> bytes);
  void write(std::string_view text) { write(std::as_bytes(std::span(text))); }
  /// Reserves space for a file, so that a full disk is an error before hours of work.
  void reserve(uint64_t size);
  /// Writes to a file. Threads may write concurrently to ranges that do not overlap.
  void write_at(uint64_t offset, std::span<const std::byte> bytes);

 private:
  friend class Outputs;
  void check() const;
  void flush();
  void place();

  std::filesystem::path target_;
  Existing existing_;
  FolderCheck is_ours_;
  std::filesystem::path temporary_;
  int descriptor_ = -1;
  bool is_placed_ = false;  ///< the temporary name no longer exists
};

/// All outputs of one run. Claim them before the long work, which checks that they can be written;
/// then request them, fill them, and commit at the end. The first claimed output is the main one. A
/// claimed output that is never requested is not written, and commit() removes an old file of its
/// name, which belongs to the replaced outputs. Without commit(), nothing changes.
class Outputs {
 public:
  explicit Outputs(Existing existing) : existing_(existing) {}

  /// Protects an input of the run: no output may replace it or a folder that contains it. Throws
  /// Error(usage) if a claimed output would. A missing input is ignored.
  void protect(const std::filesystem::path& input);

  /// Lifts the protection of an input that the run reads completely before it writes.
  void release(const std::filesystem::path& input);

  /// An input that the run extends in place: its output replaces it without --force.
  void extend(const std::filesystem::path& input);

  /// Throw as Output does, and Error(usage) if the path is already claimed or is protected.
  void claim_file(const std::filesystem::path& path) { claim(path, nullptr); }
  void claim_folder(const std::filesystem::path& path, FolderCheck is_ours) {
    claim(path, is_ours);
  }

  /// Requests an output, which is claimed if necessary. Each can be requested once. Valid until
  /// commit().
  Output& file(const std::filesystem::path& path) { return folder(path, nullptr); }
  Output& folder(const std::filesystem::path& path, FolderCheck is_ours);

  /// The requested files in the folder of `main`, except `main`.
  std::vector<const Output*> files_next_to(const std::filesystem::path& main) const;

  /// The sentence with temporary names replaced by the names of the targets.
  std::string with_targets(std::string sentence) const;

  /// Whether any requested output is not committed yet.
  bool has_outputs() const;

  /// Flushes all requested outputs, renames them to their targets, the main one last, and flushes
  /// their folders. A lock on the folder of the main output keeps the renames of two runs apart. If
  /// a rename fails, Error(output) lists the outputs that are already new.
  void commit();

 private:
  struct Claim {
    std::unique_ptr<Output> output;
    bool is_requested = false;
  };
  /// Device and inode: equal for all names of one file.
  using Identity = std::pair<uint64_t, uint64_t>;

  Claim& claim(const std::filesystem::path& path, FolderCheck is_ours);
  Claim* find(const std::filesystem::path& path);
  void check_protected(const std::filesystem::path& path) const;
  static void remove_replaced(const std::vector<Claim>& claims);

  Existing existing_;
  std::vector<Claim> claims_;
  std::set<Identity> inputs_;
  std::set<Identity> around_inputs_;  ///< folders that contain inputs
  std::set<Identity> extended_;
};

}  // namespace vpr
