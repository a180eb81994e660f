// The Python module _vpr: each function reads settings, runs the steps of one program, and returns
// their values. vpr/__init__.py has the interface of users. Declares what its topics share: calls,
// NumPy arrays, databases.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <pybind11/numpy.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "base/json.h"
#include "base/npy.h"
#include "base/output.h"
#include "fabmap/database.h"
#include "files/run_info.h"
#include "sequence/frames.h"

namespace vpr {

/// A call from Python: settings from keyword arguments, and work without the interpreter's lock.
struct Call {
  std::string function;  ///< names itself in errors
  Json keywords = Json::object();
  pybind11::object progress = pybind11::none();
  std::string folder = {};  ///< of temporary files, which sentences don't name
  ProcessSettings process = {};

  /// Reads all keywords as these settings and those of the process. Throws Error(usage) for wrong
  /// values, and for other keywords, with the nearest name.
  template <class... S>
  void read(S&... settings) {
    NestedObject all{[&](auto&& visit) {
      visit_fields(process, visit);
      (visit_fields(settings, visit), ...);
    }};
    value_from_json(keywords, all, function, "the settings");
  }

  /// The sentence without the folder.
  std::string shown(std::string sentence) const;

  /// Runs `work` in a thread without the interpreter's lock. Works of several threads run one after
  /// the other, because settings of libraries belong to the process. Meanwhile the calling thread
  /// calls `progress(step, done, total)` unless it is None, and Python's warnings. An interrupt, an
  /// exception of these, or the end of the interpreter stops the work; the first two are raised.
  void run(const std::function<void(const Monitor&)>& work) const;
};

/// Runs `write`, and commits its outputs, which replace no input of the run.
void save(bool force, const RunInfo& run, const std::function<void(Outputs& outputs)>& write);

/// A path as on the command line, an array (or what NumPy makes one of), or None.
using Source = std::variant<std::filesystem::path, pybind11::object>;
/// Their names may be empty.
using Sources = std::vector<std::pair<std::string, Source>>;

/// The array that NumPy makes of the values. Throws Error(data) for masked values, and for values
/// other than numbers.
pybind11::array array_of(const pybind11::object& values, const std::string& name);

/// A view of an array, which it keeps. Only an array in neither C nor Fortran order is copied.
std::shared_ptr<const NpyArray> view_of(pybind11::array array, const std::string& name);

/// Sequences and their names. Without a name, it is the one of the path, or `array_name`, numbered
/// if there are several sources. Throws Error(usage) for None.
std::vector<NamedArgument> arguments_of(const Sources& sources, const std::string& array_name);

/// An object of the class Fields.
pybind11::object fields_of(const Json& json);

struct Database {
  AnyDatabase content;
  std::string path = {};  ///< from which it was read; empty: trained by this process

  /// Throws Error(data) for FAB-MAP.
  SequenceDatabase& sequences();
};
using DatabasePointer = std::shared_ptr<Database>;

/// Add the classes and functions of one topic to the module.
void add_queries(pybind11::module_& module);
void add_evaluations(pybind11::module_& module);

}  // namespace vpr
