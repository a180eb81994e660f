// Arrays, databases, and the module itself.
#include "python/module.h"

#include <cstdlib>

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "base/error.h"
#include "base/provenance.h"
#include "base/simd.h"
#include "describe/imported.h"
#include "store/archive.h"
#include "truth/times.h"
#include "words/word_training.h"

namespace py = pybind11;

namespace vpr {

bool is_path(const py::object& source) {
  return py::isinstance<py::str>(source) || py::hasattr(source, "__fspath__");
}

std::shared_ptr<const NpyArray> view_of(py::array array, const std::string& name) {
  const bool is_c = (array.flags() & py::array::c_style) != 0;
  const bool is_fortran = !is_c && (array.flags() & py::array::f_style) != 0;
  if (!is_c && !is_fortran) array = py::array::ensure(array, py::array::c_style);
  NpyHeader header{py::str(array.dtype().attr("str")), {}, is_fortran};
  header.shape.assign(array.shape(), array.shape() + array.ndim());
  const std::span values(static_cast<const std::byte*>(array.data()),
                         static_cast<size_t>(array.nbytes()));
  const auto release = [owner = array.inc_ref().ptr()](const NpyArray* view) {
    delete view;
    const py::gil_scoped_acquire acquire;
    Py_DECREF(owner);
  };
  return {new NpyArray(name, header, values), release};
}

std::string path_of(const py::object& source) {
  return py::str(py::module_::import("os").attr("fspath")(source));
}

std::vector<NamedArgument> arguments_of(const Sources& sources, const std::string& array_name) {
  std::vector<SequenceArgument> arguments;
  for (const auto& [given, source] : sources) {
    if (source.is_none())
      throw Error(ErrorKind::usage, "frames are missing: pass images or descriptors");
    if (is_path(source)) {
      arguments.push_back(parse_sequence_argument(path_of(source)));
      continue;
    }
    const std::string number = sources.size() > 1 ? std::to_string(arguments.size()) : "";
    const std::string name = given.empty() ? array_name + number : given;
    arguments.push_back({.path = name, .range = {}, .array = view_of(source, name)});
  }
  const std::vector<std::string> names = sequence_names(arguments);
  std::vector<NamedArgument> named;
  for (size_t i = 0; i < arguments.size(); ++i)
    named.push_back({sources[i].first.empty() ? names[i] : sources[i].first, arguments[i]});
  return named;
}

void set_source(ScoreInput& scores, const py::object& source) {
  scores.path = is_path(source) ? path_of(source) : "scores";
  if (!is_path(source)) scores.array = view_of(source, scores.path);
}

py::object fields_of(const Json& json) {
  return py::module_::import("vpr").attr("_read")(to_line(json));
}

void save(bool force, const std::function<void(Outputs& outputs)>& write) {
  Call("vpr.save").run([&](const Monitor&) {
    Outputs outputs(force ? Existing::replace : Existing::refuse);
    write(outputs);
    outputs.commit();
  });
}

SequenceDatabase& Database::sequences() {
  if (auto* found = std::get_if<SequenceDatabase>(&content)) return *found;
  throw Error(ErrorKind::data, "the database is for fabmap, which has no frame descriptors");
}

namespace {

FabmapDatabase train_places(Call& call, const std::vector<NamedArgument>& named,
                            const std::vector<NamedArgument>& other) {
  FabmapTrainSettings settings;
  call.rest(settings);
  std::vector<SequenceArgument> pretrain;
  for (const NamedArgument& one : other) pretrain.push_back(one.sequence);
  std::vector<GroupArgument> groups;
  for (const NamedArgument& one : named) groups.push_back({one.name, one.sequence});
  FabmapDatabase database;
  call.run([&](const Monitor& monitor) {
    database = train_fabmap(pretrain, groups, settings, call.process.seed, monitor);
    database.fingerprint = database_fingerprint(database);
  });
  return database;
}

SequenceDatabase train_frames(Call& call, std::vector<NamedArgument> named) {
  SelectionSettings selection;
  ImportSettings import;
  SequenceTrainSettings settings;
  call.take(selection, import);
  call.rest(settings);
  SequenceDatabase database;
  call.run([&](const Monitor& monitor) {
    for (NamedArgument& one : named)
      one.sequence = selected(one.sequence, selection, {}, call.process.seed, monitor);
    const SequenceSource first = open_sequence(named.at(0).sequence);
    if (first.kind == SequenceKind::descriptors)
      settings.descriptor_kind = imported_kind(ArrayRows(first).type().starts_with('|'), import);
    database = train_sequences(named, settings, select_kernels(), monitor);
    database.fingerprint = database_fingerprint(database);
  });
  return database;
}

Database train(const Sources& sources, const Sources& pretrain, const std::string& text,
               const py::object& progress) {
  Call call("vpr.train", text, progress);
  const std::vector<NamedArgument> named = arguments_of(sources, "train");
  if (pretrain.empty()) return {train_frames(call, named)};
  return {train_places(call, named, arguments_of(pretrain, "pretrain"))};
}

Database load(const std::filesystem::path& path) {
  Database database{{}, path.string()};
  Call("vpr.load").run([&](const Monitor&) { database.content = read_database(path); });
  return database;
}

void save_database(const Database& database, const std::filesystem::path& path, bool force) {
  save(force, [&](Outputs& outputs) {
    outputs.claim_folder(path, is_database_folder);
    write_database(path, database.content, outputs);
  });
}

// A view that keeps the database.
py::array descriptors_of(const DatabasePointer& database) {
  const DescriptorRows& rows = database->sequences().descriptors.rows();
  const ElementType element = rows.shape.element;
  const bool is_wide = element == ElementType::int16 || element == ElementType::points16;
  const char* type = is_wide ? "i2" : element == ElementType::int8 ? "i1" : "u1";
  const std::vector<size_t> shape = {rows.size(), rows.shape.row_bytes() / (is_wide ? 2 : 1)};
  py::array array(py::dtype(type), shape, rows.bytes.data(), py::cast(database));
  array.attr("flags").attr("writeable") = false;
  return array;
}

std::vector<std::string> sequences_of(const Database& database) {
  return std::visit([](const auto& content) { return names_of(content); }, database.content);
}

}  // namespace

PYBIND11_MODULE(_vpr, module) {
  using namespace py::literals;
  py::options options;
  options.disable_function_signatures();
  translate_errors();
  const char* simd = std::getenv("VPR_SIMD");
  use_simd_target(simd == nullptr ? "" : simd);
  module.attr("__version__") = program_version();
  py::class_<Database, DatabasePointer>(module, "Database",
                                        "Training sequences, from train or load.")
      .def("save", save_database, "path"_a, "force"_a = false,
           "Writes the folder that vpr-train writes. force: replaces a database.")
      .def_property_readonly("sequences", sequences_of, "Names of the training sequences.")
      .def_property_readonly(
          "descriptors", descriptors_of,
          "Stored descriptors, one row per frame of all sequences, as a read-only view: bits (8 "
          "per\nvalue) and images are uint8, vectors int16 or int8. Not for FAB-MAP.");
  module.def("train", train);
  module.def("load_database", load);
  add_queries(module);
  add_evaluations(module);
}

}  // namespace vpr
