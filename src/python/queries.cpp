// Queries, their results, live queries, and frame distances.
#include <opencv2/core.hpp>

#include "base/error.h"
#include "base/text.h"
#include "present/result_text.h"
#include "python/module.h"

namespace py = pybind11;

namespace vpr {
namespace {

using calls::DatabasePointer;
using calls::ResultPointer;

// Without a database: windows of loops.
ResultPointer query(Call& call, const DatabasePointer& database, const std::string& name,
                    const Source& source, bool is_loop) {
  const NamedArgument query = arguments_of({{name, source}}, "query").front();
  const QueryCommand command = is_loop ? QueryCommand::loops : QueryCommand::query;
  ResultPointer made;
  call.run([&](const Monitor& monitor) {
    made = calls::query(call.keywords, command, database, {query}, monitor);
  });
  return made;
}

ResultPointer load(const Call& call, const std::filesystem::path& path) {
  const auto result = std::make_shared<StoredResult>();
  call.run([&](const Monitor& monitor) { *result = read_result(path, monitor); });
  return result;
}

void save_result(const StoredResult& result, const std::filesystem::path& path, bool force) {
  save([&] { calls::save(result, path, force); });
}

// Writes a result as its file and arrays, also one that was read. Returns whether it was.
bool write_files(const StoredResult& result, const std::filesystem::path& path) {
  Call{{"vpr.Result", Json::object()}}.run([&](const Monitor&) {
    Outputs outputs(Existing::refuse);
    claim_result(path, outputs);
    write_result(path, result.result, result.context, outputs);
    outputs.commit();
  });
  return !result.fingerprint.empty();
}

// A result from write_files. `was_read`: it returned.
ResultPointer read_files(const Call& call, const std::filesystem::path& path, bool was_read) {
  const ResultPointer result = load(call, path);
  if (!was_read) result->fingerprint.clear();
  return result;
}

std::string headline(const StoredResult& made) {
  return fmt::format("{} of {} frames of {} recognized; {}", recognized_windows(made.result),
                     made.result.query.frames, made.result.query.name, settings_text(made.result));
}

// The headline and the longest ranges, for notebooks.
std::string shown(const StoredResult& made) {
  constexpr size_t kMostRanges = 10;
  const std::string ranges =
      ranges_text(made.result, recognized_ranges(made.result), kMostRanges, "range");
  return "<pre>" + html_escaped(headline(made) + "\n" + ranges) + "</pre>";
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
  if (!is_image || values.dtype().kind() != 'u' || values.itemsize() != 1)
    throw Error(ErrorKind::data,
                "an image has height x width gray levels, or height x width x 3 values (blue, "
                "green, red), of type uint8");
  const cv::Mat view(static_cast<int>(pixels.shape(0)), static_cast<int>(pixels.shape(1)),
                     is_color ? CV_8UC3 : CV_8UC1, const_cast<uint8_t*>(pixels.data()));
  return std::make_shared<const cv::Mat>(view.clone());
}

struct Live {
  Call call;
  std::unique_ptr<calls::Live> live;

  Live(Call given, const DatabasePointer& database) : call(std::move(given)) {
    call.run([&](const Monitor& monitor) {
      live = std::make_unique<calls::Live>(call.keywords, database, monitor);
    });
  }

  py::object add(const Source& frame, const std::string& name) {
    LiveFrame image;
    image.name = name;
    if (const auto* path = std::get_if<std::filesystem::path>(&frame)) {
      if (path->empty()) throw Error(ErrorKind::usage, "the path of the frame is empty");
      image.file = *path;
      if (name.empty()) image.name = path->filename().string();
    } else if (const auto& values = std::get<py::object>(frame); !values.is_none()) {
      if (live->has_arrays())
        image.array = view_of(array_of(values, "frame").attr("reshape")(1, -1),
                              name.empty() ? "frame" : name);
      else
        image.picture = picture_of(values);
    }
    Json line;
    call.run(
        [&](const Monitor& monitor) { line = live->lines().line(live->take(image, monitor)); });
    return fields_of(line);
  }

