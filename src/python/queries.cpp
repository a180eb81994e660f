// Queries, their results, live queries, and frame distances.
#include <opencv2/core.hpp>

#include "base/error.h"
#include "base/stopwatch.h"
#include "fabmap/place_query.h"
#include "files/live_lines.h"
#include "files/run_info.h"
#include "loops/sequence_query.h"
#include "present/result_text.h"
#include "python/module.h"
#include "run/open.h"
#include "truth/times.h"

namespace py = pybind11;

namespace vpr {
namespace {

/// A query by a sequence method, from the keywords of a call.
struct SequenceQuery {
  QueryInputs inputs;
  SelectionSettings selection;
  QueryResources resources;
  ResolvedSettings settings;

  /// `command`: of vpr-query.
  SequenceQuery(Call& call, Feature command) {
    const bool is_loop = command == Feature::loops;
    SequenceQuerySettings chosen;
    NestedObject own{[&](auto&& visit) {
      visit("max_memory", resources.memory_limit);
      if (command == Feature::query) visit_fields(selection, visit);
      if (is_loop) visit("frame_times", inputs.frame_times);
    }};
    call.read(own, chosen);
    resources.seed = call.process.seed;
    chosen.loop = is_loop;
    std::vector<std::string> keys;
    for (const auto& item : call.keywords.items()) keys.push_back(item.key());
    Features run = {command};
    if (!is_loop) run.push_back(Feature::database);
    if (!call.keywords.contains("method")) chosen.method = default_method(command, keys);
    add_given_features(run, chosen, keys);
    settings = ResolvedSettings(chosen, run);
  }

  /// Adds what the settings need.
  void prepare(const DatabasePointer& database, const Monitor& monitor) {
    inputs.database = {database, &database->sequences()};
    prepare_database(*inputs.database, settings, monitor);
  }

