#include "base/temporary.h"

#include <cerrno>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/checksum.h"
#include "base/error.h"

namespace vpr {
namespace {

namespace fs = std::filesystem;

constexpr const char* kAside = ".vpr-old";
constexpr size_t kMostFlushed = 256;  // files one by one; of more, the whole file system at once

// Closed when it goes out of scope.
struct Descriptor {
  explicit Descriptor(int number) : value(number) {}
  ~Descriptor() {
    if (value >= 0) ::close(value);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int value;
};

// What the names of all temporaries of a target have in common, and of no other target in the same
// folder.
std::string name_start(const fs::path& target) {
  const std::string sum = checksum(target.filename().string());
  return fmt::format(".vpr-partial-{}-", sum.substr(sum.size() - 16));
}

uint64_t random_number(const fs::path& target) {
  uint64_t number = 0;
  while (::getrandom(&number, sizeof(number), 0) != static_cast<ssize_t>(sizeof(number)))
    if (errno != EINTR) fail_to_write(target, errno);
  return number;
}

bool lock(int descriptor, int how) {
  int result = ::flock(descriptor, how);
  while (result != 0 && errno == EINTR) result = ::flock(descriptor, how);
  return result == 0;
}

// Whether somebody holds a lock on what a name leads to, or that can't be known.
bool is_in_use(const fs::path& path) {
  const Descriptor found(::open(path.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC));
  if (found.value < 0) return errno != ENOENT;
  return !lock(found.value, LOCK_EX | LOCK_NB);
}

// The lock is held meanwhile: whoever has just made such a name waits for it, and looks again.
void remove_dead(const fs::path& path) {
  const Descriptor left(::open(path.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC));
  if (left.value < 0 || !lock(left.value, LOCK_EX | LOCK_NB)) return;
  std::error_code ignored;
  fs::remove_all(path, ignored);
}

// Everything beside a target whose name begins so.
std::vector<fs::path> names_beside(const fs::path& target, const std::string& start) {
  std::vector<fs::path> names;
  std::error_code error;
  for (fs::directory_iterator entry(folder_of(target), error), end; !error && entry != end;
       entry.increment(error))
    if (entry->path().filename().string().starts_with(start)) names.push_back(entry->path());
  return names;
}

int create(const fs::path& path, Temporary::Kind kind) {
  if (kind == Temporary::Kind::file)
    return ::open(path.c_str(), O_RDWR | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
  if (::mkdir(path.c_str(), 0777) != 0) return -1;
  const int folder = ::open(path.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
  if (folder < 0) ::rmdir(path.c_str());
  return folder;
}

// Whether a name leads to an open file: nobody took it for a dead one before it was locked.
bool is_still(const fs::path& path, int descriptor) {
  struct stat named {};
  struct stat opened {};
  return ::lstat(path.c_str(), &named) == 0 && ::fstat(descriptor, &opened) == 0 &&
         named.st_dev == opened.st_dev && named.st_ino == opened.st_ino;
}

// Some file systems can't flush a folder; then there is nothing to be done about it.
void flush(int descriptor, const fs::path& target) {
  int result = ::fsync(descriptor);
  while (result != 0 && errno == EINTR) result = ::fsync(descriptor);
  if (result != 0 && errno != EINVAL && errno != ENOSYS && errno != EROFS)
    fail_to_write(target, errno);
}

void flush_path(const fs::path& path, int flags, const fs::path& target) {
  const Descriptor opened(::open(path.c_str(), flags | O_RDONLY | O_NOFOLLOW | O_CLOEXEC));
  if (opened.value < 0) fail_to_write(target, errno);
  flush(opened.value, target);
}

void flush_tree(const fs::path& folder, int descriptor, const fs::path& target) {
  std::vector<fs::path> files;
  std::vector<fs::path> folders;
  std::error_code error;
  for (fs::recursive_directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error))
    (entry->is_directory(error) ? folders : files).push_back(entry->path());
  if (error) fail_to_write(target, error.value());
  if (files.size() + folders.size() > kMostFlushed) {
    if (::syncfs(descriptor) != 0) fail_to_write(target, errno);
    return;
  }
  for (const fs::path& file : files) flush_path(file, 0, target);
  for (const fs::path& inner : folders) flush_path(inner, O_DIRECTORY, target);
  flush(descriptor, target);
}

}  // namespace

void fail_to_write(const fs::path& target, int error_number) {
  throw Error(ErrorKind::output, fmt::format("{}: can't be written: {}", target.string(),
                                             system_error_text(error_number)));
}

fs::path folder_of(const fs::path& path) {
  return path.has_parent_path() ? path.parent_path() : fs::path(".");
}

void flush_folder(const fs::path& folder, const fs::path& target) {
  const Descriptor opened(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (opened.value < 0 && errno == EACCES) return;  // writable, but not readable
  if (opened.value < 0) fail_to_write(target, errno);
  flush(opened.value, target);
}

fs::path name_aside(const fs::path& temporary) {
  return temporary.parent_path() / (kAside + temporary.filename().string());
}

void clean_up(const fs::path& target) {
  std::error_code ignored;
  const std::string start = name_start(target);
  for (const fs::path& temporary : names_beside(target, start)) remove_dead(temporary);
  for (const fs::path& old : names_beside(target, kAside + start)) {
    const fs::path temporary =
        old.parent_path() / old.filename().string().substr(std::string_view(kAside).size());
    if (is_in_use(temporary) || is_in_use(target)) continue;
    if (fs::exists(fs::symlink_status(target, ignored)))
      fs::remove_all(old, ignored);
    else
      fs::rename(old, target, ignored);
  }
}

Temporary::Temporary(const fs::path& target, Kind kind) : target_(target), kind_(kind) {
  while (true) {
    path_ =
        target.parent_path() / fmt::format("{}{:016x}", name_start(target), random_number(target));
    descriptor_ = create(path_, kind);
    if (descriptor_ < 0 && errno == EEXIST) continue;
    if (descriptor_ < 0) fail_to_write(target, errno);
    lock(descriptor_, LOCK_EX);
    if (is_still(path_, descriptor_)) return;
    ::close(descriptor_);
  }
}

Temporary::Temporary(Temporary&& other) noexcept
    : target_(std::move(other.target_)),
      path_(std::move(other.path_)),
      kind_(other.kind_),
      descriptor_(std::exchange(other.descriptor_, -1)),
      is_ours_(std::exchange(other.is_ours_, false)) {}

Temporary::~Temporary() {
  std::error_code ignored;
  if (is_ours_) fs::remove_all(path_, ignored);
  if (descriptor_ >= 0) ::close(descriptor_);
}

void Temporary::flush() const {
  if (kind_ == Kind::folder)
    flush_tree(path_, descriptor_, target_);
  else
    vpr::flush(descriptor_, target_);
}

}  // namespace vpr
