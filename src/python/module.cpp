// The Python module _vpr: each function reads settings, runs the steps of one program, and returns
// their values. vpr/__init__.py has the interface of users.
#include <variant>

#include <opencv2/core.hpp>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "base/checksum.h"
#include "base/error.h"
#include "base/parallel.h"
#include "base/provenance.h"
#include "base/simd.h"
#include "base/stopwatch.h"
#include "describe/imported.h"
#include "fabmap/place_query.h"
#include "files/report_json.h"
#include "present/evaluation_page.h"
#include "present/recorded_frames.h"
#include "present/report_tables.h"
#include "python/call.h"
#include "run/advice.h"
#include "run/live_query.h"
#include "run/open.h"
#include "run/train_sequences.h"
#include "sequence/live_source.h"
#include "store/archive.h"
#include "truth/times.h"

namespace py = pybind11;
namespace fs = std::filesystem;

namespace vpr {
namespace {

/// A database of either family.
struct Database {
  std::variant<SequenceDatabase, FabmapDatabase> content;
  std::string path;  ///< from which it was read; empty: trained by this process

  SequenceDatabase& sequences() {
    if (auto* found = std::get_if<SequenceDatabase>(&content)) return *found;
    throw Error(ErrorKind::data, "the database is for fabmap, which has no frame descriptors");
  }
};
using DatabasePointer = std::shared_ptr<Database>;

/// A result, and what its files need beyond it.
struct QueryResult {
  StoredResult stored;
  std::optional<ResultContext> context;  ///< nullopt: read from a file
};

struct EvaluationReport {
  Evaluation evaluation;
  Report report;
  RecordedRun recorded;
  RunInfo run;
  double seconds = 0;
};

/// How frames are selected and arrays imported, by the names of flags.
struct SelectionSettings {
  std::optional<double> fps;
  std::optional<double> recorded_fps;
  std::string speed;
};
VPR_FIELDS(SelectionSettings, fps, recorded_fps, speed)
struct ImportSettings {
  DescriptorMetric metric = DescriptorMetric::cosine;
  uint64_t value_bits = 16;
};
VPR_FIELDS(ImportSettings, metric, value_bits)

SequenceArgument selected(SequenceArgument argument, const SelectionSettings& settings,
                          const CallSettings& call, const Monitor& monitor) {
  if (settings.fps) check_fps(*settings.fps, "fps");
  if (settings.recorded_fps) check_fps(*settings.recorded_fps, "recorded_fps");
  if (!settings.speed.empty()) check_speed(settings.speed);
  argument.speed = settings.speed;
  argument.seed = call.seed;
  return with_rate(std::move(argument), {{}, settings.recorded_fps}, settings.fps, monitor);
}

// A view of a NumPy array, which it keeps. Only an array in neither C nor Fortran order is copied.
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

// The sequence of a path, as on the command line, or of an array with one row per frame.
SequenceArgument sequence_of(const py::object& source, const std::string& name) {
  if (!py::isinstance<py::array>(source)) return parse_sequence_argument(py::str(source));
  SequenceArgument argument{name, {}};
  argument.array = view_of(source, name);
  return argument;
}

/// Sources with their names; empty names are those of the paths.
using Sources = std::vector<std::pair<std::string, py::object>>;

std::vector<NamedArgument> arguments_of(const Sources& sources) {
  std::vector<SequenceArgument> arguments;
  for (const auto& [name, source] : sources) arguments.push_back(sequence_of(source, name));
  const std::vector<std::string> names = sequence_names(arguments);
  std::vector<NamedArgument> named;
  for (size_t i = 0; i < arguments.size(); ++i)
    named.push_back({sources[i].first.empty() ? names[i] : sources[i].first, arguments[i]});
  return named;
}

py::object from_json(const Json& json) {
  return py::module_::import("vpr").attr("_read")(to_line(json));
}

// A view of memory that `owner` keeps.
py::array read_only(const char* type, const std::vector<size_t>& shape, const void* data,
                    const py::object& owner) {
  py::array array(py::dtype(type), shape, data, owner);
  array.attr("flags").attr("writeable") = false;
  return array;
}

void save(bool force, const std::function<void(Outputs& outputs)>& write) {
  run_call({}, py::none(), [&](const Monitor&) {
    Outputs outputs(force ? Existing::replace : Existing::refuse);
    write(outputs);
    outputs.commit();
  });
}

DatabasePointer train(const Sources& sources, const Sources& pretrain, const std::string& text,
                      const py::object& progress) {
  Keywords keywords("vpr.train", text);
  const auto call = keywords.take<CallSettings>();
  std::vector<NamedArgument> named = arguments_of(sources);
  const auto database = std::make_shared<Database>();
  if (!pretrain.empty()) {
    const auto settings = keywords.rest<FabmapTrainSettings>();
    std::vector<SequenceArgument> other;
    for (const NamedArgument& one : arguments_of(pretrain)) other.push_back(one.sequence);
    std::vector<GroupArgument> groups;
    for (const NamedArgument& one : named) groups.push_back({one.name, one.sequence});
    run_call(call, progress, [&](const Monitor& monitor) {
      database->content = train_fabmap(other, groups, settings, call.seed, monitor);
    });
    return database;
  }
  const auto selection = keywords.take<SelectionSettings>();
  const auto import = keywords.take<ImportSettings>();
  auto settings = keywords.rest<SequenceTrainSettings>();
  run_call(call, progress, [&](const Monitor& monitor) {
    for (NamedArgument& one : named)
      one.sequence = selected(one.sequence, selection, call, monitor);
    const SequenceSource first = open_sequence(named.at(0).sequence);
    if (first.kind == SequenceKind::descriptors)
      settings.descriptor_kind =
          imported_kind(ArrayRows(first).type().starts_with('|'), import.metric, import.value_bits);
    database->content = train_sequences(named, settings, select_kernels(), monitor);
  });
  return database;
}

DatabasePointer load_database(const fs::path& path) {
  const auto database = std::make_shared<Database>();
  database->path = path.string();
  run_call({}, py::none(), [&](const Monitor&) {
    if (database_family(path) == DatabaseFamily::fabmap)
      database->content = read_fabmap_database(path);
    else
      database->content = read_sequence_database(path);
  });
  return database;
}

void save_database(const Database& database, const fs::path& path, bool force) {
  save(force, [&](Outputs& outputs) {
    outputs.claim_folder(path, is_database_folder);
    if (const auto* sequences = std::get_if<SequenceDatabase>(&database.content))
      write_sequence_database(path, *sequences, outputs);
    else
      write_fabmap_database(path, std::get<FabmapDatabase>(database.content), outputs);
  });
}

std::vector<std::string> names_of(const Database& database) {
  std::vector<std::string> names;
  if (const auto* sequences = std::get_if<SequenceDatabase>(&database.content))
    for (const TrainSequence& train : sequences->sequences) names.push_back(train.sequence.name);
  else
    for (const ViewGroup& group : std::get<FabmapDatabase>(database.content).groups)
      names.push_back(group.sequence.name);
  return names;
}

py::array descriptors_of(const DatabasePointer& database) {
  const DescriptorRows rows = database->sequences().descriptors.rows();
  const ElementType element = rows.shape.element;
  const bool is_wide = element == ElementType::int16 || element == ElementType::points16;
  return read_only(is_wide                        ? "i2"
                   : element == ElementType::int8 ? "i1"
                                                  : "u1",
                   {rows.size(), rows.shape.row_bytes() / (is_wide ? 2 : 1)}, rows.bytes.data(),
                   py::cast(database));
}

ResolvedSettings resolved(const Keywords& keywords, Feature command) {
  auto settings = keywords.rest<SequenceQuerySettings>();
  const std::vector<std::string> given = keywords.keys();
  if (std::ranges::count(given, "method") == 0) settings.method = default_method(given);
  settings.loop = false;
  Features run = {command, Feature::database};
  const Features implied = given_features(settings, given);
  run.insert(run.end(), implied.begin(), implied.end());
  return {settings, run};
}

QueryRun query_sequences(SequenceDatabase& database, const NamedArgument& query,
                         const ResolvedSettings& settings, const QueryResources& resources,
                         ResultContext& context, const Monitor& monitor) {
  prepare_database(database, settings, "", monitor);
  const DescriptorSet described = describe_query(query.sequence, database, settings, monitor);
  if (database.fingerprint.empty()) database.fingerprint = database_fingerprint(database);
  context.database_fingerprint = database.fingerprint;
  context.query_fingerprint = checksum(std::as_bytes(described.rows().bytes));
  context.run.memory_limit = resources.memory_limit;
  QueryPlan plan = plan_query(database, described, query.name, settings, resources, monitor);
  QueryRun run = run_query(std::move(plan), settings, resources, {}, monitor);
  if (const auto sentence = excess_advice(run.result)) warn(monitor, *sentence);
  return run;
}

QueryRun query_places(const FabmapDatabase& database, const NamedArgument& query,
                      const FabmapQuerySettings& settings, uint64_t seed, ResultContext& context,
                      const Monitor& monitor) {
  const SequenceWords words =
      describe_words(open_sequence(query.sequence), database, settings.skip_unreadable, monitor);
  context.database_fingerprint = database.fingerprint;
  context.query_fingerprint = words_fingerprint(words);
  return query_fabmap(
      database, words, query.name, settings, seed, [](auto, auto) {}, monitor);
}

std::shared_ptr<QueryResult> query(Database& database, const std::string& name,
                                   const py::object& source, const std::string& text,
                                   const py::object& progress) {
  Keywords keywords("vpr.query", text);
  const auto call = keywords.take<CallSettings>();
  const auto selection = keywords.take<SelectionSettings>();
  const auto memory = keywords.take<MemorySettings>();
  auto* sequences = std::get_if<SequenceDatabase>(&database.content);
  std::optional<ResolvedSettings> settings;
  FabmapQuerySettings of_places;
  if (sequences != nullptr)
    settings = resolved(keywords, Feature::query);
  else
    of_places = keywords.rest<FabmapQuerySettings>();
  NamedArgument query = arguments_of({{name, source}}).front();
  const auto made = std::make_shared<QueryResult>();
  ResultContext& context = made->context.emplace();
  RecordedRun& recorded = made->stored.run;
  run_call(call, progress, [&](const Monitor& monitor) {
    const Stopwatch watch;
    const QueryResources resources{select_kernels(), memory.max_memory, 0, call.seed};
    context.run = run_info("vpr-query", "vpr.query", call);
    context.run.simd_target = resources.kernels.target;
    if (!database.path.empty()) context.run.paths["database"] = database.path;
    set_query_path(context.run, query.sequence);
    query.sequence = selected(query.sequence, selection, call, monitor);
    QueryRun run = sequences != nullptr
                       ? query_sequences(*sequences, query, *settings, resources, context, monitor)
                       : query_places(std::get<FabmapDatabase>(database.content), query, of_places,
                                      call.seed, context, monitor);
    context.seconds = std::move(run.seconds);
    context.seconds["total"] = watch.elapsed_s();
    recorded = {context.run.paths, context.run.frame_names, context.database_fingerprint};
    if (sequences != nullptr)
      recorded.train = std::make_shared<const std::vector<TrainSequence>>(sequences->sequences);
    made->stored.result = std::move(run.result);
  });
  return made;
}

std::shared_ptr<QueryResult> load_result(const fs::path& path) {
  const auto result = std::make_shared<QueryResult>();
  run_call({}, py::none(),
           [&](const Monitor& monitor) { result->stored = read_result(path, monitor); });
  return result;
}

void save_result(const QueryResult& result, const fs::path& path, bool force) {
  if (!result.context)
    throw Error(ErrorKind::usage, "the result was read from a file. Copy its files instead");
  save(force, [&](Outputs& outputs) {
    claim_result(path, outputs);
    write_result(path, result.stored.result, *result.context, outputs);
  });
}

// An array of a result by the name of its file, with its columns as fields.
py::object array_of(const QueryResult& result, const std::string& name) {
  py::object found = py::none();
  visit_arrays(result.stored.result, [&](const ResultArray& array) {
    if (array.name != name) return;
    py::list fields;
    for (const std::string_view column : array.columns)
      fields.append(py::make_tuple(column, array.type));
    const py::dtype type = array.columns.size() > 1 ? py::dtype::from_args(fields)
                                                    : py::dtype(std::string(array.type));
    found = py::array(type, array.rows, array.values.data());
  });
  if (found.is_none()) throw py::attribute_error("the result has no " + name);
  return found;
}

/// The settings of an evaluation, by the names of flags.
struct JudgeSettings {
  std::optional<Confidence> confidence;
  std::vector<uint64_t> recall_at;
  uint64_t stretch = kDefaultStretch;
  std::string places;
  std::string poses;
  std::string name;
};
VPR_FIELDS(JudgeSettings, confidence, recall_at, stretch, places, poses, name)

// Runs an evaluation with the settings of `keywords`. `truth`: empty for none.
std::shared_ptr<EvaluationReport> evaluated(
    Keywords& keywords, const std::string& truth, const CallSettings& call,
    const py::object& progress,
    const std::function<Evaluation(EvaluationSettings& by, const std::string& name,
                                   const Monitor& monitor)>& evaluate) {
  const auto settings = keywords.take<JudgeSettings>();
  EvaluationSettings by;
  by.confidence = settings.confidence;
  by.recall_at = {settings.recall_at.begin(), settings.recall_at.end()};
  by.stretch_frames = settings.stretch;
  by.places = settings.places;
  by.poses = settings.poses;
  if (!truth.empty()) by.ground_truth = parse_ground_truth_argument(truth, 0);
  GroundTruthArgument none;
  read_ground_truth_settings(keywords.json(), "", keywords.function(),
                             by.ground_truth ? *by.ground_truth : none);
  const auto made = std::make_shared<EvaluationReport>();
  run_call(call, progress, [&](const Monitor& monitor) {
    const Stopwatch watch;
    made->evaluation = evaluate(by, settings.name, monitor);
    if (!settings.name.empty()) made->evaluation.name = settings.name;
    made->run = run_info("vpr-eval", keywords.function(), call);
    if (!truth.empty()) made->run.paths["ground_truth"] = truth;
    made->report = report_of(made->evaluation, made->run, monitor);
    made->seconds = watch.elapsed_s();
  });
  return made;
}

std::shared_ptr<EvaluationReport> evaluate(QueryResult& query, const std::string& truth,
                                           const std::string& text, const py::object& progress) {
  Keywords keywords("vpr.evaluate", text);
  const auto call = keywords.take<CallSettings>();
  StoredResult& stored = query.stored;
  const auto made = evaluated(
      keywords, truth, call, progress,
      [&](EvaluationSettings& by, const std::string&, const Monitor& monitor) {
        if (stored.fingerprint.empty())
          stored.fingerprint = sealed_result_json(stored.result, *query.context)["checksum"];
        if (!stored.result.places)
          add_recorded_names(by, stored.run, stored.result.sequences.size());
        Evaluation evaluation = evaluate_result(stored.result, std::nullopt, by, monitor);
        evaluation.fingerprint = stored.fingerprint;
        return evaluation;
      });
  made->recorded = stored.run;
  return made;
}

/// The layout of a score matrix, by the names of flags.
struct MatrixSettings {
  bool similarity = false;
  bool distance = false;
  bool train_first = false;
  std::optional<double> missing;
  std::optional<double> threshold;
  uint64_t rows_are_windows_of = 1;
};
VPR_FIELDS(MatrixSettings, similarity, distance, train_first, missing, threshold,
           rows_are_windows_of)

std::shared_ptr<EvaluationReport> evaluate_matrix(const py::object& scores,
                                                  const std::string& truth, const std::string& text,
                                                  const py::object& progress) {
  Keywords keywords("vpr.evaluate_scores", text);
  const auto call = keywords.take<CallSettings>({.order = FrameOrder::rows});
  const auto layout = keywords.take<MatrixSettings>();
  if (layout.similarity == layout.distance)
    throw Error(ErrorKind::usage,
                "pass similarity=True if large scores are good, or distance=True");
  const ScoreFormat format{layout.similarity, layout.train_first, layout.missing};
  const bool is_array = py::isinstance<py::array>(scores);
  const std::string path = is_array ? "scores" : std::string(py::str(scores));
  ScoreMatrix matrix = is_array ? ScoreMatrix(ScoreFile(view_of(scores, path), path, format))
                                : ScoreMatrix(path, format);
  return evaluated(keywords, truth, call, progress,
                   [&](EvaluationSettings& by, const std::string& name, const Monitor& monitor) {
                     ScoreSettings settings{name.empty() ? fs::path(path).stem().string() : name,
                                            format, layout.rows_are_windows_of, layout.threshold};
                     settings.query.name = kUnnamedQuery;
                     return evaluate_scores(std::move(matrix), settings, by, monitor);
                   });
}

std::string headline(const EvaluationReport& made) {
  const Sequence& query = made.evaluation.query();
  const bool is_resampled = query.selection.selected_fps > 0;
  return summary_sentence(made.evaluation, is_resampled ? query.fps : std::nullopt);
}

std::string page_of(const EvaluationReport& made, bool is_preview) {
  const Evaluation& evaluation = made.evaluation;
  std::string page;
  run_call({}, py::none(), [&](const Monitor& monitor) {
    const FrameSources sources =
        recorded_frames(evaluation.judgment.layout.scope, made.recorded, made.report.has_places());
    page =
        is_preview
            ? evaluation_preview(evaluation, made.report, headline(made), sources, monitor)
            : evaluation_page(evaluation, made.report, made.run, headline(made), sources, monitor);
  });
  return page;
}

// Points of the curve of best matches: threshold, correct and incorrect ones.
py::array points_of(const EvaluationReport& made) {
  const Curve& curve = made.evaluation.judgment.single_best;
  py::array_t<double> rows({curve.points.size(), size_t{3}});
  double* out = rows.mutable_data();
  for (const CurvePoint& point : curve.points)
    for (const double value : {curve.threshold(point), static_cast<double>(point.correct),
                               static_cast<double>(point.incorrect)})
      *out++ = value;
  return rows;
}

/// Frame distances of a query to all training frames, computed on request.
struct Distances {
  DatabasePointer database;
  DescriptorSet query;
  FrameDistances distances;

