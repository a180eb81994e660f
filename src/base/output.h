// Output files and folders: written under a hidden name beside the target, flushed, then renamed.
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

namespace vpr {

/// What happens to an output that exists already.
enum class Existing { refuse, replace };

/// Whether a folder holds nothing but an output of ours. Other folders are never replaced.
using FolderCheck = bool (*)(const std::filesystem::path& folder);

/// The entries of a folder, in the order of the file system. Throws Error(output) if it cannot be
/// read.
std::vector<std::filesystem::directory_entry> entries_of(const std::filesystem::path& folder);

/// Whether everything in a folder is a regular file whose name passes. Throws Error(output) if it
/// cannot be read.
bool holds_only_files(const std::filesystem::path& folder,
                      const std::function<bool(const std::string& name)>& is_ours);

/// The check of folders that have no other mark: their commit adds a file `.vpr-files` with the
/// names of all others, one per line; a folder passes if every file in it is named there.
bool is_marked_folder(const std::filesystem::path& folder);

/// Writes a new file in the temporary() of a folder, the parts one after the other; commit flushes
/// it. Throws Error(output).
void write_part(const std::filesystem::path& path,
                std::initializer_list<std::span<const std::byte>> parts);
void write_part(const std::filesystem::path& path, std::string_view text);
/// Makes a folder in the temporary() of a folder, where it must not exist. Throws Error(output).
void make_part_folder(const std::filesystem::path& path);

/// One output file or folder. Its temporary is locked while this object lives, and removed with it.
/// Throws Error(output) on any failure, a full disk included.
class Output {
 public:
  /// A file, or with `is_ours` a folder. First removes what killed processes left of this target.
  /// Throws Error(usage) when the target exists and is to be refused, is of the wrong kind, or is a
  /// folder that is neither empty nor passes `is_ours`; Error(output) when nothing can be written
  /// beside it.
  Output(const std::filesystem::path& target, Existing existing, FolderCheck is_ours = nullptr);
  ~Output();
  Output(const Output&) = delete;
  Output& operator=(const Output&) = delete;

  const std::filesystem::path& path() const { return target_; }
  /// The file or folder while it is written.
  const std::filesystem::path& temporary() const { return temporary_; }
  bool is_folder() const { return is_ours_ != nullptr; }

  /// Of a file: appends.
  void write(std::span<const std::byte> bytes);
  void write(std::string_view text);
  /// Of a file: reserves the space, so that a full disk is an error before hours of work.
  void reserve(uint64_t size);
  /// Of a file: threads may write at once to ranges that do not overlap.
  void write_at(uint64_t offset, std::span<const std::byte> bytes);

  /// Puts this output alone in its place.
  void commit();

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
  bool is_placed_ = false;  ///< nothing is left under the temporary name
};

/// All outputs of one run. They are claimed before the long work, which finds out whether they can
/// be written; then requested, filled, and committed at the end. The first claimed output is the
/// main one. A claimed output that is never requested is not written. Without commit(), everything
/// stays as it was.
class Outputs {
 public:
  explicit Outputs(Existing existing) : existing_(existing) {}

  /// A file or folder that the run reads: no output may replace it, or a folder that it is in.
  /// Throws Error(usage) if a claimed output would. A missing input is ignored.
  void protect(const std::filesystem::path& input);

  /// An input that the run may replace after all, because it is read completely before.
  void release(const std::filesystem::path& input);

  /// An input that the run extends in place: its output replaces it without --force.
  void extend(const std::filesystem::path& input);

  /// Throw as Output does, and Error(usage) if the path is claimed already or protected.
  void claim_file(const std::filesystem::path& path);
  void claim_folder(const std::filesystem::path& path, FolderCheck is_ours);

  /// A claimed output, or one that is claimed now; to be requested once. Lives until commit().
  Output& file(const std::filesystem::path& path);
  Output& folder(const std::filesystem::path& path, FolderCheck is_ours);

  /// The requested files in the folder of `main`, without itself.
  std::vector<const Output*> files_beside(const std::filesystem::path& main) const;

  /// The sentence with the targets' names in place of temporary ones.
  std::string with_targets(std::string sentence) const;

  /// Whether a requested output is not committed yet.
  bool has_outputs() const;

  /// Puts the requested outputs in their places: all are flushed, then renamed one after the other,
  /// the main one last, then their folders are flushed. A lock on the main output's folder keeps
  /// the renames of two runs apart. If a rename fails, Error(output) says which outputs are new.
  void commit();

 private:
  struct Claim {
    std::unique_ptr<Output> output;
    bool is_requested = false;
  };
  /// Device and inode: the same for all names of a file.
  using Identity = std::pair<uint64_t, uint64_t>;

  Claim& claim(const std::filesystem::path& path, FolderCheck is_ours);
  Claim* find(const std::filesystem::path& path);
  Output& request(const std::filesystem::path& path, FolderCheck is_ours);
  void check_protected(const std::filesystem::path& path) const;

  Existing existing_;
  std::vector<Claim> claims_;
  std::set<Identity> inputs_;
  std::set<Identity> around_inputs_;  ///< folders that inputs are in
  std::set<Identity> extended_;
};

}  // namespace vpr
