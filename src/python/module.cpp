#include "python/module.h"

#include <cstdlib>

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "base/error.h"
#include "base/provenance.h"
#include "base/simd.h"
#include "describe/imported.h"
#include "run/train_sequences.h"
#include "store/archive.h"
#include "truth/times.h"
#include "words/word_training.h"

namespace py = pybind11;

namespace vpr {

SequenceDatabase& Database::sequences() {
  if (auto* found = std::get_if<SequenceDatabase>(&content)) return *found;
  throw Error(ErrorKind::data, "the database is for fabmap, which has no frame descriptors");
}

void save(bool force, const std::function<void(Outputs& outputs)>& write) {
  Call("vpr.save").run([&](const Monitor&) {
    Outputs outputs(force ? Existing::replace : Existing::refuse);
    write(outputs);
    outputs.commit();
  });
}

namespace {

DatabasePointer train(const Sources& sources, const Sources& pretrain, const std::string& text,
                      const py::object& progress) {
  Call call("vpr.train", text, progress);
  std::vector<NamedArgument> named = arguments_of(sources);
  const auto database = std::make_shared<Database>();
  if (!pretrain.empty()) {
    FabmapTrainSettings settings;
    call.rest(settings);
    std::vector<SequenceArgument> other;
    for (const NamedArgument& one : arguments_of(pretrain)) other.push_back(one.sequence);
    std::vector<GroupArgument> groups;
    for (const NamedArgument& one : named) groups.push_back({one.name, one.sequence});
    call.run([&](const Monitor& monitor) {
      database->content = train_fabmap(other, groups, settings, call.process.seed, monitor);
    });
    return database;
  }
  SelectionSettings selection;
  ImportSettings import;
  SequenceTrainSettings settings;
  call.take(selection, import);
  call.rest(settings);
  call.run([&](const Monitor& monitor) {
    for (NamedArgument& one : named)
      one.sequence = selected(one.sequence, selection, {}, call.process.seed, monitor);
    const SequenceSource first = open_sequence(named.at(0).sequence);
    if (first.kind == SequenceKind::descriptors)
      settings.descriptor_kind = imported_kind(ArrayRows(first).type().starts_with('|'), import);
    database->content = train_sequences(named, settings, select_kernels(), monitor);
  });
  return database;
}

DatabasePointer load(const std::filesystem::path& path) {
  const auto database = std::make_shared<Database>();
  database->path = path.string();
  Call("vpr.load").run([&](const Monitor&) { database->content = read_database(path); });
  return database;
}

void save_database(const Database& database, const std::filesystem::path& path, bool force) {
  save(force, [&](Outputs& outputs) {
    outputs.claim_folder(path, is_database_folder);
    write_database(path, database.content, outputs);
  });
}

}  // namespace

void add_databases(py::module_& module) {
  using namespace py::literals;
  py::class_<Database, DatabasePointer>(module, "Database",
                                        "Training sequences, from train or load.")
      .def("save", save_database, "path"_a, "force"_a = false,
           "Writes the folder that vpr-train writes. force: replaces a database.")
      .def_property_readonly(
          "sequences",
          [](const Database& self) {
            return std::visit([](const auto& content) { return names_of(content); }, self.content);
          },
          "Names of the training sequences.")
      .def_property_readonly(
          "descriptors",
          [](const DatabasePointer& self) {
            return view_of(self->sequences().descriptors.rows(), py::cast(self));
          },
          "Stored descriptors, one row per frame of all sequences, as a read-only view: bits (8 "
          "per\nvalue) and images are uint8, vectors int16 or int8. Not for FAB-MAP.");
  module.def("train", train);
  module.def("load_database", load);
}

PYBIND11_MODULE(_vpr, module) {
  py::options options;
  options.disable_function_signatures();
  translate_errors();
  const char* simd = std::getenv("VPR_SIMD");
  use_simd_target(simd == nullptr ? "" : simd);
  module.attr("__version__") = program_version();
  add_databases(module);
  add_queries(module);
  add_live(module);
  add_evaluations(module);
}

}  // namespace vpr
