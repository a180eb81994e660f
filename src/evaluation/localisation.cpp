#include "evaluation/localisation.h"

#include <algorithm>
#include <cassert>

namespace vpr {
namespace {

Fix fix_of(PlaceLabel label) {
  return label == PlaceLabel::same        ? Fix::right
         : label == PlaceLabel::different ? Fix::wrong
                                          : Fix::unjudged;
}

}  // namespace

std::optional<double> Localisation::share() const {
  if (frames == 0) return std::nullopt;
  return static_cast<double>(right) / static_cast<double>(frames);
}

Localisation localise(std::span<const Fix> fixes, std::span<const double> travelled_m) {
  assert(travelled_m.empty() || travelled_m.size() == fixes.size());
  Localisation found;
  found.frames = fixes.size();
  found.wrong = static_cast<size_t>(std::count(fixes.begin(), fixes.end(), Fix::wrong));
  const bool has_metres = !travelled_m.empty();
  double gap_m = 0;
  size_t gap_begin = 0;  // first frame after the last right fix
  double last_fix_m = has_metres ? travelled_m.front() : 0;
  const auto end_gap = [&](size_t end, double here_m) {
    found.longest_gap_frames = std::max(found.longest_gap_frames, end - gap_begin);
    if (has_metres) gap_m = std::max(gap_m, here_m - last_fix_m);
  };
  for (size_t frame = 0; frame < fixes.size(); ++frame) {
    if (fixes[frame] != Fix::right) continue;
    const double here_m = has_metres ? travelled_m[frame] : 0;
    if (found.right == 0) {
      found.first_fix_frames = frame;
      if (has_metres) found.first_fix_m = here_m - travelled_m.front();
    }
    ++found.right;
    end_gap(frame, here_m);
    gap_begin = frame + 1;
    last_fix_m = here_m;
  }
  end_gap(fixes.size(), has_metres ? travelled_m.back() : 0);
  if (has_metres) found.longest_gap_m = gap_m;
  return found;
}

std::vector<const Match*> fixing_hits(const Result& result) {
  const ScoreOrder order = result.score().order;
  std::vector<const Match*> hits(result.query_frames, nullptr);
  for (const Match& hit : result.hits) {
    const Match*& best = hits[anchor_of(hit.query, result.window_length())];
    if (best == nullptr || is_better(hit.score, best->score, order)) best = &hit;
  }
  return hits;
}

std::vector<Fix> fixes_of(const Result& result, const GroundTruth& truth) {
  const std::vector<const Match*> hits = fixing_hits(result);
  std::vector<Fix> fixes(hits.size(), Fix::none);
  for (size_t frame = 0; frame < hits.size(); ++frame)
    if (hits[frame] != nullptr)
      fixes[frame] = fix_of(label_of(truth, *hits[frame], result.window_length()));
  return fixes;
}

std::vector<Fix> fixes_of(const Outcomes& outcomes, std::optional<uint64_t> accepted) {
  std::vector<Fix> fixes(outcomes.query_frames, Fix::none);
  if (!accepted) return fixes;
  for (const QueryOutcome& query : outcomes.queries) {
    if (!query.best || query.key > *accepted) continue;
    if (query.verdict == Verdict::correct) fixes[query.frame] = Fix::right;
    if (query.verdict == Verdict::incorrect) fixes[query.frame] = Fix::wrong;
    if (query.verdict == Verdict::ignored) fixes[query.frame] = Fix::unjudged;
  }
  return fixes;
}

}  // namespace vpr