  py::array rows(size_t first, size_t count) const {
    py::array_t<uint16_t> matrix({count, distances.train_frames});
    uint16_t* out = matrix.mutable_data();
    run_call({}, py::none(), [&](const Monitor& monitor) {
      parallel_for(count, monitor, [&](size_t i) {
        std::vector<uint16_t> row(distances.train_frames + kBlockFrames);
        compute_row(distances, first + i, row);
        std::copy_n(row.begin(), distances.train_frames, out + i * distances.train_frames);
      });
    });
    return matrix;
  }

  py::object row(py::ssize_t index) const {
    const auto frames = static_cast<py::ssize_t>(distances.query_frames);
    if (index < -frames || index >= frames) throw py::index_error("no such query frame");
    return rows(static_cast<size_t>(index < 0 ? index + frames : index), 1)[py::int_(0)];
  }
};

std::shared_ptr<Distances> distances(const DatabasePointer& database, const py::object& source,
                                     const std::string& text, const py::object& progress) {
  Keywords keywords("vpr.distances", text);
  const auto call = keywords.take<CallSettings>();
  const auto selection = keywords.take<SelectionSettings>();
  const auto settings = keywords.rest<SequenceQuerySettings>();
  const SequenceDatabase& sequences = database->sequences();
  const SequenceArgument query = sequence_of(source, "query");
  const auto made = std::make_shared<Distances>();
  made->database = database;
  run_call(call, progress, [&](const Monitor& monitor) {
    made->query = describe_frames(open_sequence(selected(query, selection, call, monitor)),
                                  sequences, settings.skip_unreadable, monitor);
    made->distances = frame_distances(descriptor_spans(sequences), made->query.span());
  });
  return made;
}

/// A query whose frames arrive one by one.
class Live {
 public:
  Live(DatabasePointer database, const std::string& text) : database_(std::move(database)) {
    Keywords keywords("vpr.Live", text);
    call_ = keywords.take<CallSettings>();
    const auto memory = keywords.take<MemorySettings>();
    const ResolvedSettings settings = resolved(keywords, Feature::live);
    SequenceDatabase& sequences = database_->sequences();
    run_call(call_, py::none(), [&](const Monitor& monitor) {
      prepare_database(sequences, settings, "", monitor);
      const QueryResources resources{select_kernels(), memory.max_memory, 0, call_.seed};
      query_.emplace(sequences, "live", settings, resources, monitor);
    });
  }

