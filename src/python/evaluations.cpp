// Evaluations of results and of score matrices, with their reports.
#include <pybind11/stl/filesystem.h>

#include "base/error.h"
#include "base/stopwatch.h"
#include "files/report.h"
#include "present/evaluation_page.h"
#include "present/report_tables.h"
#include "python/module.h"

namespace py = pybind11;

namespace vpr {
namespace {

struct EvaluationReport {
  Evaluation evaluation;
  Report report;
  RecordedRun recorded;
  RunInfo run;
  double seconds = 0;

  std::string text() const { return to_text(report_json(report, run, seconds)); }
  std::string summary() const { return summary_sentence(evaluation, std::nullopt); }

  std::string page(bool is_preview) const {
    std::string page;
    Call("vpr.evaluate").run([&](const Monitor& monitor) {
      const auto frames =
          recorded_frames(evaluation.judgment.layout.scope, recorded, report.has_places());
      page = is_preview ? evaluation_preview(evaluation, report, summary(), frames, monitor)
                        : evaluation_page(evaluation, report, run, summary(), frames, monitor);
    });
    return page;
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

using Evaluate = std::function<Evaluation(const EvaluationSettings& by, const std::string& name,
                                          const Monitor& monitor)>;

// Runs an evaluation with the remaining keywords. `truth`: empty for none.
ReportPointer evaluated(Call& call, const std::string& truth, const Evaluate& evaluate) {
  EvaluationSettings by;
  std::string name;
  NestedObject own{[&](auto&& visit) { visit("name", name); }};
  call.take(by, own);
  GroundTruthArgument argument;
  if (!truth.empty()) argument = parse_ground_truth_argument(truth, 0);
  read_ground_truth_settings(call.keywords, "", call.function, argument);
  if (!truth.empty()) by.ground_truth = argument;
  const auto made = std::make_shared<EvaluationReport>();
  call.run([&](const Monitor& monitor) {
    const Stopwatch watch;
    made->evaluation = evaluate(by, name, monitor);
    if (!name.empty()) made->evaluation.name = name;
    made->run = call.run_info("vpr-eval");
    if (!truth.empty()) made->run.paths["ground_truth"] = truth;
    made->report = report_of(made->evaluation, made->run, monitor);
    made->seconds = watch.elapsed_s();
  });
  return made;
}

ReportPointer evaluate(const std::shared_ptr<StoredResult>& result, const std::string& truth,
                       const std::string& text, const py::object& progress) {
  Call call("vpr.evaluate", text, progress);
  const auto made = evaluated(
      call, truth, [&](const EvaluationSettings& by, const std::string&, const Monitor& monitor) {
        Evaluation evaluation = evaluate_stored(result, std::nullopt, by, monitor);
        if (result->fingerprint.empty())
          evaluation.fingerprint = sealed_result_json(result->result, result->context)["checksum"];
        return evaluation;
      });
  made->recorded = result->run;
  return made;
}

ReportPointer evaluate_matrix(const py::object& scores, const std::string& truth,
                              const std::string& text, const py::object& progress) {
  Call call("vpr.evaluate_scores", text, progress, {.order = FrameOrder::rows});
  ScoreInput input;
  ScoreSettings settings;
  NestedObject layout{[&](auto&& visit) {
    visit("rows_are_windows_of", settings.window_length);
    visit("threshold", settings.threshold);
  }};
  call.take(input, layout);
  set_source(input, scores);
  require_order(input);
  settings.format = input.format();
  settings.query.name = kUnnamedQuery;
  return evaluated(
      call, truth,
      [&](const EvaluationSettings& by, const std::string& name, const Monitor& monitor) {
        settings.method = name.empty() ? std::filesystem::path(input.path).stem().string() : name;
        Evaluation evaluation = evaluate_scores(ScoreMatrix(input.open()), settings, by, monitor);
        warn_of_scores(evaluation.judgment, input, input.path, monitor);
        return evaluation;
      });
}

}  // namespace

void add_evaluations(py::module_& module) {
  py::class_<EvaluationReport, ReportPointer>(module, "Report")
      .def("text", &EvaluationReport::text)
      .def("summary", &EvaluationReport::summary)
      .def("page", &EvaluationReport::page)
      .def("curve", &EvaluationReport::curve);
  module.def("evaluate", evaluate);
  module.def("evaluate_scores", evaluate_matrix);
  module.def("save_text",
             [](const std::filesystem::path& path, const std::string& text, bool force) {
               save(force, [&](Outputs& outputs) { outputs.file(path).write(text); });
             });
}

}  // namespace vpr
