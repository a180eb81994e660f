// The file calls of the C library, each of which may fail as planned.
#include <array>
#include <atomic>
#include <cerrno>
#include <climits>
#include <csignal>
#include <cstdarg>
#include <cstdio>
#include <cstring>
#include <mutex>

#include <dirent.h>
#include <dlfcn.h>
#include <fcntl.h>
#include <sys/ioctl.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <unistd.h>

#include "faults.h"

namespace faults {
namespace {

constexpr int kMaxFiles = 1024;
constexpr unsigned long kShutDown = 0x8004587d;  // FS_IOC_SHUTDOWN

struct State {
  Plan plan;
  Notes* notes = nullptr;  ///< null: not armed
  std::string absolute;    ///< the folder
  int folder = -1;         ///< an open descriptor, to shut down its file system
  std::atomic<uint64_t> calls{0};
  std::array<std::atomic<bool>, kMaxFiles> is_below{};  ///< open files in the folder
  std::mutex mutex;
} state;  // NOLINT

bool starts_with_folder(const std::string& path, const std::string& folder) {
  return path.compare(0, folder.size(), folder) == 0 &&
         (path.size() == folder.size() || path[folder.size()] == '/');
}

bool is_below(int file) { return file >= 0 && file < kMaxFiles && state.is_below[file]; }

bool is_below(int folder, const char* path) {
  if (state.notes == nullptr || path == nullptr) return false;
  if (path[0] != '/' && folder != AT_FDCWD) return is_below(folder);
  const std::string text = std::strncmp(path, "./", 2) == 0 ? path + 2 : path;
  return starts_with_folder(text, state.plan.folder) || starts_with_folder(text, state.absolute);
}

int opened(int file, bool below) {
  if (file >= 0 && file < kMaxFiles) state.is_below[file] = below;
  return file;
}

void note(const char* name, const char* path, bool fails) {
  const std::lock_guard lock(state.mutex);
  Notes& notes = *state.notes;
  const int size = std::snprintf(notes.text + notes.bytes, Notes::kMaxBytes - notes.bytes,
                                 "%s%c%s\n", name, fails ? '!' : ' ', path);
  if (size > 0 && notes.bytes + size < Notes::kMaxBytes) notes.bytes += size;
}

void end_file_system(unsigned int how) {
  ::ioctl(state.folder, kShutDown, &how);
  ::kill(::getpid(), SIGKILL);
}

enum class Effect { none, fails, halves };

/// Counts a call on a file in the folder and applies the plan.
Effect meet(const char* name, const char* path, bool takes_space) {
  const uint64_t number = ++state.calls;
  const Plan& plan = state.plan;
  const bool is_first = number == plan.number;
  const bool is_later = plan.number > 0 && number > plan.number;
  const auto fails = [&](int error_number) {
    note(name, path, true);
    errno = error_number;
    return Effect::fails;
  };
  if (is_later && plan.fault == Fault::dead) return fails(EIO);
  if (is_later && plan.fault == Fault::enospc && takes_space) return fails(ENOSPC);
  note(name, path, false);
  if (!is_first) return Effect::none;
  switch (plan.fault) {
    case Fault::kill:
      ::kill(::getpid(), SIGKILL);
      break;
    case Fault::interrupt:
      ::kill(::getpid(), SIGINT);
      break;
    case Fault::power:
      end_file_system(1);
      break;
    case Fault::power_off:
      end_file_system(2);
      break;
    case Fault::eintr:
      return fails(EINTR);
    case Fault::eio:
    case Fault::dead:
      return fails(EIO);
    case Fault::enospc:
      return fails(ENOSPC);
    case Fault::torn:
    case Fault::shorten:
      return Effect::halves;
    case Fault::none:
      break;
  }
  return Effect::none;
}

/// A call with a path: a planned error, or the result of `call`.
template <class Call>
auto at_path(const char* name, int folder, const char* path, bool takes_space, Call&& call) {
  if (is_below(folder, path) && meet(name, path, takes_space) == Effect::fails)
    return decltype(call())(-1);
  return call();
}

template <class Call>
auto at_file(const char* name, int file, bool takes_space, Call&& call) {
  if (is_below(file) && meet(name, "", takes_space) == Effect::fails) return decltype(call())(-1);
  return call();
}

/// A call that writes `size` bytes, or half of them: `write` receives their number.
template <class Write>
ssize_t at_write(const char* name, int file, size_t size, Write&& write) {
  const Effect effect = is_below(file) ? meet(name, "", true) : Effect::none;
  if (effect == Effect::fails) return -1;
  if (effect == Effect::none) return write(size);
  const ssize_t written = write((size + 1) / 2);
  if (state.plan.fault == Fault::torn) ::kill(::getpid(), SIGKILL);
  return written;
}

int open_file(int folder, const char* path, int flags, mode_t mode) {
  const bool below = is_below(folder, path);
  const char* name = (flags & O_CREAT) != 0 ? "create" : "open";
  return opened(at_path(name, folder, path, (flags & O_CREAT) != 0,
                        [&] { return int(::syscall(SYS_openat, folder, path, flags, mode)); }),
                below);
}

int rename_file(int from_folder, const char* from, int to_folder, const char* to, unsigned flags) {
  return at_path("rename", to_folder, to, false, [&] {
    if (flags != 0 && state.plan.has_flagless_renames && is_below(to_folder, to)) {
      errno = EINVAL;
      return -1;
    }
    return int(::syscall(SYS_renameat2, from_folder, from, to_folder, to, flags));
  });
}

int reserve(int file, int mode, off_t from, off_t size) {
  return at_file("fallocate", file, true,
                 [&] { return int(::syscall(SYS_fallocate, file, mode, from, size)); });
}

int remove_name(int folder, const char* path, int flags) {
  return at_path(flags == 0 ? "unlink" : "rmdir", folder, path, false,
                 [&] { return int(::syscall(SYS_unlinkat, folder, path, flags)); });
}

mode_t mode_of(int flags, va_list more) {
  return (flags & (O_CREAT | O_TMPFILE)) != 0 ? va_arg(more, mode_t) : 0;
}

}  // namespace

void arm(const Plan& plan, Notes& notes) {
  state.plan = plan;
  std::array<char, PATH_MAX> here{};
  if (::getcwd(here.data(), here.size()) != nullptr)
    state.absolute = std::string(here.data()) + "/" + plan.folder;
  state.folder = static_cast<int>(
      ::syscall(SYS_openat, AT_FDCWD, plan.folder.c_str(), O_RDONLY | O_CLOEXEC, 0));
  state.notes = &notes;
}

}  // namespace faults

