#include "served.h"

#include <array>
#include <cstdint>
#include <map>
#include <stdexcept>
#include <utility>

#include <fcntl.h>
#include <spawn.h>
#include <unistd.h>

extern char** environ;

namespace vpr::test {
namespace {

namespace fs = std::filesystem;

/// A process that ends when its requests are closed, at the latest with this one.
struct Server {
  int requests = -1;
  int answers = -1;
};

Server start(std::string program, const fs::path& library) {
  std::array<int, 2> requests{};
  std::array<int, 2> answers{};
  if (::pipe2(requests.data(), O_CLOEXEC) != 0 || ::pipe2(answers.data(), O_CLOEXEC) != 0)
    throw std::runtime_error("pipe2 failed");
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, requests[0], STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&actions, answers[1], STDOUT_FILENO);
  Environment environment({"LD_PRELOAD=" + library.string(), "VPR_SERVED=1", "LD_BIND_NOW=1",
                           "OPENBLAS_NUM_THREADS=1"});
  std::array<char*, 2> argv = {program.data(), nullptr};
  pid_t child = 0;
  if (::posix_spawn(&child, argv[0], &actions, nullptr, argv.data(), environment.data()) != 0)
    throw std::runtime_error("cannot start " + program);
  posix_spawn_file_actions_destroy(&actions);
  ::close(requests[0]);
  ::close(answers[1]);
  return {requests[1], answers[0]};
}

void read_all(int file, void* bytes, size_t size) {
  auto* at = static_cast<char*>(bytes);
  while (size > 0) {
    const ssize_t got = ::read(file, at, size);
    if (got <= 0) throw std::runtime_error("a served program has ended");
    at += got;
    size -= static_cast<size_t>(got);
  }
}

}  // namespace

Environment::Environment(std::vector<std::string> variables) : variables_(std::move(variables)) {
  for (char** variable = environ; *variable != nullptr; ++variable)
    variables_.emplace_back(*variable);
  for (std::string& variable : variables_) pointers_.push_back(variable.data());
  pointers_.push_back(nullptr);
}

std::optional<int> run_served(const std::vector<std::string>& words, const fs::path& out,
                              const fs::path& err) {
  static std::map<std::string, Server> servers;
  const std::string& program = words.at(0);
  const fs::path library = fs::path(program).parent_path() / "vpr_faults.so";
  if (!fs::exists(library)) return std::nullopt;
  if (!servers.contains(program)) servers[program] = start(program, library);
  const Server& server = servers[program];

  std::string request(sizeof(uint32_t), '\0');
  const auto add = [&](const std::string& text) { request.append(text.c_str(), text.size() + 1); };
  for (const std::string& text : {fs::current_path().string(), out.string(), err.string()})
    add(text);
  for (const char* no_fault : {"", "0", "0", "0"}) add(no_fault);
  for (const std::string& word : words) add(word);
  const auto size = static_cast<uint32_t>(request.size() - sizeof(uint32_t));
  request.replace(0, sizeof(size), reinterpret_cast<const char*>(&size), sizeof(size));
  if (::write(server.requests, request.data(), request.size()) !=
      static_cast<ssize_t>(request.size()))
    throw std::runtime_error("a served program takes no requests");

  int32_t status = 0;
  uint32_t notes = 0;
  read_all(server.answers, &status, sizeof(status));
  read_all(server.answers, &notes, sizeof(notes));
  return status;
}

}  // namespace vpr::test
