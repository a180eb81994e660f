// Progress as text; terminal.py tests its display on a terminal.
#include "common/progress.h"

#include <catch2/catch.hpp>

#include "base/monitor.h"

using namespace vpr;

namespace {

/// Calls of the monitor.
struct Reported {
  std::string step;
  size_t done = 0;
  size_t total = 0;
};

Monitor recorder(Reported& last) {
  Monitor monitor;
  monitor.progress = [&last](const std::string& step, size_t done, size_t total) {
    last = {step, done, total};
  };
  return monitor;
}

}  // namespace

TEST_CASE("a part's name, number and share refer to the whole step") {
  Reported last;
  const Monitor monitor = recorder(last);
  const auto report = [&](size_t index, size_t count) {
    const Monitor part = part_of(monitor, "monday", index, count);
    StepCounter(part, "match", 10).add(5);
  };
  report(0, 1);
  CHECK(last.step == "match monday");
  CHECK((last.done == 5 && last.total == 10));
  report(2, 4);
  CHECK(last.step == "match monday 3/4");
  CHECK((last.done == 25 && last.total == 40));
  const Monitor inner = part_of(part_of(monitor, "walk", 1, 2), "pass", 0, 2);
  StepCounter(inner, "match", 4).add(2);
  CHECK(last.step == "match pass 1/2 walk 2/2");
  CHECK((last.done == 10 && last.total == 16));
  StepCounter(part_of(Monitor{}, "walk", 0, 1), "match", 4).add(2);  // without callbacks
}

TEST_CASE("lines have the same width before the bar, and fit the terminal") {
  CHECK(progress_text("match monday 3/14", 5, 28, 12, 100) ==
        "match monday 3/14              [####                    ]  18 %  ETA 0:12");
  CHECK(progress_text("match monday 3/14", 5, 28, -1, 100) ==
        "match monday 3/14              [####                    ]  18 %");
  CHECK(progress_text("match " + std::string(50, 'x') + " 3/14", 5, 10, -1, 100) ==
        "match ...xxxxxxxxxxxxxxxx 3/14 [############            ]  50 %");
  CHECK(progress_text("match a\x1b[2J\nb", 5, 10, -1, 100) ==
        "match a\\x1b[2J\\x0ab            [############            ]  50 %");
  CHECK(progress_text("frames", 7, 0, -1, 100) == "frames                         7");
  CHECK(progress_text("match monday 3/14", 14, 28, 12, 59) ==
        "match monday 3/14              [####     ]  50 %  ETA 0:12");
  CHECK(progress_text("match monday 3/14", 5, 28, 12, 40).size() == 40);
}