using namespace faults;  // NOLINT

extern "C" {

int open(const char* path, int flags, ...) {
  va_list more;
  va_start(more, flags);
  const mode_t mode = mode_of(flags, more);
  va_end(more);
  return open_file(AT_FDCWD, path, flags, mode);
}

int openat(int folder, const char* path, int flags, ...) {
  va_list more;
  va_start(more, flags);
  const mode_t mode = mode_of(flags, more);
  va_end(more);
  return open_file(folder, path, flags, mode);
}

int open64(const char* path, int flags, ...) __attribute__((alias("open")));
int openat64(int folder, const char* path, int flags, ...) __attribute__((alias("openat")));

// The C library opens these by internal calls.
FILE* fopen(const char* path, const char* mode) {
  static const auto next = reinterpret_cast<decltype(&fopen)>(::dlsym(RTLD_NEXT, "fopen"));
  const bool creates = std::strpbrk(mode, "wa") != nullptr;
  if (is_below(AT_FDCWD, path) && meet("fopen", path, creates) == Effect::fails) return nullptr;
  return next(path, mode);
}

FILE* fopen64(const char* path, const char* mode) __attribute__((alias("fopen")));

DIR* opendir(const char* path) {
  static const auto next = reinterpret_cast<decltype(&opendir)>(::dlsym(RTLD_NEXT, "opendir"));
  if (is_below(AT_FDCWD, path) && meet("opendir", path, false) == Effect::fails) return nullptr;
  return next(path);
}

int close(int file) {
  const bool fails = is_below(file) && meet("close", "", false) == Effect::fails;
  opened(file, false);
  const int error_number = errno;
  const int result = static_cast<int>(::syscall(SYS_close, file));  // closed in any case
  if (fails) errno = error_number;
  return fails ? -1 : result;
}

ssize_t write(int file, const void* bytes, size_t size) {
  return at_write("write", file, size,
                  [&](size_t some) { return ::syscall(SYS_write, file, bytes, some); });
}

ssize_t pwrite(int file, const void* bytes, size_t size, off_t from) {
  return at_write("pwrite", file, size,
                  [&](size_t some) { return ::syscall(SYS_pwrite64, file, bytes, some, from); });
}

ssize_t pwrite64(int file, const void* bytes, size_t size, off64_t from)
    __attribute__((alias("pwrite")));

ssize_t writev(int file, const iovec* parts, int count) {
  return at_write("writev", file, size_t(count), [&](size_t some) {
    return ::syscall(SYS_writev, file, parts, some);  // half of the parts
  });
}

int fsync(int file) {
  return at_file("fsync", file, true, [&] { return int(::syscall(SYS_fsync, file)); });
}

int fdatasync(int file) {
  return at_file("fdatasync", file, true, [&] { return int(::syscall(SYS_fdatasync, file)); });
}

int syncfs(int file) noexcept {
  return at_file("syncfs", file, true, [&] { return int(::syscall(SYS_syncfs, file)); });
}

int flock(int file, int how) noexcept {
  return at_file("flock", file, false, [&] { return int(::syscall(SYS_flock, file, how)); });
}

int ftruncate(int file, off_t size) noexcept {
  return at_file("ftruncate", file, true,
                 [&] { return int(::syscall(SYS_ftruncate, file, size)); });
}

int ftruncate64(int file, off64_t size) noexcept __attribute__((alias("ftruncate")));

int fallocate(int file, int mode, off_t from, off_t size) {
  return reserve(file, mode, from, size);
}
int fallocate64(int file, int mode, off64_t from, off64_t size) __attribute__((alias("fallocate")));

int posix_fallocate(int file, off_t from, off_t size) {
  return reserve(file, 0, from, size) == 0 ? 0 : errno;
}

int posix_fallocate64(int file, off64_t from, off64_t size)
    __attribute__((alias("posix_fallocate")));

int mkdir(const char* path, mode_t mode) noexcept {
  return at_path("mkdir", AT_FDCWD, path, true,
                 [&] { return int(::syscall(SYS_mkdirat, AT_FDCWD, path, mode)); });
}

int mkdirat(int folder, const char* path, mode_t mode) noexcept {
  return at_path("mkdir", folder, path, true,
                 [&] { return int(::syscall(SYS_mkdirat, folder, path, mode)); });
}

int rename(const char* from, const char* to) noexcept {
  return rename_file(AT_FDCWD, from, AT_FDCWD, to, 0);
}

int renameat(int from_folder, const char* from, int to_folder, const char* to) noexcept {
  return rename_file(from_folder, from, to_folder, to, 0);
}

int renameat2(int from_folder, const char* from, int to_folder, const char* to,
              unsigned int flags) noexcept {
  return rename_file(from_folder, from, to_folder, to, flags);
}

int unlink(const char* path) noexcept { return remove_name(AT_FDCWD, path, 0); }
int rmdir(const char* path) noexcept { return remove_name(AT_FDCWD, path, AT_REMOVEDIR); }
int unlinkat(int folder, const char* path, int flags) noexcept {
  return remove_name(folder, path, flags);
}

int remove(const char* path) noexcept {
  const int result = remove_name(AT_FDCWD, path, 0);
  return result != 0 && (errno == EISDIR || errno == EPERM)
             ? remove_name(AT_FDCWD, path, AT_REMOVEDIR)
             : result;
}

int symlink(const char* from, const char* to) noexcept {
  return at_path("symlink", AT_FDCWD, to, true,
                 [&] { return int(::syscall(SYS_symlinkat, from, AT_FDCWD, to)); });
}

int link(const char* from, const char* to) noexcept {
  return at_path("link", AT_FDCWD, to, true,
                 [&] { return int(::syscall(SYS_linkat, AT_FDCWD, from, AT_FDCWD, to, 0)); });
}

}  // extern "C"
