// Evaluations of results and of score matrices, with their reports.
#include "base/error.h"
#include "base/stopwatch.h"
#include "evaluate/prediction_lists.h"
#include "evaluate/score_matrix.h"
#include "files/report.h"
#include "files/run_info.h"
#include "present/evaluation_page.h"
#include "present/summary.h"
#include "python/module.h"

namespace py = pybind11;

namespace vpr {
namespace {

struct EvaluationReport {
  Evaluation evaluation;
  Report report;
  std::shared_ptr<const StoredResult> stored;  ///< null: scores
  RunInfo run;
  double seconds = 0;

  std::string text() const { return to_text(report_json(report, run, seconds)); }
  std::string summary() const { return summary_sentence(evaluation, std::nullopt); }

  std::string page(bool is_preview) const {
    std::string page;
    Call{"vpr.evaluate"}.run([&](const Monitor& monitor) {
      const auto frames = recorded_frames(evaluation.judgment.layout.scope, stored.get());
      page = is_preview ? evaluation_preview(evaluation, report, summary(), frames, monitor)
                        : evaluation_page(evaluation, report, run, summary(), frames, monitor);
    });
    return page;
  }

  void save(const std::filesystem::path& path, bool is_page, bool force) const {
    const std::string content = is_page ? page(false) : text();
    vpr::save(force, run, [&](Outputs& outputs) { outputs.file(path).write(content); });
  }

  // Points of the curve of best matches: threshold, correct and incorrect ones.
  py::array curve() const {
    const Curve& best = evaluation.judgment.single_best;
    std::vector<double> rows;
    for (const CurvePoint& point : best.points)
      rows.insert(rows.end(), {best.threshold(point), static_cast<double>(point.correct),
                               static_cast<double>(point.incorrect)});
    return py::array_t<double>({best.points.size(), size_t{3}}, rows.data());
  }
};
using ReportPointer = std::shared_ptr<EvaluationReport>;

// Sets the path or the array, which is called "scores".
void set_source(ScoreInput& scores, const Source& source) {
  const auto* path = std::get_if<std::filesystem::path>(&source);
  scores.path = path == nullptr ? "scores" : path->string();
  if (path == nullptr) {
    const auto& values = std::get<py::object>(source);
    scores.array = view_of(array_of(values, scores.path), scores.path);
  }
}

// The scores or, with the number of training frames, the ranks of indices, which are distances.
ScoreMatrix open_scores(ScoreInput& input, size_t train_frames, const Monitor& monitor) {
  if (train_frames == 0) {
    require_order(input);
    ScoreFile file = input.open();
    warn_of_indices(file, monitor);
    return ScoreMatrix(std::move(file));
  }
  const auto array = input.array ? input.array : std::make_shared<const NpyArray>(input.path);
  if (!is_index_array(*array, train_frames))
    throw Error(ErrorKind::usage,
                "train_frames is for integers, the indices of the best references of each query");
  input.is_similarity = false;
  return index_scores(input.open(), train_frames);
}

// Judges a result or, if it is null, scores. `truth`: nullopt for none.
ReportPointer evaluate(Call& call, const std::shared_ptr<const StoredResult>& result,
                       const Source& scores, const std::optional<std::filesystem::path>& truth) {
  EvaluationSettings by;
  ScoreInput input;
  ScoreSettings settings;
  std::string name;
  size_t train_frames = 0;  // of an array of indices
  GroundTruthArgument argument;
  if (truth) argument = parse_ground_truth_argument(truth->string(), 0);
  NestedObject own{[&](auto&& visit) {
    visit("name", name);
    visit("format", argument.format);
    visit("tolerance", argument.tolerance_frames);
    visit_fields(argument.options, visit);
    if (result) return;
    visit_fields(input, visit);
    visit("train_frames", train_frames);
    visit("rows_are_windows_of", settings.window_length);
    visit("threshold", settings.threshold);
  }};
  if (!result) set_source(input, scores);
  if (!result) call.process.order = FrameOrder::rows;
  call.read(by, own);
  check_evaluation(by);
  if (truth) by.ground_truth = argument;
  const auto evaluate_input = [&](const Monitor& monitor) {
    settings.query.name = kUnnamedQuery;
    settings.method = name.empty() ? std::filesystem::path(input.path).stem().string() : name;
    ScoreMatrix matrix = open_scores(input, train_frames, monitor);
    settings.format = input.format();
    require_range("rows_are_windows_of", static_cast<double>(settings.window_length), 1,
                  static_cast<double>(matrix.queries));
    Evaluation evaluation = evaluate_scores(std::move(matrix), settings, by, monitor);
    warn_of_scores(evaluation.judgment, input, input.path, monitor);
    return evaluation;
  };
  const auto made = std::make_shared<EvaluationReport>();
  call.run([&](const Monitor& monitor) {
    const Stopwatch watch;
    made->evaluation =
        result ? evaluate_stored(result, std::nullopt, by, monitor) : evaluate_input(monitor);
    if (!name.empty()) made->evaluation.name = name;
    made->stored = result;
    made->run = run_of("vpr-eval", {call.function}, call.process.seed);
    if (truth) made->run.paths["ground_truth"] = call.shown(truth->string());
    made->report = report_of(made->evaluation, made->run, monitor);
    made->seconds = watch.elapsed_s();
  });
  return made;
}

}  // namespace

void add_evaluations(py::module_& module) {
  py::class_<EvaluationReport, ReportPointer>(module, "Report")
      .def("text", &EvaluationReport::text)
      .def("summary", &EvaluationReport::summary)
      .def("page", &EvaluationReport::page)
      .def("save", &EvaluationReport::save)
      .def("curve", &EvaluationReport::curve);
  module.def("evaluate", evaluate);
}

}  // namespace vpr
