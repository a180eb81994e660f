// A library that is loaded before a program (LD_PRELOAD) and makes one of its file calls fail:
// calls.cpp wraps the C library's calls, server.cpp runs the program's main once per request.
#pragma once

#include <cstdint>
#include <string>

namespace faults {

enum class Fault : char {
  none,
  kill,       ///< SIGKILL before the call
  torn,       ///< half of a write, then SIGKILL
  interrupt,  ///< SIGINT before the call
  eintr,      ///< this call fails with EINTR
  eio,        ///< this call fails with EIO
  dead,       ///< this call and all later ones fail with EIO
  enospc,     ///< this call and all later ones that take space fail with ENOSPC
  shorten,    ///< half of a write
  power,      ///< the file system goes down with its journal's log
  power_off,  ///< the file system goes down without its log
};

/// The plan of one run. Counts only calls on files in the folder.
struct Plan {
  std::string folder;  ///< as named by the program, relative
  Fault fault = Fault::none;
  uint64_t number = 0;                ///< of the call, from 1
  bool has_flagless_renames = false;  ///< without flags, as on a network file system
};

/// Records of calls, one per line: name, whether it failed as planned ("!") or not (" "), path.
struct Notes {
  static constexpr uint64_t kMaxBytes = 1 << 20;
  uint64_t bytes = 0;
  char text[kMaxBytes];
};

/// Starts to count and record the calls of this process.
void arm(const Plan& plan, Notes& notes);

}  // namespace faults
