// Queries, their results, and frame distances.
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "base/error.h"
#include "base/parallel.h"
#include "base/stopwatch.h"
#include "fabmap/place_query.h"
#include "loops/sequence_query.h"
#include "python/module.h"
#include "run/open.h"
#include "truth/times.h"

namespace py = pybind11;

namespace vpr {

QueryChoices::QueryChoices(Call& call, Feature command)
    : resources{select_kernels(), kDefaultMemoryLimit, 0, call.process.seed} {
  const bool is_loop = command == Feature::loops;
  const bool is_matrix = command == Feature::matrix;
  NestedObject inputs{[&](auto&& visit) {
    visit("max_memory", resources.memory_limit);
    if (is_loop) visit("frame_times", frame_times);
    if (is_matrix) visit("train_sequence", train_sequence);
    if (is_matrix) visit("speed", speed);
    if (!is_loop && !is_matrix) visit("fuse", fuse);
  }};
  call.take(inputs);
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

std::shared_ptr<SequenceDatabase> QueryChoices::prepare(const DatabasePointer& database,
                                                        const Monitor& monitor) const {
  std::shared_ptr<SequenceDatabase> sequences(database, &database->sequences());
  if (!fuse.empty()) sequences = std::make_shared<SequenceDatabase>(*sequences);
  prepare_database(*sequences, settings, fuse, monitor);
  if (sequences->fingerprint.empty()) sequences->fingerprint = database_fingerprint(*sequences);
  return sequences;
}

namespace {

using ResultPointer = std::shared_ptr<StoredResult>;

// Runs a query, and completes its context. `database`: null for none.
ResultPointer queried(const Call& call, const Database* database,
                      const std::function<QueryRun(StoredResult&, const Monitor&)>& query) {
  const auto made = std::make_shared<StoredResult>();
  ResultContext& context = made->context;
  call.run([&](const Monitor& monitor) {
    const Stopwatch watch;
    context.run = call.run_info("vpr-query");
    context.run.simd_target = select_kernels().target;
    if (database != nullptr && !database->path.empty())
      context.run.paths["database"] = database->path;
    QueryRun run = query(*made, monitor);
    context.seconds = std::move(run.seconds);
    context.seconds["total"] = watch.elapsed_s();
    made->run.paths = context.run.paths;
    made->run.frame_names = context.run.frame_names;
    made->run.database_fingerprint = context.database_fingerprint;
    made->result = std::move(run.result);
  });
  return made;
}

ResultPointer query_places(const Call& call, Database& database, NamedArgument query,
                           const SelectionSettings& selection, bool is_loop) {
  auto* fabmap = std::get_if<FabmapDatabase>(&database.content);
  if (fabmap == nullptr) throw Error(ErrorKind::data, "loops of windows have no database. Omit it");
  FabmapQuerySettings settings;
  call.rest(settings);
  settings.loop = is_loop;
  return queried(call, &database, [&](StoredResult& made, const Monitor& monitor) {
    query.sequence = selected(query.sequence, selection, {}, call.process.seed, monitor);
    set_query_path(made.context.run, query.sequence);
    const SequenceWords words =
        describe_words(open_sequence(query.sequence), *fabmap, settings.skip_unreadable, monitor);
    if (fabmap->fingerprint.empty()) fabmap->fingerprint = database_fingerprint(*fabmap);
    made.context.database_fingerprint = fabmap->fingerprint;
    made.context.query_fingerprint = words_fingerprint(words);
    return query_fabmap(
        *fabmap, words, query.name, settings, call.process.seed, [](auto, auto) {}, monitor);
  });
}

ResultPointer query(const DatabasePointer& database, const std::string& name,
                    const py::object& source, const std::string& text, const py::object& progress) {
  Call call("vpr.query", text, progress);
  NamedArgument query = arguments_of({{name, source}}).front();
  SelectionSettings selection;
  call.take(selection);
  if (std::holds_alternative<FabmapDatabase>(database->content))
    return query_places(call, *database, query, selection, false);
  const QueryChoices by(call, Feature::query);
  return queried(call, database.get(), [&](StoredResult& made, const Monitor& monitor) {
    if (!by.fuse.empty()) made.context.run.paths["fuse"] = by.fuse;
    query.sequence = selected(query.sequence, selection, {}, call.process.seed, monitor);
    const auto trained = by.prepare(database, monitor);
    made.run.train = std::make_shared<const std::vector<TrainSequence>>(trained->sequences);
    return run_query(describe_for(trained, query, by.settings, made.context, monitor), by.settings,
                     by.resources, {}, made.context, monitor);
  });
}

ResultPointer loops(const DatabasePointer& database, const std::string& name,
                    const py::object& source, const std::string& text, const py::object& progress) {
  Call call("vpr.loops", text, progress);
  const NamedArgument query = arguments_of({{name, source}}).front();
  if (database) return query_places(call, *database, query, {}, true);
  const QueryChoices by(call, Feature::loops);
  return queried(call, nullptr, [&](StoredResult& made, const Monitor& monitor) {
    return run_query(describe_loop(query, by.frame_times, *by.settings, made.context, monitor),
                     by.settings, by.resources, {}, made.context, monitor);
  });
}

ResultPointer query_scores(const py::object& source, const std::string& name,
                           const std::string& text, const py::object& progress) {
  Call call("vpr.query_scores", text, progress);
  ScoreInput scores = scores_of(source);
  call.take(scores);
  const QueryChoices by(call, Feature::matrix);
  return queried(call, nullptr, [&](StoredResult& made, const Monitor& monitor) {
    if (!scores.array) made.context.run.paths["scores"] = scores.path;
    const QueryData data = open_scores(scores, name, by.train_sequence, by.speed, call.process.seed,
                                       made.context, monitor);
    return run_query(data, by.settings, by.resources, {}, made.context, monitor);
  });
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

py::object array_named(const StoredResult& result, const std::string& name) {
  py::object found = py::none();
  visit_arrays(result.result, [&](const ResultArray& array) {
    if (array.name == name) found = array_of(array);
  });
  if (found.is_none()) throw py::attribute_error("the result has no " + name);
  return found;
}

/// Frame distances of a query to all training frames, computed on request.
struct Distances {
  DatabasePointer database;
  DescriptorSet query;
  FrameDistances distances;
  std::pair<size_t, size_t> shape;  ///< query frames, training frames
  double unit = 1;                  ///< size of one step

  py::array rows(size_t first, size_t count) const {
    py::array_t<uint16_t> matrix({count, shape.second});
    uint16_t* out = matrix.mutable_data();
    Call("vpr.distances").run([&](const Monitor& monitor) {
      parallel_for(count, monitor, [&](size_t i) {
        std::vector<uint16_t> row(shape.second + kBlockFrames);
        compute_row(distances, first + i, row);
        std::copy_n(row.begin(), shape.second, out + i * shape.second);
      });
    });
    return matrix;
  }

  py::object row(py::ssize_t index) const {
    const auto frames = static_cast<py::ssize_t>(shape.first);
    if (index < -frames || index >= frames) throw py::index_error("no such query frame");
    return rows(static_cast<size_t>(index < 0 ? index + frames : index), 1)[py::int_(0)];
  }

  py::object matrix(const py::object& type, const py::object&) const {
    py::object all = rows(0, shape.first);
    return type.is_none() ? all : all.attr("astype")(type);
  }
};

std::shared_ptr<Distances> distances(const DatabasePointer& database, const py::object& source,
                                     const std::string& text, const py::object& progress) {
  Call call("vpr.distances", text, progress);
  SelectionSettings selection;
  bool skip_unreadable = false;
  NestedObject inputs{[&](auto&& visit) { visit("skip_unreadable", skip_unreadable); }};
  call.take(selection);
  call.rest(inputs);
  const SequenceDatabase& sequences = database->sequences();
  const SequenceArgument query = sequence_of(source, "query");
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
          [](const StoredResult& self) {
            return fields_of(result_json(self.result, self.context));
          },
          "The content of the result file, without the checksums of arrays.")
      .def("__getattr__", array_named);
  py::class_<Distances, std::shared_ptr<Distances>>(
      module, "Distances",
      "Frame distances of a query to all training frames, computed on request: d[i] is the row of\n"
      "query frame i, numpy.asarray(d) the matrix. Values are uint16; smaller is closer.")
      .def("__len__", [](const Distances& self) { return self.shape.first; })
      .def("__getitem__", &Distances::row)
      .def("__array__", &Distances::matrix, "dtype"_a = py::none(), "copy"_a = py::none())
      .def_readonly("unit", &Distances::unit,
                    "Size of one step: 1 bit, or the fraction of a cosine or other distance.")
      .def_readonly("shape", &Distances::shape, "Query frames and training frames.");
  module.def("query", query);
  module.def("loops", loops);
  module.def("query_scores", query_scores);
  module.def("load_result", load);
  module.def("distances", distances);
}

}  // namespace vpr
