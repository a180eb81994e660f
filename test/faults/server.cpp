// Runs a program's main once per request, in a child of the process that has loaded its libraries:
// loading takes most of the time of a short run.
#include <cerrno>
#include <cstdlib>
#include <vector>

#include <dlfcn.h>
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include "faults.h"

namespace faults {
namespace {

using Main = int (*)(int, char**, char**);

constexpr int kRequests = STDIN_FILENO;
constexpr int kAnswers = STDOUT_FILENO;
constexpr size_t kWords = 7;              // strings of a request before the command line
constexpr unsigned int kMaxSeconds = 60;  // of a run whose calls count

Main program_main = nullptr;  // NOLINT

bool read_all(int file, void* bytes, size_t size) {
  auto* at = static_cast<char*>(bytes);
  while (size > 0) {
    const ssize_t got = ::read(file, at, size);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return false;
    at += got;
    size -= static_cast<size_t>(got);
  }
  return true;
}

void write_all(int file, const void* bytes, size_t size) {
  const auto* at = static_cast<const char*>(bytes);
  while (size > 0) {
    const ssize_t written = ::write(file, at, size);
    if (written <= 0) ::_exit(1);
    at += written;
    size -= static_cast<size_t>(written);
  }
}

/// A request: its size in 4 bytes, then zero-terminated strings: working folder, files for stdout
/// and stderr, folder whose calls count (or empty), fault (its index in the enum), number of the
/// call, whether renames are plain (0 or 1), and the command line.
bool read_request(std::vector<std::string>& texts) {
  uint32_t size = 0;
  if (!read_all(kRequests, &size, sizeof(size))) return false;
  std::string bytes(size, '\0');
  if (!read_all(kRequests, bytes.data(), size)) return false;
  texts.clear();
  for (size_t at = 0; at < bytes.size(); at += texts.back().size() + 1)
    texts.emplace_back(bytes.c_str() + at);
  return texts.size() > kWords;
}

void redirect(int stream, const char* path, int flags) {
  const int file = ::open(path, flags, 0666);
  if (file < 0) ::_exit(99);
  ::dup2(file, stream);
  ::close(file);
}

/// Runs in the child.
[[noreturn]] void run(std::vector<std::string>& texts, char** environment, Notes& notes) {
  if (::chdir(texts[0].c_str()) != 0) ::_exit(99);
  redirect(STDIN_FILENO, "/dev/null", O_RDONLY);
  redirect(STDOUT_FILENO, texts[1].c_str(), O_WRONLY | O_CREAT | O_TRUNC);
  redirect(STDERR_FILENO, texts[2].c_str(), O_WRONLY | O_CREAT | O_TRUNC);
  std::vector<char*> arguments;
  for (size_t i = kWords; i < texts.size(); ++i) arguments.push_back(texts[i].data());
  arguments.push_back(nullptr);
  if (!texts[3].empty()) {
    ::alarm(kMaxSeconds);
    arm({texts[3], static_cast<Fault>(std::stoi(texts[4])), std::stoull(texts[5]), texts[6] == "1"},
        notes);
  }
  std::exit(program_main(static_cast<int>(arguments.size() - 1), arguments.data(), environment));
}

/// An answer: the status of waitpid, the size of the notes, and the notes.
int serve(int, char**, char** environment) {
  // Child programs and their messages are those of an ordinary run.
  for (const char* name : {"LD_PRELOAD", "LD_BIND_NOW", "VPR_SERVED"}) ::unsetenv(name);
  void* const shared =
      ::mmap(nullptr, sizeof(Notes), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (shared == MAP_FAILED) return 1;
  Notes& notes = *static_cast<Notes*>(shared);
  std::vector<std::string> texts;
  while (read_request(texts)) {
    notes.bytes = 0;
    const pid_t child = ::fork();
    if (child < 0) return 1;
    if (child == 0) run(texts, environment, notes);
    int32_t status = 0;
    while (::waitpid(child, &status, 0) < 0)
      if (errno != EINTR) return 1;
    const auto bytes = static_cast<uint32_t>(notes.bytes);
    write_all(kAnswers, &status, sizeof(status));
    write_all(kAnswers, &bytes, sizeof(bytes));
    write_all(kAnswers, notes.text, bytes);
  }
  return 0;
}

}  // namespace
}  // namespace faults

/// Replaces the C library's function that calls main.
extern "C" int __libc_start_main(faults::Main main, int argc, char** argv,
                                 void (*init)(),  // NOLINT
                                 void (*fini)(), void (*rtld_fini)(), void* stack_end) {
  static const auto next =
      reinterpret_cast<decltype(&__libc_start_main)>(::dlsym(RTLD_NEXT, "__libc_start_main"));
  faults::program_main = main;
  return next(std::getenv("VPR_SERVED") != nullptr ? faults::serve : main, argc, argv, init, fini,
              rtld_fini, stack_end);
}
