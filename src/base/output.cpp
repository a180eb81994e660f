#include "base/output.h"

#include <algorithm>
#include <cassert>
#include <cerrno>
#include <cstdio>
#include <mutex>
#include <optional>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/checksum.h"
#include "base/error.h"
#include "base/mapped_file.h"
#include "base/text.h"

namespace vpr {
namespace {

namespace fs = std::filesystem;

constexpr const char* kMark = ".vpr-files";
constexpr const char* kAside = ".vpr-old";
// files flushed one by one; with more, flush the whole file system
constexpr size_t kMaxFlushed = 256;

[[noreturn]] void fail_to_write(const fs::path& target, int error_number) {
  throw Error(ErrorKind::output, "{}: can't be written: {}", target.string(),
              system_error_text(error_number));
}

constexpr std::string_view kExists =
    "exists already; use --force to replace it, or choose another name";

[[noreturn]] void refuse(const fs::path& path, std::string_view why) {
  throw Error(ErrorKind::usage, "{}: {}", path.string(), why);
}

// Repeats a call that a signal interrupted.
template <class Call>
auto retried(Call&& call) {
  auto result = call();
  while (result < 0 && errno == EINTR) result = call();
  return result;
}

struct Descriptor {
  explicit Descriptor(int number) : value(number) {}
  ~Descriptor() {
    if (value >= 0) ::close(value);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  bool lock(int how) const {
    return retried([&] { return ::flock(value, how); }) == 0;
  }
  int value;
};

fs::path folder_of(const fs::path& path) {
  return path.has_parent_path() ? path.parent_path() : fs::path(".");
}

fs::path without_trailing_slash(const fs::path& path) {
  return path.has_filename() ? path : path.parent_path();
}

bool has_entry(const fs::path& path) {
  std::error_code ignored;
  return fs::exists(fs::symlink_status(path, ignored));
}

// The prefix of all temporaries of this target, and of no other target in the folder. Short for any
// length of the target's name.
std::string name_start(const fs::path& target) {
  const std::string sum = checksum(target.filename().string());
  return fmt::format(".vpr-partial-{}-", sum.substr(sum.size() - 16));
}

// Removes the unlocked temporaries that killed processes left, and restores a folder that one of
// them had renamed. Holds the lock during the removal: a process that has just created the same
// name waits for it.
void clean_up(const fs::path& target) {
  const std::string start = name_start(target);
  std::error_code error;
  for (fs::directory_iterator it(folder_of(target), error), end; !error && it != end;
       it.increment(error)) {
    const std::string name = it->path().filename().string();
    const bool is_aside = name.starts_with(kAside + start);
    if (!is_aside && !name.starts_with(start)) continue;
    // A process that renames a folder holds the lock on its parent.
    const fs::path locked = is_aside ? folder_of(target) : it->path();
    const Descriptor left(
        ::open(locked.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC | (is_aside ? 0 : O_NOFOLLOW)));
    if (left.value < 0 || !left.lock(LOCK_EX | LOCK_NB)) continue;
    std::error_code ignored;
    if (is_aside && !has_entry(target))
      fs::rename(it->path(), target, ignored);
    else
      fs::remove_all(it->path(), ignored);
  }
}

// Some file systems cannot flush a folder.
void flush_descriptor(int descriptor, const fs::path& target) {
  if (retried([&] { return ::fsync(descriptor); }) != 0 && errno != EINVAL && errno != ENOSYS &&
      errno != EROFS)
    fail_to_write(target, errno);
}

void flush_path(const fs::path& path, const fs::path& target) {
  const Descriptor opened(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (opened.value < 0 && errno == EACCES && fs::is_directory(path)) return;  // write-only folder
  if (opened.value < 0) fail_to_write(target, errno);
  flush_descriptor(opened.value, target);
}

void flush_inside(const fs::path& folder, int descriptor, const fs::path& target) {
  std::vector<fs::path> paths;
  std::error_code error;
  for (fs::recursive_directory_iterator it(folder, error), end; !error && it != end;
       it.increment(error))
    paths.push_back(it->path());
  if (error) fail_to_write(target, error.value());
  if (paths.size() > kMaxFlushed) {
    if (::syncfs(descriptor) != 0) fail_to_write(target, errno);
    return;
  }
  for (const fs::path& path : paths) flush_path(path, target);
}

// Whether the file system does not support the rename flags.
bool lacks_flags(int error_number) {
  return error_number == EINVAL || error_number == ENOSYS || error_number == ENOTSUP;
}

// Renames to a name that must not exist.
void rename_new(const fs::path& from, const fs::path& to) {
  int result = ::renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), RENAME_NOREPLACE);
  if (result != 0 && lacks_flags(errno)) {
    errno = EEXIST;
    if (!has_entry(to)) result = ::rename(from.c_str(), to.c_str());
  }
  if (result != 0 && errno == EEXIST) refuse(to, kExists);
  if (result != 0) fail_to_write(to, errno);
}

// Exchanges a folder with the old one, which is then removed with the temporary. If the file system
// cannot exchange them in one step, the target does not exist for a moment; clean_up restores it if
// the process is killed then.
void replace_folder(const fs::path& temporary, const fs::path& target) {
  if (::renameat2(AT_FDCWD, temporary.c_str(), AT_FDCWD, target.c_str(), RENAME_EXCHANGE) == 0)
    return;
  if (!lacks_flags(errno)) fail_to_write(target, errno);
  const fs::path old = folder_of(target) / (kAside + temporary.filename().string());
  if (::rename(target.c_str(), old.c_str()) != 0) fail_to_write(target, errno);
  if (::rename(temporary.c_str(), target.c_str()) != 0) {
    const int error_number = errno;
    if (::rename(old.c_str(), target.c_str()) == 0) fail_to_write(target, error_number);
    throw Error(ErrorKind::output, "{}: can't be written: {}; the old folder is {}",
                target.string(), system_error_text(error_number), old.string());
  }
  std::error_code ignored;
  fs::remove_all(old, ignored);
}

void write_all(int file, std::span<const std::byte> bytes, const fs::path& path) {
  while (!bytes.empty()) {
    const ssize_t written = retried([&] { return ::write(file, bytes.data(), bytes.size()); });
    if (written < 0) fail_to_write(path, errno);
    bytes = bytes.subspan(static_cast<size_t>(written));
  }
}

std::optional<std::pair<uint64_t, uint64_t>> identity_of(const fs::path& path) {
  struct stat found {};
  if (::stat(path.c_str(), &found) != 0) return std::nullopt;
  return std::pair<uint64_t, uint64_t>(found.st_dev, found.st_ino);
}

/// The temporaries of all outputs that are not complete.
struct Temporaries {
  std::mutex mutex;
  std::set<fs::path> paths;
};

Temporaries& temporaries() {
  static Temporaries all;
  return all;
}

}  // namespace

void remove_temporaries() {
  const std::unique_lock lock(temporaries().mutex, std::try_to_lock);
  std::error_code ignored;
  if (lock)
    for (const fs::path& path : temporaries().paths) fs::remove_all(path, ignored);
}

std::vector<fs::directory_entry> entries_of(const fs::path& folder, ErrorKind kind) {
  std::vector<fs::directory_entry> entries;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error))
    entries.push_back(*it);
  if (error)
    throw Error(kind, "{}: can't be read: {}", folder.string(), system_error_text(error.value()));
  return entries;
}

