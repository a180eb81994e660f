#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <utility>

#include <dlfcn.h>
#include <fmt/format.h>
#include <sys/prctl.h>

#include "cluster/process_group.h"

namespace vpr {
namespace {

std::optional<size_t> number_of(const char* variable) {
  const char* text = std::getenv(variable);
  if (text == nullptr || *text == 0) return std::nullopt;
  return std::strtoull(text, nullptr, 10);
}

}  // namespace

std::optional<size_t> launched_index() {
  for (const auto& [count, index] : {std::pair("OMPI_COMM_WORLD_SIZE", "OMPI_COMM_WORLD_RANK"),
                                     std::pair("PMI_SIZE", "PMI_RANK")})
    if (const auto processes = number_of(count))
      return *processes > 1 ? std::optional(number_of(index).value_or(0)) : std::nullopt;
  return number_of("PMIX_RANK");
}

std::unique_ptr<ProcessGroup> join_processes(const std::atomic<bool>& stop) {
  const std::filesystem::path module =
      std::filesystem::read_symlink("/proc/self/exe").parent_path() / VPR_CLUSTER_MODULE;
  if (!std::filesystem::exists(module))
    throw Error(ErrorKind::usage,
                "started by mpirun, but built without MPI: install libopenmpi-dev and build "
                "again, or leave mpirun out");
  // Processes do not outlive mpirun: not even a stopped one, which can't handle SIGTERM. The first
  // one removes its unfinished outputs.
  ::prctl(PR_SET_PDEATHSIG, launched_index().value_or(0) == 0 ? SIGTERM : SIGKILL);
  void* library = ::dlopen(module.c_str(), RTLD_NOW | RTLD_GLOBAL);
  void* open = library == nullptr ? nullptr : ::dlsym(library, kOpenGroup);
  if (open == nullptr) throw Error(ErrorKind::input, fmt::format("can't load {}", ::dlerror()));
  return std::unique_ptr<ProcessGroup>(reinterpret_cast<OpenGroup>(open)(stop));
}

}  // namespace vpr
