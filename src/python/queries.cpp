// Queries, their results, live queries, and frame distances.
#include <opencv2/core.hpp>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "base/error.h"
#include "base/stopwatch.h"
#include "fabmap/place_query.h"
#include "files/live_lines.h"
#include "loops/sequence_query.h"
#include "present/result_text.h"
#include "python/module.h"
#include "run/open.h"
#include "truth/times.h"

namespace py = pybind11;

namespace vpr {
namespace {

/// A query by a sequence method: all keywords of the call, and its frames.
struct SequenceQuery {
  QueryInputs inputs;
  SelectionSettings selection;
  std::string fuse;  ///< a FAB-MAP database; empty: none
  QueryResources resources;
  ResolvedSettings settings;

  /// `command`: of vpr-query.
  SequenceQuery(Call& call, Feature command)
      : resources{select_kernels(), kDefaultMemoryLimit, 0, call.process.seed} {
    const bool is_loop = command == Feature::loops;
    const bool is_matrix = command == Feature::matrix;
    NestedObject own{[&](auto&& visit) {
      visit("max_memory", resources.memory_limit);
      if (is_loop) visit("frame_times", inputs.frame_times);
      if (is_matrix) visit("train_sequence", inputs.train_sequences);
      if (is_matrix) visit("speed", selection.speed);
      if (is_matrix) visit_fields(inputs.scores, visit);
      if (command == Feature::query) visit_fields(selection, visit);
      if (!is_loop && !is_matrix) visit("fuse", fuse);
    }};
    call.take(own);
    SequenceQuerySettings chosen;
    call.rest(chosen);
    chosen.loop = is_loop;
    std::vector<std::string> keys;
    for (const auto& item : call.keywords.items()) keys.push_back(item.key());
    Features run = {command};
    if (!is_loop && !is_matrix) run.push_back(Feature::database);
    if (!call.keywords.contains("method")) chosen.method = default_method(command, keys);
    if (!fuse.empty()) run.push_back(Feature::fuse);
    add_given_features(run, chosen, keys);
    settings = ResolvedSettings(chosen, run);
  }

