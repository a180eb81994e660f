// The hidden name beside an output under which it is made.
#pragma once

#include <filesystem>

namespace vpr {

/// Throws Error(output): "<target>: can't be written: <what errno says>".
[[noreturn]] void fail_to_write(const std::filesystem::path& target, int error_number);

/// The folder that holds a path; "." for a bare name.
std::filesystem::path folder_of(const std::filesystem::path& path);

/// Has what was renamed in a folder reach the disk. Throws Error(output) that names `target`.
void flush_folder(const std::filesystem::path& folder, const std::filesystem::path& target);

/// Where the old output waits while a temporary takes its name, on file systems that can't exchange
/// two names in one step.
std::filesystem::path name_aside(const std::filesystem::path& temporary);

/// Removes what processes left that ended without cleaning up while they wrote `target`, and puts
/// back what one of them had set aside and not replaced. What a living one writes stays; so does
/// everything where locks or files can't be had.
void clean_up(const std::filesystem::path& target);

/// A new file or folder in the folder of `target`, with an unpredictable name that is short
/// whatever the target's is. It is locked as long as this object lives: by that clean_up tells what
/// a living process is writing from what a dead one left. Throws Error(output).
class Temporary {
 public:
  enum class Kind { file, folder };

  Temporary(const std::filesystem::path& target, Kind kind);
  /// Removes what stands under path(), unless it was given up.
  ~Temporary();
  Temporary(Temporary&& other) noexcept;
  Temporary& operator=(Temporary&&) = delete;

  const std::filesystem::path& path() const { return path_; }
  Kind kind() const { return kind_; }
  /// Open for reading and writing, of a file; for reading, of a folder.
  int descriptor() const { return descriptor_; }
  /// Has all bytes reach the disk: of a folder, those of everything in it.
  void flush() const;
  /// Nothing is removed any more.
  void give_up() { is_ours_ = false; }

 private:
  std::filesystem::path target_;
  std::filesystem::path path_;
  Kind kind_;
  int descriptor_ = -1;
  bool is_ours_ = true;
};

}  // namespace vpr
