// The processes that mpirun started together, as one of them sees them.
#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/share.h"
#include "base/stopwatch.h"
#include "cluster/channel.h"

namespace vpr {

/// Which of several processes this one is, as mpirun says in the environment; none where it was
/// started alone, or is the only one.
std::optional<size_t> launched_index();

/// What the processes of a run say to each other. They take the same steps (Share) in the same
/// order; every step begins with the question whether all are well, so that the failure of one ends
/// all of them with one sentence and one exit code.
class ProcessGroup {
 public:
  /// Connects with the others. While it waits for them, `stop` ends the work. Throws Error(usage)
  /// in a build without MPI.
  explicit ProcessGroup(const std::atomic<bool>& stop);
  ~ProcessGroup();
  ProcessGroup(const ProcessGroup&) = delete;
  ProcessGroup& operator=(const ProcessGroup&) = delete;

  /// Must not outlive the group.
  Share share();

  /// The last step, where all went well. Throws the Error of another process.
  void end();

  /// In place of all further steps: this process has failed. Gives the failure that all processes
  /// report, the lowest one's of several. One that was interrupted asks nobody.
  Error fail(const Error& own);

  /// Behind end() or fail(), once all that is to be said was said: waits for the others.
  void close();

  /// A step: what every process did, a line each, then what went between them. In the first one.
  std::vector<std::string> report();

 private:
  struct Traffic {
    uint64_t steps = 0;
    uint64_t bytes = 0;  ///< that this process has given
  };

  void agree(int64_t step, const Error* failure);
  void begin_step(std::string_view what, uint64_t bytes);
  std::vector<Bytes> collect(std::span<const std::byte> own);
  void spread(size_t from, Bytes& bytes);

  std::unique_ptr<Channel> channel_;
  std::optional<Error> agreed_;  ///< the failure that ends all
  std::map<std::string, Traffic, std::less<>> traffic_;
  int64_t steps_ = 0;
  bool is_cut_ = false;  ///< interrupted: nobody may listen
  Stopwatch since_start_;
};

}  // namespace vpr
