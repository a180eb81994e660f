#include <fmt/format.h>

#include "base/error.h"
#include "base/named_table.h"
#include "evaluate/loops.h"
#include "fabmap/model.h"
#include "query.h"
#include "sequence/sequence.h"
#include "sequence/sequence_source.h"
#include "truth/times.h"

namespace vpr {
namespace {

// Both families have a gap in frames, sequences also a gap in seconds.
void set_loop_gap(const std::string& text, SequenceQuerySettings& sequence,
                  FabmapQuerySettings& fabmap) {
  constexpr const char* kFlag = "--loop-gap";
  sequence.loop_gap = 0;
  sequence.loop_gap_s = 0;
  if (text.ends_with('s')) {
    const LoopGap gap = parse_loop_gap(text, kFlag);
    sequence.loop_gap_s = static_cast<double>(*gap.nanoseconds) / double{kSecond};
    return;
  }
  value_from_json(flag_value(text), fabmap.loop_gap, "command line", kFlag);
  sequence.loop_gap = fabmap.loop_gap;
}

// The query of --query or --query-npy.
NamedSequence query_of_flags(const QueryOptions& options) {
  if (options.query_npy.empty() && !options.query)
    throw Error(ErrorKind::usage, "the query is missing, as in --query FOLDER");
  const SequenceArgument argument =
      parse_sequence_argument(options.query_npy.empty() ? *options.query : options.query_npy);
  if (!options.query_npy.empty()) require_descriptors(argument);
  return {sequence_names({argument}).front(), argument};
}

}  // namespace

void add_inputs(const Command& app, QueryOptions& options) {
  app.add_option("DB", options.database,
                 "database of vpr-train; omit it with --scores, or with --loop for sequences");
  app.add_option("--query", options.query,
                 "query sequence: folder, list or video, with an optional range "
                 "PATH@FIRST:LAST[:STEP]; with --dataset, the name of one of its queries");
  app.add_option("--query-npy", options.query_npy,
                 "descriptors instead of --query, for a database of vpr-train descriptors: n x d "
                 "values, or a folder with one .npy file per frame, with an optional range");
  app.add_option("--dataset", options.dataset, "data set description with the query");
  add_speed_flag(app, options.selection.speed);
  add_rate_flags(app, options.selection, "the query");
  add_score_flags(app, options.scores,
                  "score matrix of any program (.npy, query frames x training frames), instead of "
                  "DB and --query, which only names the query",
                  kScoreGroup);
  app.add_list("--train-sequence", options.train_sequences,
               "NAME=FIRST:LAST: training frames of the matrix that form a sequence (from 0, "
               "without LAST), which windows do not cross; repeatable (default: one sequence)")
      .group(kScoreGroup);
}

void add_sequence_flags(const Command& app, QueryOptions& options,
                        SequenceQuerySettings& settings) {
  const auto group = [](Flag flag) { return flag.group(kSequenceGroup); };
  group(add_setting(app, "--c-l", settings.window_length,
                    "window length c_l in frames (default: 40)"));
  group(add_setting(app, "--t-r", settings.distance_threshold,
                    "threshold t_r: a number, or auto, the smallest distance between two or more "
                    "training sequences (default: auto)"));
  add_score_settings(app, settings, kSequenceGroup);
  add_decision_settings(app, settings, options.fuse, kSequenceGroup);
  group(add_setting(app, "--safety-factor", settings.safety_factor,
                    "factor of the automatic t_r (default: the database's)"));
  group(add_setting(app, "--margin", settings.margin,
                    "with --decide margin, least difference of best match and runner-up in score "
                    "per frame: a number, or auto, from margins of training sequences that show "
                    "different places (default: auto)"));
  group(app.add_list("--only-sequence", settings.only_sequences,
                     "training sequence to search; repeatable (default: all)"));
  group(app.add_option("--save-matrix", options.matrix,
                       "write the score matrix: .npy (int32, never whole in memory) or .png (dark: "
                       "close)"));
  group(app.add_option(
      "--ground-truth", options.ground_truth,
      fmt::format("ground truth for --save-matrix FILE.png: {}", ground_truth_help())));
  group(app.add_flag("--follow", options.follow,
                     "print one line of JSON for each frame as it arrives, from a growing folder, "
                     "a camera (--query /dev/video0), a video, a list, or image paths on standard "
                     "input (--query -)"));
  group(add_setting(app, "--verify", options.verify_cells,
                    "number of random cells to recompute with the reference implementation "
                    "(windows of one rate, raw or zscore); exit code 5 if any differs"));
  group(add_memory_flag(app, options.memory_limit,
                        "memory for rings and recognitions in bytes, as in 512M; beyond it, "
                        "values are computed twice"));
}

void add_loop_flags(const Command& app, QueryOptions& options, SequenceQuerySettings& sequence,
                    FabmapQuerySettings& fabmap) {
  const auto group = [](Flag flag) { return flag.group("Loop closures"); };
  group(app.add_flag("--loop", fabmap.loop,
                     "match the query with its own earlier frames: without DB, or for FAB-MAP as "
                     "places after those of the database"));
  group(app.add_option(
            "--loop-gap", [&](const std::string& text) { set_loop_gap(text, sequence, fabmap); },
            "least separation of two matched frames, in frames (300) or seconds (30s); for "
            "FAB-MAP, the frames in between (default: 10)"))
      .type_name("TIME");
  group(app.add_option("--frame-times", options.loop_times,
                       "times of the frames for a gap in seconds: a list with one per line "
                       "(default: from names of images, or from the video)"))
      .type_name("FILE");
  group(add_setting(app, "--descriptor", sequence.descriptor,
                    "descriptor of frames, as in vpr-train fastable (default: ldb; vectors with "
                    "--query-npy)"));
  group(app.add_option("--save-loops", options.loop_list,
                       "write one line query,match,score per best match, for vpr-eval --loops; "
                       "only recognitions with --t-r or --margin"))
      .type_name("FILE");
}

void add_fabmap_flags(const Command& app, QueryOptions& options, FabmapQuerySettings& settings) {
  const auto group = [](Flag flag) { return flag.group(kFabmapGroup); };
  group(add_setting(app, "--t-p", settings.place_threshold,
                    "probability threshold t_p of a recognition (default: 0.99)"));
  group(add_setting(app, "--c-w", settings.window,
                    "consecutive frames c_w that must exceed t_p (default: 1)"));
  group(add_setting(app, "--variant", settings.variant,
                    "computation of likelihoods (default: fabmap2)"))
      .choices("VARIANT", names_of(fabmap_variants()));
  group(add_setting(app, "--word-model", settings.word_model,
                    "dependencies of words (default: tree)"));
  group(add_setting(app, "--new-place", settings.new_place,
                    "likelihood of a new place: average over the pretraining frames, or mean field "
                    "(default: pretrain)"));
  group(add_setting(app, "--new-place-samples", settings.new_place_samples,
                    "random pretraining frames for it; 0: all (default: 0)"));
  group(app.add_flag("--motion-model", settings.posterior.motion_model,
                     "raise the prior of places next to the previous place"));
  group(app.add_option("--explain", options.explained_frame,
                       "list the words for and against the best places of this frame, and draw "
                       "them in RESULT.explain.png"));
  group(app.add_list("--train", options.train_images,
                     "[GROUP=]SEQUENCE: images of a training sequence for the plot of --explain; "
                     "repeatable"));
  group(
      app.add_option("--query-bow", options.query_bow,
                     "OpenFABMAP's BOW matrix (.npy) instead of --query, with an optional range"));
  group(app.add_option("--save-posteriors", options.posteriors,
                       "write frames x (1 + views) probabilities, new place first (.npy)"));
}

QuerySource find_query(const QueryOptions& options, const Session& session) {
  QuerySource source;
  if (!options.ground_truth.empty())
    source.ground_truth = ground_truth_argument(options.ground_truth, options.ground_truth_flags);
  std::optional<Dataset> dataset;
  if (!options.dataset.empty()) {
    dataset = read_dataset(options.dataset);
    const DatasetQuery& query = select_query(*dataset, options.query);
    source.sequence = query.sequence;
    if (!source.ground_truth)
      source.ground_truth =
          ground_truth_of(query, DatabaseFamily::sequences, options.ground_truth_flags);
  } else {
    source.sequence = query_of_flags(options);
  }
  SequenceArgument& sequence = source.sequence.sequence;
  if (!options.follow || std::filesystem::is_regular_file(sequence.path))
    sequence = selected(sequence, options.selection, options.ground_truth_flags.options.query_times,
                        dataset ? &*dataset : nullptr, session);
  if (source.ground_truth) remove_selection_times(*source.ground_truth, options.selection);
  return source;
}

bool has_ground_truth(const QueryOptions& options) {
  GroundTruthFlags flags = options.ground_truth_flags;
  if (options.selection.fps) flags.options.query_times.clear();
  return !options.ground_truth.empty() || has_ground_truth_flags(flags);
}

QueryResources resources_of(const QueryOptions& options, const Session& session) {
  return {session.kernels, options.memory_limit, options.verify_cells, session.options.seed};
}

void claim_outputs(const QueryOptions& options, const Session& session) {
  const std::string& output = session.options.output;
  if (!output.empty()) claim_result(output, session.outputs);
  if (options.explained_frame && !output.empty())
    session.outputs.claim_file(companion_path(output, "explain.png"));
  if (!options.matrix.empty() && !options.matrix.ends_with(".npy") &&
      !options.matrix.ends_with(".png"))
    throw Error(ErrorKind::usage,
                fmt::format("--save-matrix writes .npy or .png, found {}", options.matrix));
  for (const std::string& file : {options.matrix, options.posteriors, options.loop_list})
    if (!file.empty()) session.outputs.claim_file(file);
}

ResultContext make_context(const QueryOptions& options, const Session& session) {
  ResultContext context;
  context.run = session.run;
  context.run.simd_target = session.kernels.target;
  if (!options.scores.path.empty())
    context.run.paths["scores"] = options.scores.path;
  else if (!options.database.empty())
    context.run.paths["database"] = options.database;
  if (!options.fuse.empty()) context.run.paths["fuse"] = options.fuse;
  return context;
}

Json save_result(const Session& session, const Result& result, const ResultContext& context) {
  const std::string& output = session.options.output;
  return output.empty() ? result_json(result, context)
                        : write_result(output, result, context, session.outputs);
}

void save_loops(const QueryOptions& options, const Result& result, const Session& session) {
  if (!options.loop_list.empty())
    session.outputs.file(options.loop_list).write(loops_csv(loops_of(result)));
}

std::string query_title(const Result& result) {
  const std::string selection = selection_text(result.query.selection);
  return result.query.name + (selection.empty() ? "" : ", " + selection);
}

}  // namespace vpr
