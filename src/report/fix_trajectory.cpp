#include "report/fix_trajectory.h"

#include <fmt/format.h>

#include "ground_truth/times.h"
#include "pipeline/evaluate.h"

namespace vpr {
namespace {

/// Where each query frame is said to be; nothing for frames without a fix.
std::vector<std::optional<FrameMatch>> fix_matches(const Evaluation& evaluation) {
  const Judgement& judgement = evaluation.judgement;
  std::vector<std::optional<FrameMatch>> matches(judgement.fixes.size());
  if (!evaluation.result) {
    for (const QueryOutcome& query : judgement.outcomes.queries)
      if (judgement.fixes[query.frame] != Fix::none) matches[query.frame] = query.best;
    return matches;
  }
  const Result& result = evaluation.result->result;
  const std::vector<const Match*> hits = fixing_hits(result);
  for (size_t frame = 0; frame < hits.size(); ++frame) {
    if (hits[frame] == nullptr) continue;
    const uint32_t sequence = result.places ? 0 : hits[frame]->target;
    matches[frame] = FrameMatch{sequence, anchor_of(hits[frame]->train, result.window_length())};
  }
  return matches;
}

const Pose* position_of(const TrainPositions& positions, const FrameMatch& match) {
  if (match.sequence >= positions.size()) return nullptr;
  const auto& frames = positions[match.sequence];
  if (match.reference >= frames.size() || !frames[match.reference]) return nullptr;
  return &*frames[match.reference];
}

std::string time_of(const FrameClock& clock, size_t frame) {
  if (frame < clock.sources.size()) frame = clock.sources[frame];
  if (frame < clock.times_ns.size()) return time_text(clock.times_ns[frame]);
  const double rate = clock.frames_per_second.value_or(1);
  return fmt::format("{:.6f}", static_cast<double>(frame) / rate);
}

}  // namespace

std::string fix_trajectory(const Evaluation& evaluation, const TrainPositions& positions,
                           const FrameClock& clock) {
  const bool is_seconds = !clock.times_ns.empty() || clock.frames_per_second;
  std::string text = fmt::format("# time{} x y z qx qy qz qw\n", is_seconds ? " (s)" : "");
  const auto matches = fix_matches(evaluation);
  for (size_t frame = 0; frame < matches.size(); ++frame) {
    if (!matches[frame]) continue;
    const Pose* pose = position_of(positions, *matches[frame]);
    if (pose == nullptr) continue;
    const auto& [x, y, z] = pose->position;
    const std::string height = z == 0 ? "0" : fmt::format("{:.6f}", z);
    text += fmt::format("{} {:.6f} {:.6f} {} 0 0 0 1\n", time_of(clock, frame), x, y, height);
  }
  return text;
}

}  // namespace vpr
