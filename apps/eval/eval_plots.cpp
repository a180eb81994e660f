#include <algorithm>
#include <iterator>

#include "base/error.h"
#include "eval.h"
#include "files/report.h"
#include "present/evaluation_charts.h"
#include "present/evaluation_page.h"
#include "present/questions_page.h"
#include "present/recorded_frames.h"
#include "present/report_tables.h"
#include "sequence/sequence_source.h"

namespace vpr {
namespace {

void require_frames(const SequenceSource& sequence, size_t expected, const std::string& what) {
  if (sequence.kind == SequenceKind::descriptors)
    throw Error(ErrorKind::usage, "{}: the sequence has descriptors, but plots need its images",
                sequence.argument.path.string());
  if (sequence.kind == SequenceKind::video || sequence.files.size() == expected) return;
  throw Error(ErrorKind::usage,
              "{}: has {} frames, but {} has {}. Pass the sequence that was evaluated",
              sequence.argument.path.string(), sequence.files.size(), what, expected);
}

std::vector<std::optional<SequenceSource>> open_references(const std::vector<NamedSequence>& train,
                                                           const GroundTruthScope& scope) {
  std::vector<std::optional<SequenceSource>> references(scope.sequences.size());
  if (train.empty()) return references;
  if (train.size() < scope.sequences.size())
    throw Error(
        ErrorKind::usage,
        "there are {} training sequences for plots, but {} were evaluated. Pass all, in this order",
        train.size(), scope.sequences.size());
  for (size_t s = 0; s < references.size(); ++s) {
    const Sequence& known = scope.sequences[s].sequence;
    const auto named = std::ranges::find_if(
        train, [&](const auto& t) { return !t.name.empty() && t.name == known.name; });
    references[s] = open_sequence((named == train.end() ? train[s] : *named).sequence);
    require_frames(*references[s], known.recorded_frames(), known.name);
  }
  return references;
}

FrameSources find_frames(const EvalInputs& inputs, const Evaluated& evaluated) {
  const Evaluation& evaluation = evaluated.evaluation;
  const GroundTruthScope& scope = evaluation.judgment.layout.scope;
  FrameSources sources;
  std::vector<NamedSequence> train;
  if (!inputs.truth.dataset.empty()) {
    const Dataset dataset = read_dataset(inputs.truth.dataset);
    const std::string& name = evaluation.query().name;
    const bool is_named = std::ranges::any_of(
        dataset.queries, [&](const DatasetQuery& query) { return query.sequence.name == name; });
    sources.query = open_sequence(
        select_query(dataset, is_named ? std::optional(name) : inputs.query).sequence.sequence);
    // The references of FAB-MAP are places, not training sequences.
    if (!evaluated.report.has_places()) train = dataset.train;
  } else if (inputs.query) {
    sources.query = open_sequence(parse_sequence_argument(*inputs.query));
  }
  if (sources.query) require_frames(*sources.query, scope.query.recorded_frames(), "the query");
  if (!inputs.train.empty()) train.clear();
  for (const std::string& text : inputs.train) train.push_back({"", parse_sequence_argument(text)});
  sources.references = open_references(train, scope);
  FrameSources recorded = recorded_frames(scope, evaluated.run, evaluated.report.has_places());
  if (!sources.query) sources.query = std::move(recorded.query);
  for (size_t s = 0; s < sources.references.size(); ++s)
    if (!sources.references[s]) sources.references[s] = std::move(recorded.references[s]);
  return sources;
}

MapPanel panel_of(const Evaluated& evaluated) {
  const Evaluation& evaluation = evaluated.evaluation;
  return {title_with_settings(evaluated.report), meanings_of(evaluation.judgment, evaluation.truth),
          evaluation.result && evaluation.result->result->places};
}

RouteMap read_map(const Dataset& dataset, const std::string& where, const Evaluation& evaluation) {
  const std::string& name = evaluation.query().name;
  const NamedSequence& query = select_query(dataset, name).sequence;
  if (query.poses.empty())
    throw Error(ErrorKind::usage,
                "{}: the query {} has no \"poses\" (CSV frame,x,y), which --map needs", where,
                name);
  RouteMap map;
  std::vector<std::filesystem::path> paths = {query.poses};
  for (const NamedSequence& train : dataset.train)
    if (!train.poses.empty()) paths.push_back(train.poses);
  Routes found = read_routes(paths);
  if (found.is_gps && !(dataset.plan.empty() && dataset.place_poses.empty()))
    throw Error(ErrorKind::data,
                "{}: the \"poses\" are latitudes and longitudes, but \"plan\" and \"place_poses\" "
                "are in meters",
                where);
  map.query = std::move(found.routes.front());
  map.train.assign(std::make_move_iterator(found.routes.begin() + 1),
                   std::make_move_iterator(found.routes.end()));
  const size_t frames = evaluation.query().recorded_frames();
  if (map.query.empty())
    throw Error(ErrorKind::data, "{}: there are no poses", query.poses.string());
  if (map.query.size() > frames)
    throw Error(ErrorKind::data, "{}: has poses of {} frames, but the query has {}",
                query.poses.string(), map.query.size(), frames);
  map.query.resize(frames);
  map.query = selected(std::move(map.query), evaluation.query().selection);
  if (!dataset.plan.empty()) map.walls = read_walls(dataset.plan);
  if (!dataset.place_poses.empty()) map.places = read_place_positions(dataset.place_poses);
  return map;
}

}  // namespace

void write_plots(Session& session, const EvalInputs& inputs, const Evaluated& evaluated,
                 const std::string& summary) {
  const Evaluation& evaluation = evaluated.evaluation;
  const Report& report = evaluated.report;
  if (!inputs.html.empty())
    session.outputs.file(inputs.html)
        .write(evaluation_page(evaluation, report, session.run, summary,
                               find_frames(inputs, evaluated), session.monitor));
  if (!inputs.plots.empty())
    draw_evaluation(evaluation, report,
                    session.outputs.folder(inputs.plots, is_marked_folder).temporary(),
                    session.monitor);
}

void write_questions(Session& session, const EvalInputs& inputs, const Evaluated& evaluated) {
  const auto is_found = [](const auto& source) { return source.has_value(); };
  const auto write = [&](const std::string& path, const auto& page_of) {
    if (path.empty()) return;
    const FrameSources sources = find_frames(inputs, evaluated);
    if (!sources.query || !std::ranges::all_of(sources.references, is_found))
      throw Error(ErrorKind::usage,
                  "the images of the run have moved or changed. Pass them with --query and "
                  "--train, or --dataset");
    session.outputs.file(path).write(
        page_of(evaluated.evaluation, evaluated.report, sources, session.monitor));
  };
  write(inputs.place_questions, place_questions_page);
  write(inputs.frame_questions, frame_questions_page);
}

void write_map(Session& session, const EvalInputs& inputs, const Evaluated& evaluated) {
  if (inputs.map.empty()) return;
  std::optional<Evaluated> second;
  if (!inputs.map_with.empty()) {
    EvalInputs other = inputs;
    other.result = inputs.map_with;
    other.matrix.clear();
    second = evaluate(session, other);
  }
  const RouteMap map =
      read_map(read_dataset(inputs.truth.dataset), inputs.truth.dataset, evaluated.evaluation);
  std::vector<MapPanel> panels = {panel_of(evaluated)};
  if (second) {
    panels.push_back(panel_of(*second));
    const std::string& query = evaluated.evaluation.query().name;
    const std::string& other = second->evaluation.query().name;
    if (other != query || panels[0].meanings.size() != panels[1].meanings.size())
      throw Error(ErrorKind::usage,
                  "{}: the query is {}, but the first result has the query {}. Pass two results of "
                  "one query",
                  inputs.map_with, other, query);
  }
  draw_route_map(map, panels, session.outputs.folder(inputs.map, is_marked_folder).temporary(),
                 session.monitor);
}

}  // namespace vpr