  /// Adds what the settings need; fused views to a copy of the database.
  void prepare(const DatabasePointer& database, const Monitor& monitor) {
    inputs.database = {database, &database->sequences()};
    if (!fuse.empty()) inputs.database = std::make_shared<SequenceDatabase>(*inputs.database);
    prepare_database(*inputs.database, settings, fuse, monitor);
  }
};

using ResultPointer = std::shared_ptr<StoredResult>;
using Work = std::function<QueryRun(StoredResult& made, const Monitor& monitor)>;

// The work of a query with FAB-MAP's places.
Work place_work(const Call& call, const FabmapDatabase& database, NamedArgument query,
                const SelectionSettings& selection, bool is_loop) {
  FabmapQuerySettings settings;
  call.rest(settings);
  settings.loop = is_loop;
  return [=, &call, &database](StoredResult& made, const Monitor& monitor) mutable {
    query.sequence = selected(query.sequence, selection, {}, call.process.seed, monitor);
    set_query_path(made.context.run, query.sequence);
    const SequenceWords words =
        describe_words(open_sequence(query.sequence), database, settings.skip_unreadable, monitor);
    made.context.database_fingerprint = database.fingerprint;
    made.context.query_fingerprint = words_fingerprint(words);
    return query_fabmap(
        database, words, query.name, settings, call.process.seed, [](auto, auto) {}, monitor);
  };
}

// The work of a query by a sequence method.
Work window_work(Call& call, Feature command, const DatabasePointer& database,
                 const std::string& name, const py::object& source) {
  SequenceQuery by(call, command);
  if (command != Feature::matrix) {
    by.inputs.query = arguments_of({{name, source}}, "query").front();
  } else {
    by.inputs.query.name = name;
    by.inputs.query.sequence.speed = by.selection.speed;
    by.inputs.query.sequence.seed = call.process.seed;
    set_source(by.inputs.scores, source);
  }
  return [=, &call](StoredResult& made, const Monitor& monitor) mutable {
    if (command == Feature::query) {
      SequenceArgument& sequence = by.inputs.query.sequence;
      sequence = selected(sequence, by.selection, {}, call.process.seed, monitor);
      by.prepare(database, monitor);
      if (!by.fuse.empty()) made.context.run.paths["fuse"] = by.fuse;
      made.run.train =
          std::make_shared<const std::vector<TrainSequence>>(by.inputs.database->sequences);
    }
    const QueryData data = open_query(by.inputs, by.settings, made.context, monitor);
    return run_query(data, by.settings, by.resources, {}, made.context, monitor);
  };
}

ResultPointer query(const std::string& function, const DatabasePointer& database,
                    const std::string& name, const py::object& source, const std::string& text,
                    const py::object& progress) {
  Call call(function, text, progress);
  const Feature command = function == "vpr.query"   ? Feature::query
                          : function == "vpr.loops" ? Feature::loops
                                                    : Feature::matrix;
  Work work;
  if (database && std::holds_alternative<FabmapDatabase>(database->content)) {
    SelectionSettings selection;
    if (command == Feature::query) call.take(selection);
    work = place_work(call, std::get<FabmapDatabase>(database->content),
                      arguments_of({{name, source}}, "query").front(), selection,
                      command == Feature::loops);
  } else if (database && command == Feature::loops) {
    throw Error(ErrorKind::data, "loops of windows have no database. Omit it");
  } else {
    work = window_work(call, command, database, name, source);
  }
  const auto made = std::make_shared<StoredResult>();
  ResultContext& context = made->context;
  call.run([&](const Monitor& monitor) {
    const Stopwatch watch;
    context.run = call.run_info("vpr-query");
    if (database && !database->path.empty()) context.run.paths["database"] = database->path;
    QueryRun run = work(*made, monitor);
    context.seconds = std::move(run.seconds);
    context.seconds["total"] = watch.elapsed_s();
    made->run.paths = context.run.paths;
    made->run.frame_names = context.run.frame_names;
    made->run.database_fingerprint = context.database_fingerprint;
    made->result = std::move(run.result);
  });
  return made;
}

ResultPointer load(const std::filesystem::path& path) {
  const auto result = std::make_shared<StoredResult>();
  Call("vpr.load").run([&](const Monitor& monitor) { *result = read_result(path, monitor); });
  return result;
}

void save_result(const StoredResult& result, const std::filesystem::path& path, bool force) {
  if (!result.fingerprint.empty())
    throw Error(ErrorKind::usage, "the result was read from a file. Copy its files instead");
  save(force, [&](Outputs& outputs) {
    claim_result(path, outputs);
    write_result(path, result.result, result.context, outputs);
  });
}

// A copy, with columns as fields.
py::object array_named(const StoredResult& result, const std::string& name) {
  py::object found = py::none();
  visit_arrays(result.result, [&](const ResultArray& array) {
    if (array.name != name) return;
    py::object type = py::str(std::string(array.type));
    if (array.columns.size() > 1) {
      py::list fields;
      for (const auto column : array.columns) fields.append(py::make_tuple(column, type));
      type = fields;
    }
    found = py::array(py::dtype::from_args(type), array.rows, array.values.data());
  });
  if (found.is_none()) throw py::attribute_error("the result has no " + name);
  return found;
}

// A copy of the pixels.
std::shared_ptr<const cv::Mat> picture_of(const py::object& frame) {
  const auto pixels = py::array_t<uint8_t, py::array::c_style>::ensure(frame);
  if (!pixels || pixels.ndim() < 2 || pixels.ndim() > 3 ||
      (pixels.ndim() == 3 && pixels.shape(2) != 3))
    throw Error(ErrorKind::data,
                "an image has height x width gray levels, or height x width x 3 values (blue, "
                "green, red), of type uint8");
  const cv::Mat view(static_cast<int>(pixels.shape(0)), static_cast<int>(pixels.shape(1)),
                     pixels.ndim() == 2 ? CV_8UC1 : CV_8UC3, const_cast<uint8_t*>(pixels.data()));
  return std::make_shared<const cv::Mat>(view.clone());
}

struct Live {
  Call call;
  SequenceQuery by;
  std::optional<LiveLines> lines;

  Live(const DatabasePointer& database, const std::string& text)
      : call("vpr.Live", text), by(call, Feature::live) {
    call.run([&](const Monitor& monitor) {
      by.prepare(database, monitor);
      lines.emplace(*by.inputs.database, "live", by.settings, by.resources, monitor);
    });
  }

  py::object add(const py::object& frame, const std::string& name) {
    LiveFrame image;
    image.name = name;
    if (is_path(frame)) {
      image.file = path_of(frame);
      if (name.empty()) image.name = image.file.filename().string();
    } else if (by.inputs.database->descriptors.kind->is_imported && !frame.is_none()) {
      image.array = view_of(py::array(frame).attr("reshape")(1, -1), name);
    } else if (!frame.is_none()) {
      image.picture = picture_of(frame);
    }
    Json line;
    call.run([&](const Monitor& monitor) {
      line = frame.is_none() ? lines->take_missing(name) : lines->take(image, monitor);
    });
    return fields_of(line);
  }

