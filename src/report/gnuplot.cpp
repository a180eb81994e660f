#include "report/gnuplot.h"

#include <cerrno>
#include <string_view>

#include <fcntl.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/mapped_file.h"

namespace vpr {
namespace {

namespace fs = std::filesystem;

// A file without a name that holds a text, at its start; -1 if there can't be one.
int text_file(std::string_view text) {
  const int file = ::memfd_create("gnuplot script", MFD_CLOEXEC);
  while (file >= 0 && !text.empty()) {
    const ssize_t written = ::write(file, text.data(), text.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) {
      ::close(file);
      return -1;
    }
    text.remove_prefix(static_cast<size_t>(written));
  }
  if (file >= 0) ::lseek(file, 0, SEEK_SET);
  return file;
}

int wait_for(pid_t child) {
  int status = -1;
  while (::waitpid(child, &status, 0) < 0)
    if (errno != EINTR) return -1;
  return status;
}

}  // namespace

bool run_gnuplot(const std::string& script, const fs::path& folder) {
  const int input = text_file(script);
  if (input < 0) return false;
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawn_file_actions_addchdir_np(&actions, folder.c_str());
  ::posix_spawn_file_actions_adddup2(&actions, input, STDIN_FILENO);
  for (const int stream : {STDOUT_FILENO, STDERR_FILENO})
    ::posix_spawn_file_actions_addopen(&actions, stream, "/dev/null", O_WRONLY, 0);
  std::string name = "gnuplot";
  char* arguments[] = {name.data(), nullptr};
  pid_t child = -1;
  const int failure = ::posix_spawnp(&child, "gnuplot", &actions, nullptr, arguments, environ);
  ::posix_spawn_file_actions_destroy(&actions);
  ::close(input);
  return failure == 0 && wait_for(child) == 0;
}

bool is_whole_picture(const fs::path& path) {
  using namespace std::string_view_literals;
  std::error_code error;
  if (!fs::is_regular_file(path, error)) return false;
  const MappedFile file(path);
  if (path.extension() == ".png") return file.text().ends_with("IEND\xae\x42\x60\x82"sv);
  const size_t last = file.text().find_last_not_of(" \r\n");
  return last != std::string_view::npos && file.text().substr(0, last + 1).ends_with("</svg>"sv);
}

}  // namespace vpr
