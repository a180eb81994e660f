// What is loaded before a program (LD_PRELOAD) to have one of its file calls fail: calls.cpp stands
// in front of the C library's calls, server.cpp runs the program's main once a request.
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
  power,      ///< the file system goes down: what is in its journal's log stays
  power_off,  ///< the same, and the log is lost, too
};

/// What is to happen in one run. Calls that touch nothing below the folder are not counted.
struct Plan {
  std::string folder;  ///< as the program names it, relative
  Fault fault = Fault::none;
  uint64_t number = 0;             ///< of the call, from 1
  bool has_plain_renames = false;  ///< no flags: as on a network file system
};

/// Notes of calls, one a line: its name, whether it failed by plan ("!") or not (" "), its path.
struct Notes {
  static constexpr uint64_t kMostBytes = 1 << 20;
  uint64_t bytes = 0;
  char text[kMostBytes];
};

/// From here on, calls of this process are counted and noted.
void arm(const Plan& plan, Notes& notes);

}  // namespace faults
