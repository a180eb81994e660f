#include "cli/running.h"

#include <array>
#include <csignal>

#include <catch2/catch.hpp>
#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

extern char** environ;

namespace vpr::test {

constexpr int kPatienceMs = 120'000;

Running::Running(const std::string& command) {
  std::array<int, 2> in{};
  std::array<int, 2> out{};
  REQUIRE((::pipe2(in.data(), O_CLOEXEC) == 0 && ::pipe2(out.data(), O_CLOEXEC) == 0));
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, in[0], STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&actions, out[1], STDOUT_FILENO);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, (folder_ / "err").c_str(),
                                   O_WRONLY | O_CREAT | O_TRUNC, 0600);
  Words words = words_of(command);
  words.front() = program_path(words.front());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  const int failed = ::posix_spawn(&child_, argv[0], &actions, nullptr, argv.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  ::close(in[0]);
  ::close(out[1]);
  input_ = in[1];
  output_ = out[0];
  REQUIRE(failed == 0);
}

Running::~Running() {
  close_input();
  ::close(output_);
  if (child_ > 0) {
    ::kill(child_, SIGKILL);
    ::waitpid(child_, nullptr, 0);
  }
}

void Running::write(const std::string& text) const {
  REQUIRE(::write(input_, text.data(), text.size()) == static_cast<ssize_t>(text.size()));
}

bool Running::read_more() {
  pollfd output{output_, POLLIN, 0};
  REQUIRE(::poll(&output, 1, kPatienceMs) == 1);
  std::array<char, 4096> buffer;
  const ssize_t bytes = ::read(output_, buffer.data(), buffer.size());
  if (bytes > 0) text_.append(buffer.data(), static_cast<size_t>(bytes));
  return bytes > 0;
}

std::string Running::line() {
  size_t end = 0;
  while ((end = text_.find('\n')) == std::string::npos) {
    INFO(read_text(folder_ / "err"));
    REQUIRE(read_more());
  }
  const std::string line = text_.substr(0, end);
  text_.erase(0, end + 1);
  return line;
}

void Running::close_input() {
  if (input_ >= 0) ::close(input_);
  input_ = -1;
}

void Running::signal(int number) const { ::kill(child_, number); }

RunOutcome Running::finish() {
  while (read_more()) {
  }
  int status = 0;
  ::waitpid(child_, &status, 0);
  child_ = 0;
  return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), text_,
          read_text(folder_ / "err")};
}

}  // namespace vpr::test
