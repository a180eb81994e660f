// Calls of the Python module: settings from keyword arguments; work without the interpreter's lock,
// with progress, warnings and interruption; errors.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <pybind11/pybind11.h>

#include "base/json.h"
#include "base/monitor.h"
#include "files/run_info.h"
#include "run/plan.h"
#include "sequence/decode.h"
#include "sequence/sequence_source.h"

namespace vpr {

/// Settings of every call, with the names and defaults of the programs' common flags.
struct CallSettings {
  uint64_t threads = 0;  ///< 0: all cores
  uint64_t seed = 1;
  uint64_t max_megapixels = kDefaultMegapixels;
  FrameOrder order = FrameOrder::automatic;
};
VPR_FIELDS(CallSettings, threads, seed, max_megapixels, order)

struct MemorySettings {
  uint64_t max_memory = kDefaultMemoryLimit;  ///< bytes
};
VPR_FIELDS(MemorySettings, max_memory)

/// The keyword arguments of a function, which names itself in errors.
class Keywords {
 public:
  Keywords(std::string function, const std::string& json)
      : function_(std::move(function)), json_(parse_json(json).value()) {}

  /// Reads and removes the keys of S. Throws Error(usage) for wrong values.
  template <class S>
  S take(S settings = {}) {
    Json own = Json::object();
    visit_fields(settings, [&](const char* key, auto&) {
      if (!json_.contains(key)) return;
      own[key] = json_[key];
      json_.erase(key);
    });
    value_from_json(own, settings, function_, "the settings");
    return settings;
  }
  /// Reads all remaining keys. Throws Error(usage) for unknown ones, with the nearest name.
  template <class S>
  S rest() const {
    S settings;
    value_from_json(json_, settings, function_, "the settings");
    return settings;
  }
  std::vector<std::string> keys() const;
  const Json& json() const { return json_; }
  const std::string& function() const { return function_; }

 private:
  std::string function_;
  Json json_;
};

/// Provenance of files as `program` writes them, and the function that made them.
RunInfo run_info(const std::string& program, const std::string& function, const CallSettings& call);

/// Runs `work` in a thread without the interpreter's lock. Works of several threads run one after
/// the other, because settings of libraries belong to the process. Meanwhile the calling thread
/// calls `progress(step, done, total)` unless it is None, and Python's warnings. An interrupt or an
/// exception of these stops the work and is raised.
void run_call(const CallSettings& call, const pybind11::object& progress,
              const std::function<void(const Monitor&)>& work);

/// Raises errors as the classes of the package.
void translate_errors();

}  // namespace vpr
