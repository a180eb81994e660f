// Evaluations of results and of score matrices, with their reports.
#include "base/error.h"
#include "evaluate/exports.h"
#include "present/comparison_report.h"
#include "present/evaluation_page.h"
#include "python/module.h"

namespace py = pybind11;

namespace vpr {
namespace {

using calls::Judged;

std::string page_of(const Judged& judged, bool is_preview) {
  std::string page;
  Call{{"vpr.evaluate", Json::object()}}.run([&](const Monitor& monitor) {
    const Evaluation& evaluation = judged.evaluation;
    const std::string summary = judged.summary();
    const auto frames = recorded_frames(evaluation.judgment.layout.scope, judged.stored.get());
    page = is_preview
               ? evaluation_preview(evaluation, judged.report, summary, frames, monitor)
               : evaluation_page(evaluation, judged.report, judged.run, summary, frames, monitor);
  });
  return page;
}

void save_report(const Judged& judged, const std::filesystem::path& path, bool is_page,
                 bool force) {
  const std::string content = is_page ? page_of(judged, false) : judged.text();
  save([&] {
    calls::save(force, judged.run, [&](Outputs& outputs) { outputs.file(path).write(content); });
  });
}

// Sets the path or the array, which is called "scores".
void set_source(ScoreInput& scores, const Source& source) {
  const auto* path = std::get_if<std::filesystem::path>(&source);
  scores.path = path == nullptr ? "scores" : path->string();
  if (path == nullptr) {
    const auto& values = std::get<py::object>(source);
    scores.array = view_of(array_of(values, scores.path), scores.path);
  }
}

// Points of the curve of best matches: threshold, correct and incorrect ones.
py::array points_of(const Judged& judged) {
  const Curve& best = judged.evaluation.judgment.single_best;
  std::vector<double> rows;
  for (const CurvePoint& point : best.points)
    rows.insert(rows.end(), {best.threshold(point), static_cast<double>(point.correct),
                             static_cast<double>(point.incorrect)});
  return py::array_t<double>({best.points.size(), size_t{3}}, rows.data());
}

// A row of CSV per query frame.
std::string frames_of(const Judged& judged) {
  const Evaluation& evaluation = judged.evaluation;
  return kOutcomesHeader +
         outcomes_csv(evaluation.judgment, judged.report.row_name, evaluation.query().name);
}

/// Reports side by side, as vpr-eval compare.
struct Compared {
  std::vector<ComparisonReport> sets;

  std::string text() const { return to_text(comparisons_json(sets)); }
  std::string table() const { return comparison_text(sets); }
  std::string page() const { return comparison_page(sets); }
  std::string latex() const { return comparison_tables(sets, TableFormat::latex); }
};

// `texts`: report files, named `names`.
std::shared_ptr<Compared> compare(Call& call, const std::vector<std::string>& texts,
                                  const std::vector<std::string>& names) {
  const auto made = std::make_shared<Compared>();
  call.run([&](const Monitor& monitor) {
    ComparisonSettings settings;
    NestedObject own{[&](auto&& visit) {
      visit("block", settings.block);
      visit("recall_at", settings.recall_at);
      visit("common", settings.only_common);
      visit("allow_different", settings.omit_disputed);
    }};
    call.keywords.read(own);
    if (texts.size() < 2) throw Error(ErrorKind::usage, "a comparison needs two or more reports");
    settings.seed = call.keywords.process.seed;
    std::vector<Report> reports;
    for (size_t r = 0; r < texts.size(); ++r) {
      const std::optional<Json> json = parse_json(texts[r]);
      reports.push_back(parse_report(json ? *json : Json(), names[r]));
    }
    made->sets = by_data_set(std::move(reports), names);
    for (ComparisonReport& set : made->sets) {
      if (compare_ground_truths(set.reports) == GroundTruths::different && !settings.omit_disputed)
        throw Error(ErrorKind::data,
                    "the reports have different ground truths. Evaluate all results with one of "
                    "them, or pass allow_different=True");
      set.settings = settings;
      compare_reports(set, monitor);
      set.made_by = provenance_of(run_of("vpr-eval", {call.keywords.function}, settings.seed));
    }
  });
  return made;
}

void save_text(const std::string& text, const std::filesystem::path& path, bool force) {
  save([&] { calls::save(force, {}, [&](Outputs& outputs) { outputs.file(path).write(text); }); });
}

// Judges a result or, if it is null, scores. `truth`: nullopt for none.
std::shared_ptr<Judged> evaluate(Call& call, const std::shared_ptr<const StoredResult>& result,
                                 const Source& scores,
                                 const std::optional<std::filesystem::path>& truth) {
  ScoreInput input;
  if (!result) set_source(input, scores);
  if (!result && !call.keywords.values.contains("order"))
    call.keywords.process.order = FrameOrder::rows;
  std::shared_ptr<Judged> made;
  call.run([&](const Monitor& monitor) {
    std::optional<GroundTruthArgument> argument;
    if (truth) argument = parse_ground_truth_argument(truth->string(), 0);
    made = calls::evaluate(call.keywords, result, input, argument,
                           truth ? call.shown(truth->string()) : "", monitor);
  });
  return made;
}

}  // namespace

void add_evaluations(py::module_& module) {
  py::class_<Judged, std::shared_ptr<Judged>>(module, "Report")
      .def("text", &Judged::text)
      .def("summary", &Judged::summary)
      .def("page", page_of, py::call_guard<InCall>())
      .def("save", save_report, py::call_guard<InCall>())
      .def("frames", frames_of)
      .def("curve", points_of);
  py::class_<Compared, std::shared_ptr<Compared>>(module, "Compared")
      .def("text", &Compared::text)
      .def("table", &Compared::table)
      .def("page", &Compared::page, py::call_guard<InCall>())
      .def("latex", &Compared::latex);
  module.def("compare", compare, py::call_guard<InCall>());
  module.def("save_text", save_text, py::call_guard<InCall>());
  module.def("evaluate", evaluate, py::call_guard<InCall>());
}

}  // namespace vpr
