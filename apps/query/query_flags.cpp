#include "query_flags.h"

#include <fmt/format.h>

#include "common/selection_flags.h"
#include "evaluate/loops.h"
#include "fabmap/model.h"
#include "truth/times.h"

namespace vpr {
namespace {

std::vector<std::string> variant_names() {
  std::vector<std::string> names;
  for (const FabmapVariant& variant : fabmap_variants()) names.emplace_back(variant.name);
  return names;
}

void add_matrix_flags(const Command& app, QueryScores& scores) {
  add_score_flags(app, scores.matrix,
                  "windows of a matrix that any program computed (.npy, query frames x training "
                  "frames), instead of DB and --query (which only names the query)",
                  kScoreGroup);
  app.add_list("--train-sequence", scores.train_sequences,
               "NAME=FIRST:LAST: these training frames of the matrix are a sequence, which "
               "windows do not cross (from 0, without LAST); repeatable (default: all are "
               "one)")
      .group(kScoreGroup);
}

// Both families have a gap in frames, and only sequences one in seconds.
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

}  // namespace

void add_inputs(const Command& app, QueryInputs& inputs) {
  app.add_option("DB", inputs.database,
                 "database made by vpr-train; none with --scores, or --loop of sequences");
  app.add_option("--query", inputs.query,
                 "query sequence: folder, list or video, with an optional range "
                 "PATH@FIRST:LAST[:STEP]; with --dataset, the name of one of its queries");
  app.add_option(
      "--query-npy", inputs.query_npy,
      "the query's descriptors instead of --query, for a database of vpr-train "
      "descriptors: n x d numbers, or a folder with a .npy file a frame, with an optional "
      "range");
  app.add_option("--dataset", inputs.dataset, "data set description that holds the query");
  add_warp_flag(app, inputs.selection.warp);
  add_rate_flags(app, inputs.selection, "the query");
  add_matrix_flags(app, inputs.scores);
}

void add_sequence_flags(const Command& app, QueryInputs& inputs, SequenceQuerySettings& settings) {
  const auto group = [](Flag flag) { return flag.group(kSequenceGroup); };
  group(add_setting(app, "--c-l", settings.window_length,
                    "window length c_l in frames (default 40)"));
  group(
      add_setting(app, "--t-r", settings.distance_threshold,
                  "threshold t_r: a number, or auto, from how close two or more training sequences "
                  "come to each other (default: auto)"));
  add_score_settings(app, settings, kSequenceGroup);
  add_decision_settings(app, settings, inputs.fuse, kSequenceGroup);
  group(add_setting(app, "--safety-factor", settings.safety_factor,
                    "multiplies the automatic t_r (default: the database's)"));
  group(add_setting(app, "--margin", settings.margin,
                    "with --decide margin, by how much a best match must be better than the best "
                    "one elsewhere, in score a frame; or auto (default): from how large it is "
                    "where training sequences show different places"));
  group(app.add_list("--only-sequence", settings.only_sequences,
                     "search only this training sequence; repeatable"));
  group(app.add_option("--save-matrix", inputs.matrix,
                       "write the distances: .npy (int32, never whole in memory) or .png (dark: "
                       "close)"));
  group(app.add_option("--ground-truth", inputs.ground_truth,
                       fmt::format("drawn into the picture: {}", ground_truth_help())));
  group(app.add_flag("--follow", inputs.follow,
                     "print a line of JSON for each frame as it comes: of a folder that grows, a "
                     "camera (--query /dev/video0), a video, a list, or image paths on standard "
                     "input (--query -)"));
  group(add_setting(app, "--verify", inputs.verify_cells,
                    "recompute N random cells by definition (windows of one rate, raw or "
                    "zscore); exit code 5 if any differs"));
  group(add_memory_flag(app, inputs.memory_limit,
                        "for rings and recognitions, as in 512M; more is computed twice instead"));
}

void add_loop_flags(const Command& app, QueryLoop& loop, SequenceQuerySettings& sequence,
                    FabmapQuerySettings& fabmap) {
  const auto group = [](Flag flag) { return flag.group("Loop closures"); };
  group(app.add_flag("--loop", fabmap.loop,
                     "frames of the query against its own earlier ones: of FAB-MAP as places "
                     "behind the database's, else without a DB"));
  group(app.add_option(
            "--loop-gap", [&](const std::string& text) { set_loop_gap(text, sequence, fabmap); },
            "how long before a frame another must be to be matched, in frames (300) or seconds "
            "(30s); of FAB-MAP, frames in between (default 10)"))
      .type_name("TIME");
  group(app.add_option("--times", loop.times,
                       "when frames were taken, for a gap in seconds: a list, one a line (default: "
                       "the names of images, or the video's own)"))
      .type_name("FILE");
  group(add_setting(app, "--descriptor", sequence.descriptor,
                    "what frames are described by, as in vpr-train fastable (default ldb; vectors "
                    "with --query-npy)"));
  group(app.add_option("--save-loops", loop.list,
                       "write a line query,match,score for each best match, for vpr-eval --loops; "
                       "with --t-r or --margin, for each that is a recognition"))
      .type_name("FILE");
}

void add_fabmap_flags(const Command& app, QueryInputs& inputs, FabmapQuerySettings& settings) {
  const auto group = [](Flag flag) { return flag.group(kFabmapGroup); };
  group(add_setting(app, "--t-p", settings.place_threshold,
                    "probability above which a view is recognized (default 0.99)"));
  group(add_setting(app, "--c-w", settings.window, "in so many frames in a row (default 1)"));
  group(add_setting(app, "--variant", settings.variant,
                    "how likelihoods are computed (default fabmap2)"))
      .choices("VARIANT", variant_names());
  group(add_setting(app, "--word-model", settings.word_model, "tree (default) or naive-bayes"));
  group(add_setting(app, "--new-place", settings.new_place,
                    "pretrain (average over the pretraining frames, default) or mean-field"));
  group(add_setting(app, "--new-place-samples", settings.new_place_samples,
                    "pretraining frames to draw for it; 0: all (default)"));
  group(app.add_flag("--motion-model", settings.posterior.motion_model,
                     "neighbors of what was likely before are likely now"));
  group(app.add_option("--explain", inputs.explained_frame,
                       "list the words that speak for and against the best places of this frame, "
                       "and draw them in RESULT.explain.png"));
  group(
      app.add_list("--train-images", inputs.train_images,
                   "[GROUP=]SEQUENCE: images of a training sequence, to draw views with --explain; "
                   "repeatable"));
  group(app.add_option("--query-bow", inputs.query_bow,
                       "OpenFABMAP's BOW matrix (.npy) instead of --query, with an "
                       "optional range"));
  group(app.add_option("--save-posteriors", inputs.posteriors,
                       "write frames x (1 + views) probabilities, new place first (.npy)"));
}

}  // namespace vpr
