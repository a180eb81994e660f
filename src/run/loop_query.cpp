#include "run/loop_query.h"

#include <cmath>

#include <fmt/format.h>

#include "base/error.h"
#include "describe/imported.h"
#include "match/match.h"
#include "match/past_scores.h"
#include "run/train.h"
#include "truth/times.h"

namespace vpr {
namespace {

constexpr double kMostSeconds = 1e9;

void refuse(bool is_asked, const std::string& what) {
  if (is_asked) throw Error(ErrorKind::usage, what);
}

void check_gap(const SequenceQuerySettings& settings) {
  const bool has_seconds = settings.loop_gap_s != 0;
  refuse(
      settings.loop_gap == 0 && !has_seconds,
      "--loop needs --loop-gap, how long ago a place must have been left before it can be closed "
      "as a loop: in frames (--loop-gap 300) or in seconds (--loop-gap 30s)");
  refuse(settings.loop_gap != 0 && has_seconds,
         "loop_gap and loop_gap_s are given: a gap is of frames or of seconds");
  refuse(has_seconds && !(settings.loop_gap_s > 0 && settings.loop_gap_s <= kMostSeconds),
         fmt::format("loop_gap_s must be above 0, found {}", settings.loop_gap_s));
}

void check_method(const SequenceQuerySettings& settings) {
  const SequenceMethod& method = find_sequence_method(settings.method);
  refuse(method.has_paths,
         fmt::format("{} would follow the path that is being walked: --loop is for fastable, "
                     "fastable-online and openable",
                     settings.method));
  refuse(!settings.rates.empty(),
         "windows of several rates (--rates) have no common past: leave them out with --loop");
  refuse(score_kind(settings.score).is_offline,
         "standardized-offline learns from later frames; with --loop take --score standardized");
  refuse(settings.fusion_weight.has_value(),
         "--fuse asks FAB-MAP's database of training frames, and --loop has none");
  if (score_kind(settings.score).needs_statistics) check_past_settings(settings.standardization);
}

void check_scale(const SequenceQuerySettings& settings) {
  refuse(
      scale_of(settings) == ThresholdScale::relative,
      "t_r_scale relative needs the largest distance of the whole sequence; with --loop omit it, "
      "and pass t_r in bits per frame, as in --t-r 250");
}

void check_elsewhere(const SequenceQuerySettings& settings) {
  refuse(settings.decision == Decision::margin && !settings.margin,
         "an automatic margin is learned from training sequences, and --loop has none; give a "
         "number, as in --margin 20");
  const bool has_width = settings.margin_width || settings.loop_gap != 0;
  refuse(settings.decision == Decision::margin && !has_width,
         "what is elsewhere is so many frames away as --loop-gap says, unless that is in seconds; "
         "give --margin-width, too");
  refuse(!settings.only_sequences.empty() || !settings.same_place.empty(),
         "--only-sequence and --same-place name training sequences, and --loop has none");
}

}  // namespace

DescriptorSet describe_walk(const Sequence& walk, SequenceQuerySettings& settings,
                            const Monitor& monitor) {
  if (settings.descriptor.empty())
    settings.descriptor = walk.kind == SequenceKind::descriptors ? kVectorKind : "ldb";
  SequenceDatabase described;
  described.descriptors.kind = &descriptor_kind(settings.descriptor);
  if (described.descriptors.kind->shape.element == ElementType::coordinates)
    described.descriptors.unit = coordinate_unit(settings.descriptor, {&walk, 1}, monitor);
  return describe_frames(walk, described, settings.skip_unreadable, monitor);
}

SequenceDatabase own_walk(const DescriptorSet& query, const std::string& name) {
  SequenceDatabase walk;
  walk.descriptors.kind = query.descriptors.kind;
  walk.descriptors.unit = query.descriptors.unit;
  walk.descriptors.append(query.rows());
  walk.sequences.push_back({name, query.frames.names, query.frames.unreadable});
  walk.shared_places.emplace();
  return walk;
}

LoopGap loop_gap_of(const SequenceQuerySettings& settings) {
  if (settings.loop_gap != 0) return {{}, settings.loop_gap};
  return {std::llround(settings.loop_gap_s * double{kSecond}), 0};
}

void check_loop(const SequenceQuerySettings& settings) {
  check_gap(settings);
  check_method(settings);
  check_scale(settings);
  check_elsewhere(settings);
}

void refuse_loop(const SequenceQuerySettings& settings) {
  refuse(settings.loop,
         "a walk against its own past (loop) has no database: vpr-query --loop --query FOLDER");
}

}  // namespace vpr
