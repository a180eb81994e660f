#include "base/monitor.h"

#include <memory>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "base/error.h"

namespace vpr {

void check_stop(const Monitor& monitor) {
  if (monitor.stop != nullptr && monitor.stop->load(std::memory_order_relaxed))
    throw Error(ErrorKind::interrupted, "interrupted; nothing was written");
}

void warn(const Monitor& monitor, const std::string& sentence) {
  if (monitor.warn) monitor.warn(sentence);
}

Monitor with_each_warning_once(const Monitor& monitor) {
  Monitor once = monitor;
  once.warn = [&monitor,
               reported = std::make_shared<std::set<std::string>>()](const std::string& sentence) {
    if (reported->insert(sentence).second) warn(monitor, sentence);
  };
  return once;
}

StepCounter::StepCounter(const Monitor& monitor, std::string step, size_t total)
    : monitor_(monitor), step_(std::move(step)), total_(total) {}

void StepCounter::add(size_t units) {
  check_stop(monitor_);
  const size_t done = done_.fetch_add(units, std::memory_order_relaxed) + units;
  if (monitor_.progress) monitor_.progress(step_, done, total_);
}

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
