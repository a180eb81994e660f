// The Python module _vpr: each function makes a call of vpr/calls.h and returns its values.
// vpr/__init__.py has the interface of users. Declares the shared parts of its topics: calls
// without the interpreter's lock, and NumPy arrays.
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
#include "vpr/calls.h"

namespace vpr {

/// The guard of a function that runs Python or releases the interpreter's lock. Once the
/// interpreter ends, calls of other threads are stopped, and those that they begin never return.
/// Throws Error(usage) in a process that was forked while another thread was in a call.
struct InCall {
  InCall();
  ~InCall();
  InCall(const InCall&) = delete;
  InCall& operator=(const InCall&) = delete;
};

/// A call from Python: settings from keyword arguments, and work without the interpreter's lock.
struct Call {
  calls::Keywords keywords;
  pybind11::object progress = pybind11::none();
  std::string folder = {};  ///< of temporary files, which sentences don't name

  /// The sentence without the folder.
  std::string shown(std::string sentence) const;

  /// Runs `work` in a thread without the interpreter's lock, in its ProcessTurn. Meanwhile the
  /// calling thread calls `progress(step, done, total)` unless it is None, and Python's warnings.
  /// An interrupt, an exception of these, or the end of the interpreter stops the work; the first
  /// two are raised.
  void run(const std::function<void(const Monitor&)>& work) const;
};

/// __new__ of a class that only functions make: throws TypeError.
pybind11::object refuse_new(const pybind11::object& type, const pybind11::args& arguments,
                            const pybind11::kwargs& more);

/// Runs `write` as the call vpr.save.
void save(const std::function<void()>& write);

/// A path as on the command line, an array (or what NumPy makes one of), or None.
using Source = std::variant<std::filesystem::path, pybind11::object>;
/// Their names may be empty.
using Sources = std::vector<std::pair<std::string, Source>>;

/// The array that NumPy makes of the values. Throws Error(data) for masked values, and for values
/// other than numbers.
pybind11::array array_of(const pybind11::object& values, const std::string& name);

/// A view of an array, which it keeps. Only an array in neither C nor Fortran order is copied.
std::shared_ptr<const NpyArray> view_of(pybind11::array array, const std::string& name);

/// As calls::named_arguments. Throws Error(usage) for None.
std::vector<NamedArgument> arguments_of(const Sources& sources, const std::string& array_name);

/// An object of the class Fields.
pybind11::object fields_of(const Json& json);

/// Add the classes and functions of one topic to the module.
void add_queries(pybind11::module_& module);
void add_evaluations(pybind11::module_& module);

}  // namespace vpr