bool holds_only_files(const fs::path& folder,
                      const std::function<bool(const std::string& name)>& is_ours) {
  const auto entries = entries_of(folder);
  return std::ranges::all_of(entries, [&](const fs::directory_entry& entry) {
    std::error_code error;
    return entry.is_regular_file(error) && !entry.is_symlink(error) &&
           is_ours(entry.path().filename().string());
  });
}

bool is_marked_folder(const fs::path& folder) {
  std::error_code error;
  if (!fs::is_regular_file(fs::symlink_status(folder / kMark, error))) return false;
  const std::string mark = read_whole_file(folder / kMark);
  std::set<std::string> names = {kMark};
  for (const std::string_view name : split(mark, '\n')) names.emplace(name);
  return holds_only_files(folder, [&](const std::string& name) { return names.contains(name); });
}

void write_part(const fs::path& path, std::initializer_list<std::span<const std::byte>> parts) {
  const Descriptor file(
      ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666));
  if (file.value < 0) fail_to_write(path, errno);
  for (const auto& part : parts) write_all(file.value, part, path);
}

void write_part(const fs::path& path, std::string_view text) {
  write_part(path, {std::as_bytes(std::span(text))});
}

void make_part_folder(const fs::path& path) {
  if (::mkdir(path.c_str(), 0777) != 0) fail_to_write(path, errno);
}

