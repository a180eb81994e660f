#include "base/output_file.h"

#include <cerrno>
#include <cstdio>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/error.h"

namespace vpr {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const fs::path& path, int error_number) {
  throw Error(ErrorKind::output, fmt::format("{}: can't be written: {}", path.string(),
                                             system_error_text(error_number)));
}

[[noreturn]] void refuse_existing(const fs::path& path) {
  throw Error(ErrorKind::usage,
              fmt::format("{}: exists already; give --force to replace it, or another --output",
                          path.string()));
}

fs::path without_trailing_slash(const fs::path& path) {
  return path.has_filename() ? path : path.parent_path();
}

void check_parent(const fs::path& path) {
  const fs::path parent = path.has_parent_path() ? path.parent_path() : fs::path(".");
  std::error_code error;
  if (!fs::is_directory(parent, error))
    throw Error(ErrorKind::output, fmt::format("{}: can't be written: its folder {} does not exist",
                                               path.string(), parent.string()));
}

fs::path temporary_name(const fs::path& path) {
  return path.parent_path() /
         fmt::format(".{}.partial-{}", path.filename().string(), static_cast<int>(::getpid()));
}

// Renames without replacing. File systems without RENAME_NOREPLACE get a check before.
void rename_new(const fs::path& from, const fs::path& to) {
  if (::renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), RENAME_NOREPLACE) == 0) return;
  if (errno == EEXIST) refuse_existing(to);
  if (errno != EINVAL && errno != ENOSYS) fail(to, errno);
  if (fs::exists(fs::symlink_status(to))) refuse_existing(to);
  if (::rename(from.c_str(), to.c_str()) != 0) fail(to, errno);
}

// Exchanges two folders: in one step where the file system can, in three where it can't.
void exchange(const fs::path& a, const fs::path& b) {
  if (::renameat2(AT_FDCWD, a.c_str(), AT_FDCWD, b.c_str(), RENAME_EXCHANGE) == 0) return;
  if (errno != EINVAL && errno != ENOSYS) fail(b, errno);
  const fs::path old = fs::path(a) += "-old";
  if (::rename(b.c_str(), old.c_str()) != 0 || ::rename(a.c_str(), b.c_str()) != 0 ||
      ::rename(old.c_str(), a.c_str()) != 0)
    fail(b, errno);
}

}  // namespace

void check_output_file(const fs::path& path, Existing existing) {
  std::error_code error;
  const fs::file_status status = fs::symlink_status(path, error);
  if (fs::is_directory(fs::status(path, error)))
    throw Error(
        ErrorKind::usage,
        fmt::format("{}: is a folder, but the output is a file; give a file name", path.string()));
  if (fs::exists(status) && existing == Existing::refuse) refuse_existing(path);
  if (fs::exists(status) && !fs::is_regular_file(status))
    throw Error(ErrorKind::usage,
                fmt::format("{}: is not replaced, because it is no regular file", path.string()));
  check_parent(path);
}

OutputFile::OutputFile(fs::path path, Existing existing)
    : path_(std::move(path)), temporary_(temporary_name(path_)), existing_(existing) {
  check_output_file(path_, existing_);
  file_ = ::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (file_ < 0) fail(path_, errno);
}

OutputFile::OutputFile(OutputFile&& other) noexcept
    : path_(std::move(other.path_)),
      temporary_(std::exchange(other.temporary_, {})),
      existing_(other.existing_),
      file_(std::exchange(other.file_, -1)) {}

OutputFile::~OutputFile() {
  if (file_ >= 0) ::close(file_);
  if (!temporary_.empty()) ::unlink(temporary_.c_str());
}

void OutputFile::write(std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(file_, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail(path_, errno);
    bytes = bytes.subspan(static_cast<size_t>(written));
  }
}

void OutputFile::write(std::string_view text) { write(std::as_bytes(std::span(text))); }

void OutputFile::reserve(uint64_t size) {
  if (size == 0) return;
  int error_number = EINTR;
  while (error_number == EINTR)
    error_number = ::posix_fallocate(file_, 0, static_cast<off_t>(size));
  if (error_number != 0) fail(path_, error_number);
}

void OutputFile::write_at(uint64_t offset, std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::pwrite(file_, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail(path_, errno);
    offset += static_cast<uint64_t>(written);
    bytes = bytes.subspan(static_cast<size_t>(written));
  }
}

void OutputFile::commit() {
  if (::close(std::exchange(file_, -1)) != 0) fail(path_, errno);
  if (existing_ == Existing::refuse) {
    rename_new(temporary_, path_);
  } else if (::rename(temporary_.c_str(), path_.c_str()) != 0) {
    fail(path_, errno);
  }
  temporary_.clear();
}

void check_output_folder(const fs::path& given, Existing existing, FolderCheck is_ours) {
  const fs::path path = without_trailing_slash(given);
  std::error_code error;
  if (fs::exists(fs::symlink_status(path, error))) {
    if (existing == Existing::refuse) refuse_existing(path);
    const bool ours = fs::is_directory(fs::symlink_status(path, error)) &&
                      (fs::is_empty(path, error) || is_ours(path));
    if (!ours)
      throw Error(
          ErrorKind::usage,
          fmt::format("{}: is not replaced, because it is not, or not only, an output of this "
                      "program; give another --output",
                      path.string()));
  }
  check_parent(path);
}

OutputFolder::OutputFolder(const fs::path& path, Existing existing, FolderCheck is_ours)
    : path_(without_trailing_slash(path)), temporary_(temporary_name(path_)), existing_(existing) {
  check_output_folder(path_, existing_, is_ours);
  std::error_code error;
  fs::remove_all(temporary_, error);
  if (::mkdir(temporary_.c_str(), 0777) != 0) fail(path_, errno);
}

OutputFolder::~OutputFolder() {
  std::error_code error;
  if (!temporary_.empty()) fs::remove_all(temporary_, error);
}

void OutputFolder::commit() {
  if (existing_ == Existing::replace && fs::exists(path_)) {
    exchange(temporary_, path_);
    return;  // the destructor removes the old folder, which has the temporary name now
  }
  rename_new(temporary_, path_);
  temporary_.clear();
}

void write_file(const fs::path& path, std::string_view text, Existing existing) {
  OutputFile file(path, existing);
  file.write(text);
  file.commit();
}

}  // namespace vpr
