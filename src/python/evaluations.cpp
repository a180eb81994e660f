// Evaluations of results and of score matrices, with their reports.
#include <limits>
#include <type_traits>

#include "present/comparison_report.h"
#include "present/evaluation_page.h"
#include "python/module.h"
#include "vpr/compare.h"

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

// Columns with a value per query frame: arrays of numbers, and lists of text.
py::dict frames_of(const Judged& judged) {
  const Judgment& judgment = judged.evaluation.judgment;
  const Outcomes& outcomes = judgment.outcomes;
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  const auto column = [&](const auto& value_of) {
    using Value = decltype(value_of(outcomes.queries.front()));
    if constexpr (std::is_arithmetic_v<Value>) {
      std::vector<Value> values;
      for (const QueryOutcome& query : outcomes.queries) values.push_back(value_of(query));
      return py::array_t<Value>(static_cast<py::ssize_t>(values.size()), values.data());
    } else {
      py::list values;
      for (const QueryOutcome& query : outcomes.queries) values.append(value_of(query));
      return values;
    }
  };
  py::dict columns;
  columns["frame"] = column([](const auto& query) { return static_cast<int64_t>(query.frame); });
  columns["sequence"] = column([&](const auto& query) -> std::string {
    return query.best ? judgment.layout.scope.sequences[query.best->sequence].sequence.name : "";
  });
  columns["train_frame"] = column([](const auto& query) {
    return query.best ? static_cast<int64_t>(query.best->reference) : int64_t{-1};
  });
  columns["score"] = column([&](const auto& query) {
    return query.best ? score_of_key(query.key, outcomes.kind) : kUnknown;
  });
  columns["outcome"] = column([](const auto& query) { return enum_name(query.verdict); });
  columns["has_match"] = column([&](const auto& query) -> std::string_view {
    if (judgment.by != JudgedBy::ground_truth) return "";
    return query.has_match ? "yes" : "no";
  });
  columns["recognition"] =
      column([&](const auto& query) { return enum_name(judgment.verdicts[query.frame]); });
  columns["rank"] = column([](const auto& query) {
    return query.rank ? static_cast<int64_t>(*query.rank) : int64_t{-1};
  });
  columns["margin"] = column([&](const auto& query) { return query.margin.value_or(kUnknown); });
  return columns;
}

/// Reports side by side, as vpr-eval compare.
struct Compared {
  std::vector<ComparisonReport> sets;

  std::string text() const { return to_text(comparisons_json(sets)); }
  std::string table() const { return comparison_text(sets); }
  std::string page() const { return comparison_page(sets); }
  std::string latex() const { return comparison_tables(sets, TableFormat::latex); }
};

std::shared_ptr<Compared> compare(Call& call, const std::vector<std::string>& texts,
                                  const std::vector<std::string>& names) {
  const auto made = std::make_shared<Compared>();
  call.run([&](const Monitor& monitor) {
    made->sets = calls::compare(call.keywords, texts, names, monitor);
  });
  return made;
}

std::string json_text(const std::filesystem::path& path) {
  return to_text(read_json(path, ErrorKind::data));
}

void save_text(const std::string& text, const std::filesystem::path& path, bool force) {
  save([&] { calls::save(force, {}, [&](Outputs& outputs) { outputs.file(path).write(text); }); });
}

using Rows = py::array_t<int64_t, py::array::c_style | py::array::forcecast>;

// The pairs of an array n x 2: query and training frame.
std::shared_ptr<const std::vector<PlacePair>> pairs_of(const Rows& rows) {
  std::vector<PlacePair> pairs;
  for (py::ssize_t i = 0; i < rows.shape(0); ++i) {
    if (rows.at(i, 0) < 0 || rows.at(i, 1) < 0)
      throw Error(ErrorKind::data,
                  "ground_truth, pair {}: a frame is negative. Omit frames without a match", i);
    pairs.push_back({static_cast<size_t>(rows.at(i, 0)), static_cast<size_t>(rows.at(i, 1))});
  }
  return std::make_shared<const std::vector<PlacePair>>(std::move(pairs));
}

// Judges a result or, if it is null, scores. `truth`: pairs, a file, or nullopt for none.
std::shared_ptr<Judged> evaluate(
    Call& call, const std::shared_ptr<const StoredResult>& result, const Source& scores,
    const std::optional<std::variant<Rows, std::filesystem::path>>& truth) {
  ScoreInput input;
  if (!result) set_source(input, scores);
  if (!result && !call.keywords.values.contains("order"))
    call.keywords.process.order = FrameOrder::rows;
  std::shared_ptr<Judged> made;
  std::string path;
  std::optional<GroundTruthArgument> argument;
  if (truth && std::holds_alternative<Rows>(*truth))
    argument = {
        .format = "pairs", .path = "ground_truth", .pairs = pairs_of(std::get<Rows>(*truth))};
  else if (truth)
    path = std::get<std::filesystem::path>(*truth).string();
  call.run([&](const Monitor& monitor) {
    if (!path.empty()) argument = parse_ground_truth_argument(path, 0);
    made = calls::evaluate(call.keywords, result, input, argument, call.shown(path), monitor);
  });
  return made;
}

}  // namespace

void add_evaluations(py::module_& module) {
  py::class_<Judged, std::shared_ptr<Judged>>(module, "Report")
      .def("text", &Judged::text, py::call_guard<InCall>())
      .def("summary", &Judged::summary, py::call_guard<InCall>())
      .def("page", page_of, py::call_guard<InCall>())
      .def("save", save_report, py::call_guard<InCall>())
      .def("frames", frames_of, py::call_guard<InCall>())
      .def("curve", points_of, py::call_guard<InCall>());
  py::class_<Compared, std::shared_ptr<Compared>>(module, "Compared")
      .def("text", &Compared::text, py::call_guard<InCall>())
      .def("table", &Compared::table, py::call_guard<InCall>())
      .def("page", &Compared::page, py::call_guard<InCall>())
      .def("latex", &Compared::latex, py::call_guard<InCall>());
  module.def("compare", compare, py::call_guard<InCall>());
  module.def("json_text", json_text, py::call_guard<InCall>());
  module.def("save_text", save_text, py::call_guard<InCall>());
  module.def("evaluate", evaluate, py::call_guard<InCall>());
}

}  // namespace vpr