Output::Output(const fs::path& target, Existing existing, FolderCheck is_ours)
    : target_(is_ours == nullptr ? target : without_trailing_slash(target)),
      existing_(existing),
      is_ours_(is_ours) {
  clean_up(target_);
  check();
  for (;;) {
    uint64_t number = 0;
    if (retried([&] { return ::getrandom(&number, sizeof(number), 0); }) < 0)
      fail_to_write(target_, errno);
    temporary_ = target_.parent_path() / fmt::format("{}{:016x}", name_start(target_), number);
    if (is_folder() && ::mkdir(temporary_.c_str(), 0777) != 0) {
      if (errno == EEXIST) continue;
      fail_to_write(target_, errno);
    }
    descriptor_ = ::open(
        temporary_.c_str(),
        O_NOFOLLOW | O_CLOEXEC | (is_folder() ? O_RDONLY | O_DIRECTORY : O_RDWR | O_CREAT | O_EXCL),
        0666);
    if (descriptor_ < 0) {
      const int error_number = errno;
      if (is_folder()) ::rmdir(temporary_.c_str());
      // Another process may have removed the folder as abandoned before it was opened.
      const bool was_removed =
          error_number == ENOENT && is_folder() && fs::is_directory(folder_of(target_));
      if (error_number == EEXIST || was_removed) continue;
      fail_to_write(target_, error_number);
    }
    retried([&] { return ::flock(descriptor_, LOCK_EX); });
    // Another process may have removed it as abandoned before it was locked.
    struct stat opened {};
    ::fstat(descriptor_, &opened);
    if (identity_of(temporary_) == std::pair<uint64_t, uint64_t>(opened.st_dev, opened.st_ino)) {
      const std::scoped_lock lock(temporaries().mutex);
      temporaries().paths.insert(temporary_);
      return;
    }
    ::close(descriptor_);
  }
}

Output::~Output() {
  std::error_code ignored;
  {
    const std::scoped_lock lock(temporaries().mutex);
    temporaries().paths.erase(temporary_);
  }
  ::close(descriptor_);  // the removal of a folder needs one itself
  if (!is_placed_) fs::remove_all(temporary_, ignored);
}

void Output::check() const {
  std::error_code error;
  if (!fs::is_directory(folder_of(target_), error))
    throw Error(ErrorKind::output, "{}: can't be written: its folder {} does not exist",
                target_.string(), folder_of(target_).string());
  const fs::file_status status = fs::symlink_status(target_, error);
  if (status.type() == fs::file_type::none) fail_to_write(target_, error.value());
  if (!is_folder() && fs::is_directory(fs::status(target_, error)))
    refuse(target_, "is a folder, but the output is a file; use a file name");
  if (!fs::exists(status)) return;
  if (existing_ == Existing::refuse) refuse(target_, kExists);
  if (!is_folder() && !fs::is_regular_file(status))
    refuse(target_, "is not replaced, because it is not a regular file");
  if (is_folder() &&
      (!fs::is_directory(status) || !(entries_of(target_).empty() || is_ours_(target_))))
    refuse(target_,
           "is not replaced, because it holds more than an output of this program; choose "
           "another name");
}

void Output::write(std::span<const std::byte> bytes) { write_all(descriptor_, bytes, target_); }

void Output::reserve(uint64_t size) {
  if (size == 0) return;
  int error_number = EINTR;
  while (error_number == EINTR)
    error_number = ::posix_fallocate(descriptor_, 0, static_cast<off_t>(size));
  if (error_number != 0) fail_to_write(target_, error_number);
}

void Output::write_at(uint64_t offset, std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = retried([&] {
      return ::pwrite(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    });
    if (written < 0) fail_to_write(target_, errno);
    offset += static_cast<uint64_t>(written);
    bytes = bytes.subspan(static_cast<size_t>(written));
  }
}

void Output::flush() {
  if (is_ours_ == is_marked_folder) {
    std::set<std::string> names;
    for (const auto& entry : entries_of(temporary_)) names.insert(entry.path().filename().string());
    write_part(temporary_ / kMark, fmt::format("{}\n", fmt::join(names, "\n")));
  }
  if (is_folder()) flush_inside(temporary_, descriptor_, target_);
  flush_descriptor(descriptor_, target_);
}

void Output::place() {
  if (existing_ == Existing::replace && is_folder() && has_entry(target_)) {
    replace_folder(temporary_, target_);  // the old folder now has the temporary name
    return;
  }
  if (existing_ == Existing::refuse || is_folder())
    rename_new(temporary_, target_);
  else if (::rename(temporary_.c_str(), target_.c_str()) != 0)
    fail_to_write(target_, errno);
  is_placed_ = true;
}

void Outputs::protect(const fs::path& input) {
  const auto identity = identity_of(input);
  if (!identity) return;
  inputs_.insert(*identity);
  std::error_code error;
  fs::path folder = fs::canonical(input, error);
  while (!error && folder.has_relative_path()) {
    folder = folder.parent_path();
    const auto around = identity_of(folder);
    // its parents are protected already
    if (around && !around_inputs_.insert(*around).second) break;
  }
  for (const Claim& claim : claims_) check_protected(claim.output->path());
}

