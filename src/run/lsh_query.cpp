#include "run/lsh_query.h"

#include <functional>

#include "base/stopwatch.h"
#include "match/lsh.h"
#include "match/match.h"
#include "run/query_steps.h"

namespace vpr {
namespace {

SearchRecall recall_of(const RecognitionScanResult& found, const RecognitionScanResult& exact) {
  SearchRecall recall;
  recall.recognitions = exact.recognitions.size();
  for (size_t window = 0; window < exact.best.size(); ++window) {
    if (!exact.best[window]) continue;
    ++recall.windows;
    const auto& best = found.best[window];
    if (best && best->score == exact.best[window]->score) ++recall.found_best;
  }
  return recall;
}

}  // namespace

QueryRun query_lsh(const SequenceDatabase& database, const DescriptorSet& query,
                   const std::string& query_name, const ResolvedSettings& settings,
                   const QueryResources& resources, const Monitor& monitor) {
  QueryPlan plan = plan_query(database, query, query_name, settings, resources, monitor);
  const MatchSettings windows{plan.settings.window_length, resources.memory_limit,
                              resources.kernels, plan.settings.lsh, resources.seed};
  FrameDistances distances = searched_distances(plan);
  for (size_t s = 0; s < plan.sequences.size(); ++s)
    if (!plan.sequences[s].searched) distances.train[s] = {};
  QueryRun run;
  Stopwatch watch;
  RecognitionScan some(scan_settings(plan, resources));
  match_lsh(distances, windows, monitor, std::ref(some));
  const RecognitionScanResult found = some.result();
  run.result = make_result(plan, found);
  run.seconds["match"] = watch.elapsed_s();
  watch = {};
  RecognitionScan all(scan_settings(plan, resources));
  match(distances, windows, {{std::ref(all)}}, monitor);
  run.result.recall = recall_of(found, all.result());
  run.seconds["recall"] = watch.elapsed_s();
  watch = {};
  cluster(run.result, monitor);
  run.seconds["cluster"] = watch.elapsed_s();
  run.result.views = find_views(plan);
  return run;
}

}  // namespace vpr
