// The Python module _vpr: each function reads settings, runs the steps of one program, and returns
// their values. vpr/__init__.py has the interface of users. Declares what its topics share: NumPy
// arrays, databases, choices of queries, outputs.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <pybind11/numpy.h>

#include "base/npy.h"
#include "base/output.h"
#include "evaluate/score_matrix.h"
#include "files/result_arrays.h"
#include "python/call.h"
#include "run/plan.h"
#include "run/train_sequences.h"
#include "settings/choices.h"
#include "words/database.h"

namespace vpr {

/// A view of an array, which it keeps. Only an array in neither C nor Fortran order is copied.
std::shared_ptr<const NpyArray> view_of(pybind11::array array, const std::string& name);

/// The sequence of a path, as on the command line, or of an array with one row per frame.
SequenceArgument sequence_of(const pybind11::object& source, const std::string& name);

/// The score matrix at a path, or in an array, "scores".
ScoreInput scores_of(const pybind11::object& source);

/// Paths and arrays with their names; empty names are those of the paths.
using Sources = std::vector<std::pair<std::string, pybind11::object>>;
std::vector<NamedArgument> arguments_of(const Sources& sources);

/// An object of the class Fields.
pybind11::object fields_of(const Json& json);

/// The rows as a read-only view; `owner` keeps them.
pybind11::array view_of(const DescriptorRows& rows, const pybind11::object& owner);

/// A copy, with columns as fields.
pybind11::array array_of(const ResultArray& array);

struct Database {
  AnyDatabase content;
  std::string path;  ///< from which it was read; empty: trained by this process

  /// Throws Error(data) for FAB-MAP.
  SequenceDatabase& sequences();
};
using DatabasePointer = std::shared_ptr<Database>;

/// The choices of a query by a sequence method, besides its frames.
struct QueryChoices {
  std::string fuse;                         ///< a FAB-MAP database; empty: none
  std::string frame_times;                  ///< a file with the times of a loop query
  std::vector<std::string> train_sequence;  ///< ranges of a score matrix
  std::string speed;                        ///< of a score matrix
  QueryResources resources;
  ResolvedSettings settings;

  /// Reads all keywords that are left. `command`: of vpr-query.
  QueryChoices(Call& call, Feature command);

  /// The database with the statistics and fused views that the settings need; views are added to a
  /// copy.
  std::shared_ptr<SequenceDatabase> prepare(const DatabasePointer& database,
                                            const Monitor& monitor) const;
};

/// Writes outputs in a call, and commits them.
void save(bool force, const std::function<void(Outputs& outputs)>& write);

/// Add the classes and functions of one topic to the module.
void add_databases(pybind11::module_& module);
void add_queries(pybind11::module_& module);
void add_live(pybind11::module_& module);
void add_evaluations(pybind11::module_& module);

}  // namespace vpr