void Outputs::release(const fs::path& input) {
  if (const auto identity = identity_of(input)) {
    inputs_.erase(*identity);
    around_inputs_.erase(*identity);
  }
}

void Outputs::extend(const fs::path& input) {
  release(input);
  if (const auto identity = identity_of(input)) extended_.insert(*identity);
}

void Outputs::check_protected(const fs::path& path) const {
  const auto identity = identity_of(path);
  if (!identity) return;
  const bool is_input = inputs_.contains(*identity);
  if (is_input || around_inputs_.contains(*identity))
    refuse(path,
           fmt::format("{} an input of this run, which the output would replace; choose another "
                       "name for the output",
                       is_input ? "is" : "holds"));
}

// Paths need not exist: two paths are equal if they are the same name in the same folder.
Outputs::Claim* Outputs::find(const fs::path& path) {
  const fs::path name = without_trailing_slash(path);
  const auto folder = identity_of(folder_of(name));
  for (Claim& claim : claims_) {
    const fs::path& target = claim.output->path();
    if (target.filename() == name.filename() && folder && identity_of(folder_of(target)) == folder)
      return &claim;
  }
  return nullptr;
}

Outputs::Claim& Outputs::claim(const fs::path& path, FolderCheck is_ours) {
  if (path.empty()) throw Error(ErrorKind::usage, "the path of the output is empty");
  if (find(path) != nullptr) refuse(path, "is written twice; use a different name for each output");
  check_protected(path);
  const auto identity = identity_of(path);
  const bool is_extended = identity && extended_.contains(*identity);
  claims_.push_back(
      {std::make_unique<Output>(path, is_extended ? Existing::replace : existing_, is_ours)});
  return claims_.back();
}

Output& Outputs::folder(const fs::path& path, FolderCheck is_ours) {
  Claim* const claimed = find(path);
  Claim& found = claimed != nullptr && !claimed->is_requested ? *claimed : claim(path, is_ours);
  assert(found.output->is_folder() == (is_ours != nullptr));
  found.is_requested = true;
  return *found.output;
}

std::vector<const Output*> Outputs::files_next_to(const fs::path& main) const {
  std::vector<const Output*> files;
  const auto folder = identity_of(folder_of(main));
  for (const Claim& claim : claims_) {
    const Output& output = *claim.output;
    if (claim.is_requested && !output.is_folder() && output.path().filename() != main.filename() &&
        identity_of(folder_of(output.path())) == folder)
      files.push_back(&output);
  }
  return files;
}

std::string Outputs::with_targets(std::string sentence) const {
  for (const Claim& claim : claims_) {
    const std::string made = claim.output->temporary().string();
    for (size_t at = 0; (at = sentence.find(made, at)) != std::string::npos;)
      sentence.replace(at, made.size(), claim.output->path().string());
  }
  return sentence;
}

bool Outputs::has_outputs() const {
  return std::ranges::any_of(claims_, [](const Claim& claim) { return claim.is_requested; });
}

// Claimed files that the new outputs lack.
void Outputs::remove_replaced(const std::vector<Claim>& claims) {
  for (const auto& [output, is_requested] : claims) {
    if (is_requested || output->is_folder() || output->existing_ == Existing::refuse) continue;
    const fs::path& path = output->path();
    if (has_entry(path) && ::unlink(path.c_str()) != 0) fail_to_write(path, errno);
  }
}

void Outputs::commit() {
  std::vector<Output*> outputs;
  for (size_t i = claims_.size(); i-- > 0;)
    if (claims_[i].is_requested) outputs.push_back(claims_[i].output.get());
  for (Output* output : outputs) output->check();
  for (Output* output : outputs) output->flush();
  const auto claims = std::exchange(claims_, {});
  if (outputs.empty()) return;
  const Descriptor folder(
      ::open(folder_of(outputs.back()->path()).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  folder.lock(LOCK_EX);  // if the file system supports locks
  std::string placed;
  try {
    for (Output* output : outputs) {
      if (output == outputs.back()) remove_replaced(claims);
      output->place();
      placed += fmt::format("; {} is new", output->path().string());
    }
    std::set<fs::path> folders;
    for (const Output* output : outputs)
      if (folders.insert(folder_of(output->path())).second)
        flush_path(folder_of(output->path()), output->path());
  } catch (const Error& error) {
    throw Error(error.kind(), error.what() + placed);
  }
}

}  // namespace vpr
