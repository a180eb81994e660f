// One of our programs while it runs: writes its input and reads its output line by line.
#pragma once

#include <string>

#include <sys/types.h>

#include "cli/world.h"

namespace vpr::test {

class Running {
 public:
  /// `command`: as for run().
  explicit Running(const std::string& command);
  ~Running();
  Running(const Running&) = delete;
  Running& operator=(const Running&) = delete;

  void write(const std::string& text) const;
  /// The next line, without its line feed, as soon as it arrives; fails if there is none.
  std::string line();
  void close_input();
  void signal(int number) const;
  /// Waits for the end. `out`: the lines that line() has not returned.
  RunOutcome finish();

 private:
  TemporaryFolder folder_;
  pid_t child_ = 0;
  int input_ = -1;
  int output_ = -1;
  std::string text_;
  bool read_more();
};

}  // namespace vpr::test
