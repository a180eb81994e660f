// The outputs of vpr-eval, except reports and tables: trajectories, pairs, plots, maps and pages.
#include <algorithm>
#include <cassert>
#include <iterator>

#include <fmt/format.h>

#include "base/error.h"
#include "base/text.h"
#include "eval.h"
#include "evaluate/exports.h"
#include "evaluate/prediction_lists.h"
#include "present/evaluation_charts.h"
#include "present/evaluation_page.h"
#include "present/report_tables.h"
#include "truth/frame_times.h"
#include "truth/positions.h"
#include "truth/times.h"
#include "truth/trajectory.h"

namespace vpr {
namespace {

namespace fs = std::filesystem;

// Positions of training frames in meters, from the data set or else from the ground truth.
TrainPositions read_positions(const Dataset& dataset, const Evaluation& evaluation,
                              const GroundTruthOptions& options, const Monitor& monitor) {
  TrainPositions positions;
  if (evaluation.result && evaluation.result->result->places) {
    Poses& places = positions.emplace_back();
    if (dataset.place_poses.empty()) return positions;
    for (const RoutePoint& point : read_place_positions(dataset.place_poses))
      places.push_back(Pose{{point.x, point.y, 0}, {}, {}});
    return positions;
  }
  std::optional<bool> is_on_earth;
  std::optional<LocalPlane> plane;  // tangent at the first frame
  const auto read = [&](const std::filesystem::path& path, const GroundTruthOptions& times,
                        const NameReader& reader) {
    Trajectory train = read_train_poses(path, times, reader, monitor);
    if (train.poses.empty()) return train.poses;
    if (is_on_earth.value_or(train.is_on_earth) != train.is_on_earth)
      throw Error(ErrorKind::data,
                  "--save-trajectory: some training sequences have latitudes and longitudes, "
                  "others have meters. Use the same for all");
    is_on_earth = train.is_on_earth;
    flatten(train, plane);
    return train.poses;
  };
  for (const auto& [sequence, searched, names] : evaluation.judgment.layout.scope.sequences) {
    Poses& poses = positions.emplace_back();
    const auto train = std::ranges::find(dataset.train, sequence.name, &NamedSequence::name);
    if (train != dataset.train.end() && !train->poses.empty())
      poses = read(train->poses, {}, names);
    else if (!options.reference.empty() && searched)
      poses = read(options.reference, options, names);
    if (sequence.selection.is_all() || poses.empty()) continue;
    poses.resize(sequence.recorded_frames());
    poses = selected(std::move(poses), sequence.selection);
  }
  return positions;
}

// Times of --query-times, of the images, or at the constant rate, in nanoseconds; empty: unknown.
std::vector<int64_t> recorded_times(const EvalRun& run, const Evaluated& evaluated,
                                    const GroundTruthOptions& options) {
  const Sequence& query = evaluated.evaluation.query();
  const size_t frames = query.recorded_frames();
  const GroundTruthScope& scope = evaluated.evaluation.judgment.layout.scope;
  const Monitor& monitor = run.session.monitor;
  if (!options.query.times.empty()) {
    std::vector<int64_t> times = read_frame_times(
        options.query.times, names_of_side(options.query, scope.query_names), monitor);
    if (times.size() < frames)
      throw Error(ErrorKind::data, "{}: has {}, the query has {}", options.query.times.string(),
                  counted(times.size(), "time"), counted(frames, "frame"));
    const int64_t offset = std::llround(options.query.offset_s.value_or(0) * double{kSecond});
    for (int64_t& time : times) time += offset;
    return times;
  }
  const auto given = query_argument(run.flags, query.name);
  const auto source = given && fs::exists(given->path)
                          ? std::optional(open_sequence(*given))
                          : recorded_frames(scope, evaluated.stored.get()).query;
  if (source && states_times(*source))
    if (auto times = find_times(*source, {}, {}, monitor); times && times->size() == frames)
      return *std::move(times);
  return run.recorded_fps ? even_times(frames, *run.recorded_fps) : std::vector<int64_t>{};
}

// Times of the recorded frames, unknown at a simulated speed.
FrameTimes times_of(const EvalRun& run, const Evaluated& evaluated,
                    const GroundTruthOptions& options) {
  const Sequence& query = evaluated.evaluation.query();
  const bool is_recorded = query.selection.speed.empty();
  const auto times_ns =
      is_recorded ? recorded_times(run, evaluated, options) : std::vector<int64_t>{};
  FrameTimes times{{}, !times_ns.empty()};
  for (size_t frame = 0; frame < query.frames; ++frame) {
    const size_t source = query.selection.source_of(frame);
    times.texts.push_back(times_ns.empty() ? fmt::format("{:.6f}", static_cast<double>(source))
                                           : time_text(times_ns[source]));
  }
  return times;
}

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

FrameSources find_frames(const EvalFlags& flags, const Evaluated& evaluated) {
  const Evaluation& evaluation = evaluated.evaluation;
  const GroundTruthScope& scope = evaluation.judgment.layout.scope;
  FrameSources sources;
  std::vector<NamedSequence> train;
  if (const auto query = query_argument(flags, evaluated.evaluation.query().name))
    sources.query = open_sequence(*query);
  // The references of FAB-MAP are places, not training sequences.
  if (!flags.truth.dataset.empty() && !evaluated.report.has_places())
    train = read_dataset(flags.truth.dataset).train;
  if (sources.query) require_frames(*sources.query, scope.query.recorded_frames(), "the query");
  if (!flags.train.empty()) train.clear();
  for (const std::string& text : flags.train) train.push_back({"", parse_sequence_argument(text)});
  sources.references = open_references(train, scope);
  FrameSources recorded = recorded_frames(scope, evaluated.stored.get());
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

std::string name_of(const std::vector<std::string>& names, size_t frame) {
  return names.empty() ? std::to_string(frame) : names.at(frame);
}

void require_names(const std::vector<std::string>& names, const Sequence& sequence,
                   std::string_view what) {
  if (names.empty() || names.size() == sequence.recorded_frames()) return;
  throw Error(
      ErrorKind::usage,
      "--pairs: there are names of {}, but {} has {}. Pass the sequences that were evaluated",
      counted(names.size(), "frame"), what, sequence.recorded_frames());
}

constexpr std::string_view kChanged =
    "the images of the run have moved or changed. Pass them with --query and --train, or --dataset";

bool has_all_frames(const FrameSources& sources, bool has_references) {
  const auto is_found = [](const auto& source) { return source.has_value(); };
  return sources.query && (!has_references || std::ranges::all_of(sources.references, is_found));
}

std::string html_text(const EvalRun& run, const Evaluated& evaluated) {
  const FrameSources sources = find_frames(run.flags, evaluated);
  const RunInfo made = evaluated.stored ? evaluated.stored->context.run : RunInfo{};
  const bool has_references = !made.path("database").empty() && !evaluated.report.has_places();
  if (made.images.contains("query") && !has_all_frames(sources, has_references))
    warn(run.session.monitor, "the page lacks images: {}", kChanged);
  return evaluation_page(evaluated.evaluation, evaluated.report, run.session.run, run.summary,
                         sources, run.session.monitor);
}

void draw_plots(const EvalRun& run, const Evaluated& evaluated, const fs::path& folder) {
  draw_evaluation(evaluated.evaluation, evaluated.report, folder, run.flags.figure,
                  run.session.monitor);
}

template <decltype(place_questions_page)& page_of>
std::string questions_text(const EvalRun& run, const Evaluated& evaluated) {
  const FrameSources sources = find_frames(run.flags, evaluated);
  if (!has_all_frames(sources, !evaluated.report.has_places()))
    throw Error(ErrorKind::usage, "{}", kChanged);
  return page_of(evaluated.evaluation, evaluated.report, sources, run.session.monitor);
}

void draw_map(const EvalRun& run, const Evaluated& evaluated, const fs::path& folder) {
  const std::string& dataset = run.flags.truth.dataset;
  std::optional<Evaluated> second;
  if (!run.flags.map_with.empty())
    second = evaluate(run.session, run.flags, {.result = run.flags.map_with, .needs_truth = false});
  const RouteMap map = read_map(read_dataset(dataset), dataset, evaluated.evaluation);
  std::vector<MapPanel> panels = {panel_of(evaluated)};
  if (second) {
    panels.push_back(panel_of(*second));
    const std::string& query = evaluated.evaluation.query().name;
    const std::string& other = second->evaluation.query().name;
    if (other != query || panels[0].meanings.size() != panels[1].meanings.size())
      throw Error(ErrorKind::usage,
                  "{}: the query is {}, but the first result has the query {}. Pass two results of "
                  "one query",
                  run.flags.map_with, other, query);
  }
  draw_route_map(map, panels, folder, run.session.monitor);
}

std::string junit_text(const EvalRun& run, const Evaluated& evaluated) {
  const std::string suite =
      fmt::format("{} on {}", evaluated.report.method, evaluated.report.query);
  return junit_xml(suite, run.flags.expected, run.checked);
}

std::string outcomes_text(const EvalRun& /*run*/, const Evaluated& evaluated) {
  return outcomes_csv(evaluated.evaluation.judgment, evaluated.report.row_name,
                      evaluated.evaluation.query().name);
}

std::string recognitions_text(const EvalRun& /*run*/, const Evaluated& evaluated) {
  return recognitions_csv(*evaluated.evaluation.result, evaluated.report.row_name);
}

std::string pairs_text(const EvalRun& run, const Evaluated& evaluated) {
  const Evaluation& evaluation = evaluated.evaluation;
  return pair_list(run.session, run.flags, evaluation.matrix ? &*evaluation.matrix : nullptr,
                   evaluation.judgment.layout,
                   evaluation.result ? evaluation.result->result.get() : nullptr)
      .text;
}

std::string trajectory_text(const EvalRun& run, const Evaluated& evaluated) {
  const auto& [evaluation, by, report, stored] = evaluated;
  const std::string& dataset = run.flags.truth.dataset;
  const Monitor& monitor = run.session.monitor;
  const GroundTruthOptions options =
      by.ground_truth ? by.ground_truth->options : GroundTruthOptions{};
  const TrainPositions positions = read_positions(
      dataset.empty() ? Dataset{} : read_dataset(dataset), evaluation, options, monitor);
  if (std::ranges::all_of(positions, [](const Poses& frames) { return frames.empty(); }))
    throw Error(ErrorKind::usage,
                "--save-trajectory: no searched training sequence has \"poses\" (FAB-MAP: "
                "\"place_poses\") in the data set, or poses of --ground-truth-train");
  return recognized_trajectory(evaluation, positions, times_of(run, evaluated, options));
}

constexpr EvalOutput kOutputs[] = {
    {.flag = "--html",
     .help = "HTML page with charts and images; one file that opens without a network",
     .group = kEssentialGroup,
     .of_scores = true,
     .text = html_text},
    {.flag = "--plot",
     .help = "folder for curves, timeline and matrix with ground truth, as SVG, PDF and PNG",
     .group = kPictureGroup,
     .of_scores = true,
     .draw = draw_plots},
    {.flag = "--ask-frames",
     .help = "HTML page that shows the images of frames and their best matches, asks whether they "
             "are the same place, and saves labels for --ground-truth, by which any result can be "
             "judged",
     .group = kPictureGroup,
     .answers = "--ground-truth labels.csv",
     .text = questions_text<frame_questions_page>},
    {.flag = "--ask-places",
     .help = "HTML page that shows images of each recognized place, asks whether it is the same "
             "place, and saves the answers for --places",
     .group = kPictureGroup,
     .answers = "--places places.csv",
     .text = questions_text<place_questions_page>},
    {.flag = "--ask-fabmap",
     .help = "HTML page that shows training frames, asks which of them are places of FAB-MAP and "
             "where the query passes them, and saves the places for vpr-train fabmap "
             "--marked-places and --ground-truth",
     .group = kPictureGroup,
     .answers = "vpr-train fabmap --marked-places fabmap-places.csv",
     .text = questions_text<fabmap_questions_page>},
    {.flag = "--map",
     .help = "folder for a map with plan, training paths and recognitions along the query's path, "
             "as SVG, PDF and PNG; needs --dataset with poses",
     .group = kPictureGroup,
     .lacks = [](const EvalFlags& flags) -> std::string_view {
       if (!flags.truth.dataset.empty()) return "";
       return "needs --dataset, whose \"poses\" have the positions of frames";
     },
     .draw = draw_map},
    {.flag = "--junit",
     .help = "JUnit XML file with the comparison of --expect, one test case per value",
     .group = kFileGroup,
     .of_scores = true,
     .lacks = [](const EvalFlags& flags) -> std::string_view {
       return flags.expected.empty() ? kNeedsExpected : "";
     },
     .text = junit_text},
    {.flag = "--outcomes-csv",
     .help = "CSV file with one row per query: its best match and the verdict",
     .group = kFileGroup,
     .of_scores = true,
     .of_several = true,
     .header = kOutcomesHeader,
     .text = outcomes_text},
    {.flag = "--recognitions-csv",
     .help = "CSV file with one row per recognized place: frames, recognitions and the verdict",
     .group = kFileGroup,
     .of_several = true,
     .header = kRecognitionsHeader,
     .text = recognitions_text},
    {.flag = "--pairs",
     .help = "list of the best references of each query, one \"query reference\" per line, as for "
             "hloc; needs no ground truth",
     .group = kFileGroup,
     .of_scores = true,
     .needs_truth = false,
     .text = pairs_text},
    {.flag = "--save-trajectory",
     .help = "TUM trajectory of the positions of recognized frames (time x y z qx qy qz qw), as "
             "for evo; needs poses of training frames: --dataset, or --ground-truth-train",
     .group = kFileGroup,
     .lacks = [](const EvalFlags& flags) -> std::string_view {
       if (!flags.truth.dataset.empty() || !flags.truth.flags.options.reference.empty()) return "";
       return "needs the positions of training frames: --dataset with \"poses\", or "
              "--ground-truth-train";
     },
     .text = trajectory_text}};

}  // namespace

std::span<const EvalOutput> eval_outputs() { return kOutputs; }

const std::string& EvalFlags::output(std::string_view flag) const {
  const auto* found = std::ranges::find(kOutputs, flag, &EvalOutput::flag);
  assert(found != std::end(kOutputs));
  return outputs[static_cast<size_t>(found - kOutputs)];
}

std::vector<GivenOutput> given_outputs(const EvalFlags& flags) {
  std::vector<GivenOutput> given;
  for (size_t i = 0; i < flags.outputs.size(); ++i)
    if (!flags.outputs[i].empty()) given.push_back({&kOutputs[i], flags.outputs[i]});
  return given;
}

std::optional<double> constant_rate(const EvalFlags& flags, const Evaluated& evaluated) {
  if (flags.truth.dataset.empty()) return std::nullopt;
  const double rate = read_dataset(flags.truth.dataset).frames_per_second;
  if (!(rate > 0)) return std::nullopt;
  try {
    const SequenceArgument query = query_argument(flags, evaluated.evaluation.query().name).value();
    if (fs::exists(query.path) && states_times(open_sequence(query))) return std::nullopt;
    const Sequence& evaluated_query = evaluated.evaluation.query();
    if (!evaluated_query.selection.speed.empty() && evaluated_query.selection.selected_fps > 0)
      return evaluated_query.fps;
    return rate / static_cast<double>(query.range.step);
  } catch (const Error&) {
    return std::nullopt;  // the query of a result is possibly of another data set
  }
}

void claim_outputs(const Session& session, const std::vector<GivenOutput>& given) {
  session.claim_output();
  for (const auto& [output, path, text] : given)
    if (output->draw != nullptr)
      claim_charts(session.outputs, path);
    else
      session.outputs.claim_file(path);
}

void make_outputs(const EvalRun& run, const Evaluated& evaluated, std::vector<GivenOutput>& given) {
  for (auto& [output, path, text] : given)
    if (output->draw != nullptr)
      output->draw(run, evaluated, run.session.outputs.folder(path, is_marked_folder).temporary());
    else
      text += output->text(run, evaluated);
}

void write_files(const Session& session, const std::vector<GivenOutput>& given) {
  for (const auto& [output, path, text] : given)
    if (output->text != nullptr)
      session.outputs.file(path).write(std::string(output->header) + text);
}

std::string output_text(const Session& session, TableFormat format, const std::string& brief,
                        const std::string& tables) {
  if (format != TableFormat::text) return tables;
  return session.options.verbose ? brief + "\n" + tables : brief;
}

PairList pair_list(const Session& session, const EvalFlags& flags, const ScoreMatrix* matrix,
                   const ScoreLayout& layout, const Result* result) {
  constexpr uint64_t kDefaultPairs = 10;  // of scores
  assert(matrix != nullptr || result != nullptr);
  const std::vector<MatchedFrame> pairs =
      matrix == nullptr
          ? best_pairs(*result)
          : best_pairs(*matrix, layout, flags.top_k.value_or(result ? 1 : kDefaultPairs),
                       session.monitor);
  const size_t sequences = layout.scope.sequences.size();
  std::vector<std::string> searched;
  for (const auto& one : layout.scope.sequences) searched.push_back(one.sequence.name);
  if (result == nullptr) searched.clear();
  const std::vector<std::string> query = query_names(flags, layout.scope.query.name);
  std::vector<std::vector<std::string>> train = train_names(flags, searched);
  if (sequences == 1 && train.size() > 1) train = {joined(train)};  // the columns of scores
  if (sequences > 1 && train.size() < sequences)
    throw Error(ErrorKind::usage,
                "--pairs: name the frames of all {} training sequences, in the order of the "
                "database, with --train",
                sequences);
  train.resize(std::max(train.size(), sequences));
  const auto has_blank = [](const std::vector<std::string>& names) {
    return std::ranges::any_of(names, [](const std::string& name) {
      return name.find_first_of(" ,;\t#\"\n") != std::string::npos;
    });
  };
  const bool has_blanks = has_blank(query) || std::ranges::any_of(train, has_blank);
  const GroundTruthScope& scope = layout.scope;
  require_names(query, scope.query, "the query");
  for (size_t s = 0; s < sequences; ++s)
    require_names(train[s], scope.sequences[s].sequence, scope.sequences[s].sequence.name);
  std::string text;
  for (const MatchedFrame& pair : pairs) {  // of selected frames; files count recorded ones
    const Selection& of_train = scope.sequences[pair.match.sequence].sequence.selection;
    const std::string left = name_of(query, scope.query.selection.source_of(pair.query));
    const std::string right =
        name_of(train[pair.match.sequence], of_train.source_of(pair.match.reference));
    text += has_blanks ? fmt::format("{},{}\n", csv_field(left), csv_field(right))
                       : fmt::format("{} {}\n", left, right);
  }
  return {pairs.size(), std::move(text)};
}

}  // namespace vpr