  py::object add(const py::object& frame, const std::string& name) {
    LiveFrame image{name, name, nullptr, frame.is_none()};
    std::optional<SequenceSource> row;
    if (py::isinstance<py::array>(frame)) {
      if (database_->sequences().descriptors.kind->is_imported)
        row = open_sequence(sequence_of(frame.attr("reshape")(1, -1), name));
      else
        image.picture = picture_of(frame);
    } else {
      image.file = std::string(py::str(frame));
    }
    return take(image, row);
  }

  py::object finish() {
    std::optional<Result> result;
    run_call(call_, py::none(), [&](const Monitor&) { result = query_->finish(); });
    return result ? from_json(live_line(last_, &*result, 0)) : py::none();
  }

 private:
  static std::shared_ptr<const cv::Mat> picture_of(const py::object& frame) {
    const auto pixels = py::array_t<uint8_t, py::array::c_style>::ensure(frame);
    if (!pixels || pixels.ndim() < 2 || pixels.ndim() > 3 ||
        (pixels.ndim() == 3 && pixels.shape(2) != 3))
      throw Error(ErrorKind::data,
                  "an image has height x width gray levels, or height x width x 3 values (blue, "
                  "green, red), of type uint8");
    const std::array size = {static_cast<int>(pixels.shape(0)), static_cast<int>(pixels.shape(1))};
    const cv::Mat view(size[0], size[1], pixels.ndim() == 2 ? CV_8UC1 : CV_8UC3,
                       const_cast<uint8_t*>(pixels.data()));
    return std::make_shared<const cv::Mat>(view.clone());
  }

