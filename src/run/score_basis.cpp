#include "run/score_basis.h"

#include <cassert>

#include "base/error.h"
#include "match/components.h"
#include "match/distance_statistics.h"
#include "match/past_scores.h"
#include "match/zscores.h"
#include "run/train.h"

namespace vpr {

void ensure_statistics(SequenceDatabase& database, const Monitor& monitor) {
  if (!database.statistics)
    database.statistics = compute_statistics(descriptor_spans(database), {}, monitor);
  if (!database.statistics->components)
    database.statistics->components = compute_components(
        descriptor_spans(database), database.statistics->typical_distance, monitor);
}

std::optional<ScoreBasis> score_basis(const TrainStatistics* learned,
                                      const SequenceQuerySettings& settings) {
  const ScoreKind& kind = score_kind(settings.score);
  if (!kind.needs_statistics || settings.loop) return std::nullopt;
  if (learned == nullptr)
    throw Error(ErrorKind::usage,
                "the database has no training statistics, which z-scores start from; "
                "train it again");
  assert(learned->components);
  ScoreBasis basis = make_score_basis(settings.zscore, kind.is_offline, *learned);
  if (settings.fusion_weight) {
    if (learned->fused == nullptr)
      throw Error(ErrorKind::usage,
                  "fuse_beta needs FAB-MAP's database of the training sequences: pass --fuse.");
    basis.fusion = make_fusion_basis(learned->fused, *settings.fusion_weight, learned->settings);
  }
  return basis;
}

FrameDistances scored(FrameDistances distances, const std::optional<ScoreBasis>& basis,
                      const QueryPlan& plan, const Monitor& monitor) {
  if (plan.settings.loop && score_kind(plan.settings.score).needs_statistics)
    return past_zscores(std::move(distances), plan.settings.zscore);
  if (!basis) return distances;
  return zscores(std::move(distances), *basis, monitor);
}

}  // namespace vpr