  py::object finish() {
    Json line;  // null becomes None
    call.run([&](const Monitor&) {
      if (const auto result = live->finish()) line = live->lines().line(result);
    });
    return fields_of(line);
  }
};

/// Frame distances of a query to all training frames, computed on request.
struct Distances {
  DatabasePointer database;
  DescriptorSet query;
  FrameDistances distances;
  std::vector<uint8_t> readable;    ///< of each training frame: 1 or 0
  std::pair<size_t, size_t> shape;  ///< query frames, training frames

  py::array row(py::ssize_t index) const {
    const auto frames = static_cast<py::ssize_t>(shape.first);
    if (index < -frames || index >= frames) throw py::index_error("no such query frame");
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    std::vector<uint16_t> values;
    {
      const py::gil_scoped_release release;
      compute_row(distances, static_cast<size_t>((index + frames) % frames), values);
      for (size_t i = 0; i < readable.size(); ++i)
        if (readable[i] == 0) values[i] = std::numeric_limits<uint16_t>::max();
    }
    return py::array_t<uint16_t>(static_cast<py::ssize_t>(shape.second), values.data());
  }
};

std::shared_ptr<Distances> distances(Call& call, const DatabasePointer& database,
                                     const Source& source) {
  call.keywords.read();
  const SequenceArgument query = arguments_of({{"", source}}, "query").front().sequence;
  const SequenceDatabase& sequences = database->sequences();
  const auto made = std::make_shared<Distances>();
  made->database = database;
  call.run([&](const Monitor& monitor) {
    made->query = describe_frames(open_sequence(query), sequences, false, monitor);
    made->distances = frame_distances(descriptor_spans(sequences), made->query.span());
    made->readable = readable_flags(made->distances.train_runs, made->distances.train_frames);
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
      "best_scores, margins, path, witness, keyframes, new_place, past, source_frames,\n"
      "train_source_frames.\n"
      "Windows are identified by their first frame; -1 and NaN: no match.")
      .def_static("__new__", refuse_new)
      .def("save", save_result, py::call_guard<InCall>(), "path"_a, "force"_a = false,
           "Writes the result file of vpr-query and its arrays.")
      .def_property_readonly("json",
                             py::cpp_function(
                                 [](const StoredResult& made) {
                                   return fields_of(result_json(made.result, made.context));
                                 },
                                 py::call_guard<InCall>()),
                             "The content of the result file, without the checksums of arrays.")
      .def("__getattr__", array_named, py::call_guard<InCall>())
      .def("__reduce__",
           [](const py::object& result) {
             return py::module_::import("vpr").attr("_pickled")(result);
           })
      .def("_repr_html_", shown, py::call_guard<InCall>())
      .def(
          "__repr__",
          [](const StoredResult& made) { return "<vpr.Result: " + headline(made) + ">"; },
          py::call_guard<InCall>());
  py::class_<Distances, std::shared_ptr<Distances>>(
      module, "Distances",
      "Frame distances of a query to all training frames, computed on request: d[i] is the row of\n"
      "query frame i, numpy.asarray(d) the matrix. Values are uint16; smaller is closer. That to "
      "a\n"
      "training frame that cannot be decoded is 65535.")
      .def_static("__new__", refuse_new)
      .def("__len__", [](const Distances& self) { return self.shape.first; })
      .def("__getitem__", &Distances::row, py::call_guard<InCall>())
      .def(
          "__array__",
          [](const py::object& rows, const py::object& type, const py::object&) -> py::object {
            return py::module_::import("numpy").attr("array")(py::list(rows), type);
          },
          py::call_guard<InCall>(), "dtype"_a = py::none(), "copy"_a = py::none())
      .def_readonly("shape", &Distances::shape, "Query frames and training frames.");
  py::class_<Live>(module, "Live")
      .def(py::init<Call, DatabasePointer>(), py::call_guard<InCall>())
      .def("add", &Live::add, py::call_guard<InCall>())
      .def("finish", &Live::finish, py::call_guard<InCall>());
  module.def("query", query, py::call_guard<InCall>());
  module.def("load_result", load, py::call_guard<InCall>());
  module.def("write_result", write_files, py::call_guard<InCall>());
  module.def("read_result", read_files, py::call_guard<InCall>());
  module.def("distances", distances, py::call_guard<InCall>());
}

}  // namespace vpr