  py::object take(const LiveFrame& image, const std::optional<SequenceSource>& row) {
    Json line;
    run_call(call_, py::none(), [&](const Monitor&) {
      const SequenceDatabase& database = database_->sequences();
      std::optional<DescriptorSet> set;
      if (!image.is_unreadable)
        set = describe_frames(row ? *row : image.sequence(), database, false, {});
      const std::vector<uint8_t> none(set ? 0 : database.descriptors.shape().row_bytes());
      const ArrivedFrame frame{set ? set->rows()[0] : DescriptorRow(none), set.has_value()};
      const std::optional<Result> result = query_->take(frame);
      last_ = {frames_++, image.name, frame.is_readable};
      line = live_line(last_, result ? &*result : nullptr, 0);
    });
    return from_json(line);
  }

  DatabasePointer database_;
  CallSettings call_;
  std::optional<LiveQuery> query_;
  LineFrame last_;
  size_t frames_ = 0;
};

}  // namespace

PYBIND11_MODULE(_vpr, module) {
  using namespace py::literals;
  py::options options;
  options.disable_function_signatures();
  translate_errors();
  use_simd_target(std::getenv("VPR_SIMD") == nullptr ? "" : std::getenv("VPR_SIMD"));
  module.attr("__version__") = program_version();

  py::class_<Database, DatabasePointer>(module, "Database",
                                        "Training sequences, from train or load.")
      .def("save", save_database, "path"_a, "force"_a = false,
           "Writes the folder that vpr-train writes. force: replaces a database.")
      .def_property_readonly("sequences", names_of, "Names of the training sequences.")
      .def_property_readonly(
          "descriptors", descriptors_of,
          "Stored descriptors, one row per frame of all sequences, as a read-only view: bits (8 "
          "per\nvalue) and images are uint8, vectors int16 or int8. Not for FAB-MAP.");
  py::class_<QueryResult, std::shared_ptr<QueryResult>>(
      module, "Result",
      "Matches of a query, from query or load. Its arrays are those of the result file\n"
      "(docs/reference/files.md), with columns as fields: recognitions, recognition_scores, best,\n"
      "best_scores, margins, path, keyframes, best_rates, new_place, source_frames,\n"
      "train_source_frames. Windows are identified by their first frame; -1 and NaN: no match.")
      .def("save", save_result, "path"_a, "force"_a = false,
           "Writes the result file of vpr-query and its arrays.")
      .def_property_readonly(
          "json",
          [](const QueryResult& self) {
            return from_json(
                result_json(self.stored.result, self.context.value_or(ResultContext())));
          },
          "The content of the result file, without the checksums of arrays.")
      .def("__getattr__", array_of);
  py::class_<EvaluationReport, std::shared_ptr<EvaluationReport>>(module, "Report")
      .def("text",
           [](const EvaluationReport& self) {
             return to_text(report_json(self.report, self.run, self.seconds));
           })
      .def("summary", headline)
      .def("page", page_of)
      .def("curve", points_of);
  py::class_<Distances, std::shared_ptr<Distances>>(
      module, "Distances",
      "Frame distances of a query to all training frames, computed on request: d[i] is the row of\n"
      "query frame i, numpy.asarray(d) the matrix. Values are uint16; smaller is closer.")
      .def("__len__", [](const Distances& self) { return self.distances.query_frames; })
      .def("__getitem__", &Distances::row)
      .def(
          "__array__",
          [](const Distances& self, const py::object& type, const py::object&) {
            py::object all = self.rows(0, self.distances.query_frames);
            return type.is_none() ? all : all.attr("astype")(type);
          },
          "dtype"_a = py::none(), "copy"_a = py::none())
      .def_property_readonly(
          "unit",
          [](const Distances& self) {
            return distance_of(self.query.rows().shape.element).unit.size;
          },
          "Size of one step: 1 bit, or the fraction of a cosine or other distance.")
      .def_property_readonly(
          "shape",
          [](const Distances& self) {
            return py::make_tuple(self.distances.query_frames, self.distances.train_frames);
          },
          "Query frames and training frames.");
  py::class_<Live, std::shared_ptr<Live>>(module, "Live")
      .def(py::init<DatabasePointer, const std::string&>())
      .def("add", &Live::add)
      .def("finish", &Live::finish);
  module.def("train", train);
  module.def("load_database", load_database);
  module.def("load_result", load_result);
  module.def("query", query);
  module.def("evaluate", evaluate);
  module.def("evaluate_scores", evaluate_matrix);
  module.def("distances", distances);
  module.def("save_text", [](const fs::path& path, const std::string& text, bool force) {
    save(force, [&](Outputs& outputs) { outputs.file(path).write(text); });
  });
}

}  // namespace vpr
