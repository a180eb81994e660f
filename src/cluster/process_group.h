// The processes that mpirun started together, as one of them sees them.
#pragma once

#include <atomic>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/share.h"

namespace vpr {

/// Which of several processes this one is, as mpirun says in the environment; none where it was
/// started alone, or is the only one.
std::optional<size_t> launched_index();

/// What the processes of a run say to each other. They take the same steps (Share) in the same
/// order; every step begins with the question whether all are well, so that the failure of one ends
/// all of them with one sentence and one exit code.
class ProcessGroup {
 public:
  virtual ~ProcessGroup() = default;

  /// Must not outlive the group.
  virtual Share share() = 0;

  /// A step: what each process did, a line each, then what went between them. In the first one.
  virtual std::vector<std::string> report() = 0;

  /// The last step, where all went well. Throws the Error of another process.
  virtual void end() = 0;

  /// In place of all further steps: this process has failed. Gives the failure that all processes
  /// report, the lowest one's of several. One that was interrupted asks nobody.
  virtual Error fail(const Error& own) = 0;

  /// After end() or fail() and all output: waits for the others. Exits at once with this code if
  /// the process was interrupted, because destructors would race with the threads of MPI.
  virtual void close(int exit_code) = 0;
};

/// Connects with the others, by a module that is loaded by processes that mpirun started only.
/// While the group waits for them, `stop` ends the work. Throws Error(usage) in a build without
/// MPI, Error(input) where the module can't be loaded.
std::unique_ptr<ProcessGroup> join_processes(const std::atomic<bool>& stop);

/// What the module has by the name kOpenGroup.
using OpenGroup = ProcessGroup* (*)(const std::atomic<bool>& stop);
inline constexpr const char* kOpenGroup = "vpr_open_group";

}  // namespace vpr