  QueryRun run(ResultContext& context, const Monitor& monitor) const {
    const QueryData data = open_query(inputs, settings, context, monitor);
    return run_query(data, settings, resources, {}, context, monitor);
  }
};

using ResultPointer = std::shared_ptr<StoredResult>;

// The result of a query, which adds its own inputs to the context.
ResultPointer result_of(
    const Call& call, const DatabasePointer& database,
    const std::function<QueryRun(ResultContext& context, const Monitor& monitor)>& query) {
  const auto made = std::make_shared<StoredResult>();
  call.run([&](const Monitor& monitor) {
    const Stopwatch watch;
    ResultContext& context = made->context;
    context.run = run_of("vpr-query", {call.function}, call.process.seed);
    if (database && !database->path.empty()) context.run.paths["database"] = database->path;
    QueryRun run = query(context, monitor);
    made->result = std::move(run.result);
    context.seconds = std::move(run.seconds);
    context.seconds["total"] = watch.elapsed_s();
  });
  return made;
}

ResultPointer query_places(Call& call, const DatabasePointer& database, NamedArgument query,
                           bool is_loop) {
  SelectionSettings selection;
  FabmapQuerySettings settings;
  is_loop ? call.read(settings) : call.read(settings, selection);
  settings.loop = is_loop;
  const auto& places = std::get<FabmapDatabase>(database->content);
  return result_of(call, database, [&](ResultContext& context, const Monitor& monitor) {
    query.sequence = selected(query.sequence, selection, {}, call.process.seed, monitor);
    set_query_path(context.run, query.sequence);
    const SequenceWords words =
        describe_words(open_sequence(query.sequence), places, settings.skip_unreadable, monitor);
    context.database_fingerprint = places.fingerprint;
    context.query_fingerprint = words_fingerprint(words);
    return query_fabmap(
        places, words, query.name, settings, call.process.seed, [](auto, auto) {}, monitor);
  });
}

// Without a database: windows of loops.
ResultPointer query(Call& call, const DatabasePointer& database, const std::string& name,
                    const Source& source, bool is_loop) {
  const NamedArgument query = arguments_of({{name, source}}, "query").front();
  if (database && std::holds_alternative<FabmapDatabase>(database->content))
    return query_places(call, database, query, is_loop);
  if (database && is_loop)
    throw Error(ErrorKind::data, "loops of windows have no database. Omit it");
  SequenceQuery by(call, is_loop ? Feature::loops : Feature::query);
  by.inputs.query = query;
  if (is_loop) return result_of(call, nullptr, std::bind_front(&SequenceQuery::run, &by));
  return result_of(call, database, [&](ResultContext& context, const Monitor& monitor) {
    SequenceArgument& sequence = by.inputs.query.sequence;
    sequence = selected(sequence, by.selection, {}, call.process.seed, monitor);
    by.prepare(database, monitor);
    context.train =
        std::make_shared<const std::vector<TrainSequence>>(by.inputs.database->sequences);
    return by.run(context, monitor);
  });
}

ResultPointer load(const Call& call, const std::filesystem::path& path) {
  const auto result = std::make_shared<StoredResult>();
  call.run([&](const Monitor& monitor) { *result = read_result(path, monitor); });
  return result;
}

void save_result(const StoredResult& result, const std::filesystem::path& path, bool force) {
  if (!result.fingerprint.empty())
    throw Error(ErrorKind::usage, "the result was read from a file. Copy its files instead");
  save(force, result.context.run, [&](Outputs& outputs) {
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
  const py::array values = array_of(frame, "frame");
  const auto pixels = py::array_t<uint8_t, py::array::c_style>::ensure(values);
  const bool is_color = pixels && pixels.ndim() == 3 && pixels.shape(2) == 3;
  const bool is_image = pixels && pixels.size() > 0 && (is_color || pixels.ndim() == 2);
  if (!is_image || !values.dtype().is(py::dtype::of<uint8_t>()))
    throw Error(ErrorKind::data,
                "an image has height x width gray levels, or height x width x 3 values (blue, "
                "green, red), of type uint8");
  const cv::Mat view(static_cast<int>(pixels.shape(0)), static_cast<int>(pixels.shape(1)),
                     is_color ? CV_8UC3 : CV_8UC1, const_cast<uint8_t*>(pixels.data()));
  return std::make_shared<const cv::Mat>(view.clone());
}

struct Live {
  Call call;
  SequenceQuery by;
  std::optional<LiveLines> lines;
  bool is_finished = false;

  Live(Call given, const DatabasePointer& database)
      : call(std::move(given)), by(call, Feature::live) {
    call.run([&](const Monitor& monitor) {
      by.prepare(database, monitor);
      lines.emplace(*by.inputs.database, "live", by.settings, by.resources, monitor);
    });
  }

  py::object add(const Source& frame, const std::string& name) {
    if (is_finished) throw Error(ErrorKind::usage, "the query is finished. Make another vpr.Live");
    LiveFrame image;
    image.name = name;
    if (const auto* path = std::get_if<std::filesystem::path>(&frame)) {
      if (path->empty()) throw Error(ErrorKind::usage, "the path of the frame is empty");
      image.file = *path;
      if (name.empty()) image.name = path->filename().string();
    } else if (const auto& values = std::get<py::object>(frame); !values.is_none()) {
      if (by.inputs.database->descriptors.kind->is_imported)
        image.array = view_of(array_of(values, "frame").attr("reshape")(1, -1), name);
      else
        image.picture = picture_of(values);
    }
    Json line;
    call.run([&](const Monitor& monitor) { line = *lines->take(image, monitor); });
    return fields_of(line);
  }

  py::object finish() {
    is_finished = true;
    Json line;  // null becomes None
    call.run([&](const Monitor&) { line = lines->finish().value_or(Json()); });
    return fields_of(line);
  }
};

/// Frame distances of a query to all training frames, computed on request.
struct Distances {
  DatabasePointer database;
  DescriptorSet query;
  FrameDistances distances;
  std::pair<size_t, size_t> shape;  ///< query frames, training frames

  py::array row(py::ssize_t index) const {
    const auto frames = static_cast<py::ssize_t>(shape.first);
    if (index < -frames || index >= frames) throw py::index_error("no such query frame");
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    std::vector<uint16_t> values;
    {
      const py::gil_scoped_release release;
      compute_row(distances, static_cast<size_t>((index + frames) % frames), values);
    }
    return py::array_t<uint16_t>(static_cast<py::ssize_t>(shape.second), values.data());
  }
};

std::shared_ptr<Distances> distances(Call& call, const DatabasePointer& database,
                                     const Source& source) {
  call.read();
  const SequenceArgument query = arguments_of({{"", source}}, "query").front().sequence;
  const SequenceDatabase& sequences = database->sequences();
  const auto made = std::make_shared<Distances>();
  made->database = database;
  call.run([&](const Monitor& monitor) {
    made->query = describe_frames(open_sequence(query), sequences, false, monitor);
    made->distances = frame_distances(descriptor_spans(sequences), made->query.span());
    made->shape = {made->distances.query_frames, made->distances.train_frames};
  });
  return made;
}

}  // namespace

void add_queries(py::module_& module) {
  using namespace py::literals;
  py::class_<StoredResult, ResultPointer>(
      module, "Result",
      "Matches of a query, from query, loops or load. Its arrays are those of the result file\n"
      "(docs/reference/files.md), with columns as fields: recognitions, recognition_scores, best,\n"
      "best_scores, margins, path, keyframes, new_place, source_frames, train_source_frames.\n"
      "Windows are identified by their first frame; -1 and NaN: no match.")
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
      .def(
          "__array__",
          [](const py::object& rows, const py::object& type, const py::object&) -> py::object {
            return py::module_::import("numpy").attr("array")(py::list(rows), type);
          },
          "dtype"_a = py::none(), "copy"_a = py::none())
      .def_readonly("shape", &Distances::shape, "Query frames and training frames.");
  py::class_<Live>(module, "Live")
      .def(py::init<Call, DatabasePointer>())
      .def("add", &Live::add)
      .def("finish", &Live::finish);
  module.def("query", query);
  module.def("load_result", load);
  module.def("distances", distances);
}

}  // namespace vpr
