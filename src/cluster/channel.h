// How the processes of a run exchange bytes: the one thing that is done by MPI, in a module that is
// loaded by processes that mpirun started.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace vpr {

/// One end of the connections between all processes. Every function returns once its part is done;
/// while it waits it calls, again and again, what the channel was opened with, which may throw.
class Channel {
 public:
  virtual ~Channel() = default;
  virtual size_t index() const = 0;
  virtual size_t count() const = 0;
  /// Of all processes, in each: sums, or the largest.
  virtual void add(std::span<uint64_t> values) = 0;
  virtual void most(std::span<int64_t> values) = 0;
  /// What process `from` has, in all of them; the size is known.
  virtual void spread(size_t from, std::span<std::byte> bytes) = 0;
  /// From one process to the first.
  virtual void send(std::span<const std::byte> bytes) = 0;
  virtual void receive(size_t from, std::span<std::byte> bytes) = 0;
  /// Ends it, once all processes do.
  virtual void close() = 0;
};

/// What the module has by the name kOpenChannel: null where there is no connection.
using OpenChannel = Channel* (*)(void (*while_waiting)());
inline constexpr const char* kOpenChannel = "vpr_open_channel";

}  // namespace vpr