  py::object finish() {
    std::optional<Json> line;
    call.run([&](const Monitor&) { line = lines->finish(); });
    return line ? fields_of(*line) : py::none();
  }
};

/// Frame distances of a query to all training frames, computed on request.
struct Distances {
  DatabasePointer database;
  DescriptorSet query;
  FrameDistances distances;
  std::pair<size_t, size_t> shape;  ///< query frames, training frames
  double unit = 1;                  ///< size of one step

  py::array row(py::ssize_t index) const {
    const auto frames = static_cast<py::ssize_t>(shape.first);
    if (index < -frames || index >= frames) throw py::index_error("no such query frame");
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    std::vector<uint16_t> values;
    {
      const py::gil_scoped_release release;
      compute_row(distances, static_cast<size_t>(index < 0 ? index + frames : index), values);
    }
    return py::array_t<uint16_t>(static_cast<py::ssize_t>(shape.second), values.data());
  }
};

py::object matrix_of(const py::object& rows, const py::object& type, const py::object&) {
  return py::module_::import("numpy").attr("array")(py::list(rows), type);
}

std::shared_ptr<Distances> distances(const DatabasePointer& database, const py::object& source,
                                     const std::string& text, const py::object& progress) {
  Call call("vpr.distances", text, progress);
  SelectionSettings selection;
  bool skip_unreadable = false;
  NestedObject inputs{[&](auto&& visit) { visit("skip_unreadable", skip_unreadable); }};
  call.take(selection);
  call.rest(inputs);
  const SequenceDatabase& sequences = database->sequences();
  const SequenceArgument query = arguments_of({{"", source}}, "query").front().sequence;
  const auto made = std::make_shared<Distances>();
  made->database = database;
  call.run([&](const Monitor& monitor) {
    made->query =
        describe_frames(open_sequence(selected(query, selection, {}, call.process.seed, monitor)),
                        sequences, skip_unreadable, monitor);
    made->distances = frame_distances(descriptor_spans(sequences), made->query.span());
    made->shape = {made->distances.query_frames, made->distances.train_frames};
    made->unit = distance_of(made->query.rows().shape.element).unit.size;
  });
  return made;
}

}  // namespace

void add_queries(py::module_& module) {
  using namespace py::literals;
  py::class_<StoredResult, ResultPointer>(
      module, "Result",
      "Matches of a query, from query, loops, query_scores or load. Its arrays are those of the\n"
      "result file (docs/reference/files.md), with columns as fields: recognitions,\n"
      "recognition_scores, best, best_scores, margins, path, keyframes, best_rates, new_place,\n"
      "source_frames, train_source_frames. Windows are identified by their first frame; -1 and\n"
      "NaN: no match.")
      .def("save", save_result, "path"_a, "force"_a = false,
           "Writes the result file of vpr-query and its arrays.")
      .def_property_readonly(
          "json",
          [](const StoredResult& made) {
            return fields_of(result_json(made.result, made.context));
          },
          "The content of the result file, without the checksums of arrays.")
      .def("__getattr__", array_named)
      .def("__repr__", [](const StoredResult& made) {
        return fmt::format("<vpr.Result: {} of {} frames of {} recognized; {}>",
                           recognized_windows(made.result), made.result.query.frames,
                           made.result.query.name, settings_text(made.result));
      });
  py::class_<Distances, std::shared_ptr<Distances>>(
      module, "Distances",
      "Frame distances of a query to all training frames, computed on request: d[i] is the row of\n"
      "query frame i, numpy.asarray(d) the matrix. Values are uint16; smaller is closer.")
      .def("__len__", [](const Distances& self) { return self.shape.first; })
      .def("__getitem__", &Distances::row)
      .def("__array__", matrix_of, "dtype"_a = py::none(), "copy"_a = py::none())
      .def_readonly("unit", &Distances::unit,
                    "Size of one step: 1 bit, or the fraction of a cosine or other distance.")
      .def_readonly("shape", &Distances::shape, "Query frames and training frames.");
  py::class_<Live>(module, "Live")
      .def(py::init<DatabasePointer, const std::string&>())
      .def("add", &Live::add)
      .def("finish", &Live::finish);
  module.def("query", query);
  module.def("load_result", load);
  module.def("distances", distances);
}

}  // namespace vpr
