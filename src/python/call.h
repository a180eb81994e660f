// A call of the Python module: settings from keyword arguments; work without the interpreter's
// lock, with progress, warnings and interruption; errors.
#pragma once

#include <functional>
#include <string>

#include <pybind11/pybind11.h>

#include "base/json.h"
#include "base/monitor.h"
#include "files/run_info.h"
#include "sequence/frames.h"

namespace vpr {

struct Call {
  std::string function;  ///< names itself in errors
  Json keywords;         ///< that were not read yet
  pybind11::object progress;
  ProcessSettings process;

  /// Reads the settings of the process. `text`: the keywords as JSON.
  explicit Call(std::string name, const std::string& text = "{}",
                pybind11::object observer = pybind11::none(), ProcessSettings initial = {});

  /// Reads and removes the keywords of these settings. Throws Error(usage) for wrong values.
  template <class... S>
  void take(S&... settings) {
    NestedObject all{[&](auto&& visit) { (visit_fields(settings, visit), ...); }};
    Json own = Json::object();
    visit_fields(all, [&](const std::string& key, auto&) {
      if (keywords.contains(key)) own[key] = keywords[key];
      keywords.erase(key);
    });
    value_from_json(own, all, function, "the settings");
  }
  /// Reads the other keywords. Throws Error(usage) also for unknown ones, with the nearest name.
  template <class S>
  void rest(S& settings) const {
    value_from_json(keywords, settings, function, "the settings");
  }

  /// Runs `work` in a thread without the interpreter's lock. Works of several threads run one after
  /// the other, because settings of libraries belong to the process. Meanwhile the calling thread
  /// calls `progress(step, done, total)` unless it is None, and Python's warnings. An interrupt or
  /// an exception of these stops the work and is raised.
  void run(const std::function<void(const Monitor&)>& work) const;

  /// The provenance of files as `program` writes them; call it while work runs.
  RunInfo run_info(const std::string& program) const;
};

/// Raises errors as the classes of the package.
void translate_errors();

}  // namespace vpr
