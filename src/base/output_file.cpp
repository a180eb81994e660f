#include "base/output_file.h"

#include <algorithm>
#include <cerrno>
#include <set>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/error.h"
#include "base/mapped_file.h"
#include "base/text.h"

namespace vpr {
namespace {

namespace fs = std::filesystem;

constexpr const char* kMark = ".vpr-files";

fs::path without_trailing_slash(const fs::path& path) {
  return path.has_filename() ? path : path.parent_path();
}

void check_parent(const fs::path& path) {
  std::error_code error;
  if (!fs::is_directory(folder_of(path), error))
    throw Error(ErrorKind::output, fmt::format("{}: can't be written: its folder {} does not exist",
                                               path.string(), folder_of(path).string()));
}

// What stands under a name, a link itself. Throws Error(output) for a name that can't be one.
fs::file_status status_of(const fs::path& path) {
  std::error_code error;
  const fs::file_status status = fs::symlink_status(path, error);
  if (status.type() == fs::file_type::none) fail_to_write(path, error.value());
  return status;
}

void write_all(int file, std::span<const std::byte> bytes, const fs::path& path) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(file, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail_to_write(path, errno);
    bytes = bytes.subspan(static_cast<size_t>(written));
  }
}

std::string file_names(const fs::path& folder) {
  std::set<std::string> names;
  for (const fs::directory_entry& entry : entries_of(folder))
    names.insert(entry.path().filename().string());
  std::string text;
  for (const std::string& name : names) text += name + "\n";
  return text;
}

}  // namespace

void check_output_file(const fs::path& path, Existing existing) {
  check_parent(path);
  std::error_code error;
  const fs::file_status status = status_of(path);
  if (fs::is_directory(fs::status(path, error)))
    throw Error(
        ErrorKind::usage,
        fmt::format("{}: is a folder, but the output is a file; give a file name", path.string()));
  if (fs::exists(status) && existing == Existing::refuse) refuse_existing(path);
  if (fs::exists(status) && !fs::is_regular_file(status))
    throw Error(ErrorKind::usage,
                fmt::format("{}: is not replaced, because it is no regular file", path.string()));
}

OutputFile::OutputFile(const fs::path& path, Existing existing)
    : pending_(path, existing, Temporary::Kind::file,
               [path, existing] { check_output_file(path, existing); }) {}

void OutputFile::write(std::span<const std::byte> bytes) {
  write_all(pending_.temporary().descriptor(), bytes, path());
}

void OutputFile::write(std::string_view text) { write(std::as_bytes(std::span(text))); }

void OutputFile::reserve(uint64_t size) {
  if (size == 0) return;
  int error_number = EINTR;
  while (error_number == EINTR)
    error_number =
        ::posix_fallocate(pending_.temporary().descriptor(), 0, static_cast<off_t>(size));
  if (error_number != 0) fail_to_write(path(), error_number);
}

void OutputFile::write_at(uint64_t offset, std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::pwrite(pending_.temporary().descriptor(), bytes.data(), bytes.size(),
                                     static_cast<off_t>(offset));
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail_to_write(path(), errno);
    offset += static_cast<uint64_t>(written);
    bytes = bytes.subspan(static_cast<size_t>(written));
  }
}

void OutputFile::commit() {
  PendingOutput* const all[] = {&pending_};
  commit_together(all);
}

std::vector<fs::directory_entry> entries_of(const fs::path& folder) {
  std::vector<fs::directory_entry> entries;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error))
    entries.push_back(*entry);
  if (error)
    throw Error(ErrorKind::output, fmt::format("{}: can't be read: {}", folder.string(),
                                               system_error_text(error.value())));
  return entries;
}

bool holds_only_files(const fs::path& folder,
                      const std::function<bool(const std::string& name)>& is_ours) {
  const auto entries = entries_of(folder);
  return std::all_of(entries.begin(), entries.end(), [&](const fs::directory_entry& entry) {
    std::error_code error;
    return entry.is_regular_file(error) && !entry.is_symlink(error) &&
           is_ours(entry.path().filename().string());
  });
}

bool is_marked_folder(const fs::path& folder) {
  std::error_code error;
  if (!fs::is_regular_file(fs::symlink_status(folder / kMark, error))) return false;
  const MappedFile mark(folder / kMark);
  std::set<std::string> names = {kMark};
  for (const std::string_view name : split(mark.text(), '\n')) names.emplace(name);
  return holds_only_files(folder, [&](const std::string& name) { return names.contains(name); });
}

void check_output_folder(const fs::path& given, Existing existing, FolderCheck is_ours) {
  const fs::path path = without_trailing_slash(given);
  check_parent(path);
  const fs::file_status status = status_of(path);
  if (!fs::exists(status)) return;
  if (existing == Existing::refuse) refuse_existing(path);
  if (!fs::is_directory(status) || !(entries_of(path).empty() || is_ours(path)))
    throw Error(ErrorKind::usage,
                fmt::format("{}: is not replaced, because it is not, or not only, an output of "
                            "this program; give another name",
                            path.string()));
}

OutputFolder::OutputFolder(const fs::path& path, Existing existing, FolderCheck is_ours)
    : is_ours_(is_ours),
      pending_(without_trailing_slash(path), existing, Temporary::Kind::folder,
               [path, existing, is_ours] { check_output_folder(path, existing, is_ours); }) {}

void OutputFolder::complete() {
  if (is_ours_ == is_marked_folder) write_part(temporary() / kMark, file_names(temporary()));
}

void OutputFolder::commit() {
  complete();
  PendingOutput* const all[] = {&pending_};
  commit_together(all);
}

void write_part(const fs::path& path, std::initializer_list<std::span<const std::byte>> parts) {
  const int file = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
  if (file < 0) fail_to_write(path, errno);
  try {
    for (const auto& part : parts) write_all(file, part, path);
  } catch (const Error&) {
    ::close(file);
    throw;
  }
  if (::close(file) != 0) fail_to_write(path, errno);
}

void write_part(const fs::path& path, std::string_view text) {
  write_part(path, {std::as_bytes(std::span(text))});
}

void make_part_folder(const fs::path& path) {
  if (::mkdir(path.c_str(), 0777) != 0) fail_to_write(path, errno);
}

}  // namespace vpr
