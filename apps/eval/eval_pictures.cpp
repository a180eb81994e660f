#include <algorithm>
#include <iterator>

#include <fmt/format.h>

#include "base/error.h"
#include "eval_inputs.h"
#include "present/evaluation_charts.h"
#include "present/evaluation_tables.h"
#include "present/html_report.h"
#include "present/route_map.h"
#include "sequence/sequence_source.h"

namespace vpr {

namespace {

void require_frames(const SequenceSource& sequence, size_t expected, const std::string& what) {
  if (sequence.kind == SequenceKind::descriptors)
    throw Error(ErrorKind::usage,
                fmt::format("{}: holds descriptors; pictures need the images that "
                            "they describe",
                            sequence.argument.path.string()));
  if (sequence.kind == SequenceKind::video || sequence.files.size() == expected) return;
  throw Error(ErrorKind::usage,
              fmt::format("{}: has {} frames, and {} has {}; give the sequence that was evaluated",
                          sequence.argument.path.string(), sequence.files.size(), what, expected));
}

/// Training sequences as --train or the data set names them.
std::vector<NamedSequence> find_train(const PictureInputs& inputs,
                                      const std::optional<Dataset>& dataset) {
  if (inputs.train.empty()) return dataset ? dataset->train : std::vector<NamedSequence>{};
  std::vector<NamedSequence> train;
  for (const std::string& text : inputs.train) train.push_back({"", parse_sequence_argument(text)});
  return train;
}

std::vector<std::optional<SequenceSource>> open_references(const std::vector<NamedSequence>& train,
                                                           const GroundTruthScope& scope) {
  std::vector<std::optional<SequenceSource>> references(scope.sequences.size());
  if (train.empty()) return references;
  if (train.size() < scope.sequences.size())
    throw Error(ErrorKind::usage, fmt::format("{} training sequences are given for pictures, and "
                                              "the evaluation has {}; give all, in its order",
                                              train.size(), scope.sequences.size()));
  for (size_t s = 0; s < references.size(); ++s) {
    const auto named = std::find_if(train.begin(), train.end(), [&](const NamedSequence& t) {
      return !t.name.empty() && t.name == scope.sequences[s].sequence.name;
    });
    references[s] = open_sequence((named == train.end() ? train[s] : *named).sequence);
    const Sequence& known = scope.sequences[s].sequence;
    require_frames(*references[s], known.recorded_frames(), known.name);
  }
  return references;
}

FrameSources find_frames(const PictureInputs& inputs, const std::string& dataset_path,
                         const Evaluation& evaluation) {
  const GroundTruthScope& scope = evaluation.judgment.layout.scope;
  FrameSources sources;
  std::optional<Dataset> dataset;
  if (!dataset_path.empty()) dataset = read_dataset(dataset_path);
  if (dataset) {
    const std::string& name = evaluation.query().name;
    const bool is_named =
        std::any_of(dataset->queries.begin(), dataset->queries.end(),
                    [&](const DatasetQuery& query) { return query.sequence.name == name; });
    sources.query = open_sequence(
        select_query(*dataset, is_named ? std::optional(name) : inputs.query).sequence.sequence);
  } else if (inputs.query) {
    sources.query = open_sequence(parse_sequence_argument(*inputs.query));
  }
  if (sources.query) require_frames(*sources.query, scope.query.recorded_frames(), "the query");
  // References of FAB-MAP are places: the data set's training sequences are not.
  if (evaluation.result && evaluation.result->result.places) dataset.reset();
  sources.references = open_references(find_train(inputs, dataset), scope);
  return sources;
}

MapPanel panel_of(const Evaluated& evaluated) {
  const Evaluation& evaluation = evaluated.evaluation;
  return {title_with_settings(evaluated.report), meanings_of(evaluation.judgment, evaluation.truth),
          evaluation.result && evaluation.result->result.places};
}

RouteMap read_map(const Dataset& dataset, const std::string& where, const Evaluation& evaluation) {
  const std::string& name = evaluation.query().name;
  const NamedSequence& query = select_query(dataset, name).sequence;
  if (query.poses.empty())
    throw Error(ErrorKind::usage, fmt::format("{}: the query {} names no \"poses\", which --map "
                                              "needs (CSV frame,x,y)",
                                              where, name));
  RouteMap map;
  std::vector<std::filesystem::path> paths = {query.poses};
  for (const NamedSequence& train : dataset.train)
    if (!train.poses.empty()) paths.push_back(train.poses);
  Routes found = read_routes(paths);
  if (found.is_gps && !(dataset.plan.empty() && dataset.place_poses.empty()))
    throw Error(ErrorKind::data,
                fmt::format("{}: its \"poses\" are latitudes and longitudes, and \"plan\" and "
                            "\"place_poses\" are in meters",
                            where));
  map.query = std::move(found.routes.front());
  map.train.assign(std::make_move_iterator(found.routes.begin() + 1),
                   std::make_move_iterator(found.routes.end()));
  const size_t frames = evaluation.query().recorded_frames();
  if (map.query.empty())
    throw Error(ErrorKind::data, fmt::format("{}: has no poses", query.poses.string()));
  if (map.query.size() > frames)
    throw Error(ErrorKind::data, fmt::format("{}: has poses of {} frames, and the query has {}",
                                             query.poses.string(), map.query.size(), frames));
  map.query.resize(frames);
  map.query = selected(std::move(map.query), evaluation.query().selection);
  if (!dataset.plan.empty()) map.walls = read_walls(dataset.plan);
  if (!dataset.place_poses.empty()) map.places = read_place_positions(dataset.place_poses);
  return map;
}

}  // namespace

void add_picture_options(const Command& app, PictureInputs& inputs) {
  const std::string group = "Pictures";
  app.add_option("--html", inputs.html,
                 "write a report with pictures: one file that opens anywhere, without a network; a "
                 "result is shown without a ground truth, too")
      .group(group)
      .type_name("FILE");
  app.add_option("--plot", inputs.plots,
                 "draw curves, timeline and matrix as SVG and PNG into this folder")
      .group(group)
      .type_name("FOLDER");
  app.add_option("--query", inputs.query,
                 "the query's frames for --html: a sequence, or its name in the data set")
      .group(group)
      .type_name("SEQUENCE");
  app.add_list("--train", inputs.train,
               "a training sequence for --html; repeat it in the order of the database")
      .group(group)
      .type_name("SEQUENCE");
}

bool wants_pictures(const PictureInputs& inputs) {
  return !inputs.html.empty() || !inputs.plots.empty();
}

void check_picture_outputs(const Session& session, const PictureInputs& inputs) {
  if (!inputs.html.empty()) session.outputs.claim_file(inputs.html);
  if (!inputs.plots.empty()) session.outputs.claim_folder(inputs.plots, is_marked_folder);
}

void write_pictures(Session& session, const EvalInputs& inputs, const Evaluated& evaluated,
                    const std::string& summary) {
  const auto& [evaluation, by, report] = evaluated;
  const PictureInputs& pictures = inputs.pictures;
  if (!pictures.html.empty()) {
    const FrameSources sources = find_frames(pictures, inputs.dataset, evaluation);
    session.outputs.file(pictures.html)
        .write(html_report(evaluation, report, session.run, summary, sources, session.monitor));
  }
  if (!pictures.plots.empty())
    draw_evaluation(evaluation, report,
                    session.outputs.folder(pictures.plots, is_marked_folder).temporary(),
                    session.monitor);
}

void add_map_options(const Command& app, EvalInputs& inputs) {
  app.add_option("--map", inputs.map,
                 "draw plan, training paths and recognitions along the query's path as SVG and PNG "
                 "into this folder; needs --dataset with poses")
      .group("Pictures")
      .type_name("FOLDER");
  app.add_option("--map-with", inputs.map_with,
                 "a second result of the same query, on a map beside the first (FAB-MAP and "
                 "FastABLE, say)")
      .group("Pictures")
      .type_name("RESULT");
}

void check_map_inputs(const Session& session, const EvalInputs& inputs) {
  if (inputs.map.empty() && !inputs.map_with.empty())
    throw Error(ErrorKind::usage, "--map-with needs --map FOLDER, where the map goes");
  if (inputs.map.empty()) return;
  if (inputs.dataset.empty())
    throw Error(ErrorKind::usage,
                "--map needs --dataset, whose \"poses\" say where frames were taken");
  session.outputs.claim_folder(inputs.map, is_marked_folder);
}

void write_map(Session& session, const EvalInputs& inputs, const Evaluated& evaluated) {
  if (inputs.map.empty()) return;
  std::optional<Evaluated> second;
  if (!inputs.map_with.empty()) {
    EvalInputs other = inputs;
    other.result = inputs.map_with;
    other.scores = {};
    second = evaluate(session, other);
  }
  const RouteMap map = read_map(read_dataset(inputs.dataset), inputs.dataset, evaluated.evaluation);
  std::vector<MapPanel> panels = {panel_of(evaluated)};
  if (second) {
    panels.push_back(panel_of(*second));
    const std::string& query = evaluated.evaluation.query().name;
    const std::string& other = second->evaluation.query().name;
    if (other != query || panels[0].meanings.size() != panels[1].meanings.size())
      throw Error(ErrorKind::usage,
                  fmt::format("{}: is of the query {}, the first result of {}; give two results "
                              "of one query",
                              inputs.map_with, other, query));
  }
  draw_route_map(map, panels, session.outputs.folder(inputs.map, is_marked_folder).temporary(),
                 session.monitor);
}

}  // namespace vpr
