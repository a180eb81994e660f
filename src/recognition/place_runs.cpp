#include "recognition/place_runs.h"

#include <algorithm>

namespace vpr {
namespace {

/// A run, and the hit that it ended with so far.
struct OpenRun {
  size_t run = 0;
  PlaceMatch last;
};

bool are_near(const PlaceMatch& a, const PlaceMatch& b, size_t reach_places) {
  return std::max(a.place, b.place) - std::min(a.place, b.place) <= reach_places;
}

void add_hit(PlaceRun& run, const PlaceMatch& hit) {
  run.last_frame = hit.frame;
  run.first_place = std::min(run.first_place, hit.place);
  run.last_place = std::max(run.last_place, hit.place);
  ++run.hits;
  run.probability = std::max(run.probability, hit.probability);
}

}  // namespace

std::vector<PlaceRun> place_runs(std::span<const PlaceMatch> hits, size_t reach,
                                 size_t reach_places) {
  std::vector<PlaceRun> runs;
  std::vector<OpenRun> open;
  for (const PlaceMatch& hit : hits) {
    std::erase_if(open, [&](const OpenRun& one) { return one.last.frame + reach < hit.frame; });
    const auto found = std::find_if(open.rbegin(), open.rend(), [&](const OpenRun& one) {
      return are_near(one.last, hit, reach_places);
    });
    if (found == open.rend()) {
      open.push_back({runs.size(), hit});
      runs.push_back({hit.frame, hit.frame, hit.place, hit.place, 0, 0});
      add_hit(runs.back(), hit);
    } else {
      add_hit(runs[found->run], hit);
      found->last = hit;
    }
  }
  return runs;
}

}  // namespace vpr
