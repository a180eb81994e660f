#include "base/step_parts.h"

#include <fmt/format.h>

namespace vpr {

Monitor part_of(const Monitor& monitor, const std::string& name, size_t index, size_t count) {
  Monitor part = monitor;
  if (!monitor.progress || count == 0) return part;
  const std::string label = count > 1 ? fmt::format("{} {}/{}", name, index + 1, count) : name;
  part.progress = [report = monitor.progress, label, index, count](const std::string& step,
                                                                   size_t done, size_t total) {
    report(fmt::format("{} {}", step, label), index * total + done, count * total);
  };
  return part;
}

}  // namespace vpr
