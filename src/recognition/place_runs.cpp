#include "recognition/place_runs.h"

#include <algorithm>

namespace vpr {
namespace {

/// A run, and the hit that it ended with so far.
struct OpenRun {
  size_t run = 0;
  Match last;
};

bool are_near(const Match& a, const Match& b, size_t reach_places) {
  return std::max(a.train, b.train) - std::min(a.train, b.train) <= reach_places;
}

void add_hit(PlaceRun& run, const Match& hit) {
  run.last_frame = hit.query;
  run.first_place = std::min(run.first_place, hit.train);
  run.last_place = std::max(run.last_place, hit.train);
  ++run.hits;
  run.probability = std::max(run.probability, hit.score);
}

}  // namespace

std::vector<PlaceRun> place_runs(std::span<const Match> hits, size_t reach, size_t reach_places) {
  std::vector<PlaceRun> runs;
  std::vector<OpenRun> open;
  for (const Match& hit : hits) {
    std::erase_if(open, [&](const OpenRun& one) { return one.last.query + reach < hit.query; });
    const auto found = std::find_if(open.rbegin(), open.rend(), [&](const OpenRun& one) {
      return are_near(one.last, hit, reach_places);
    });
    if (found == open.rend()) {
      open.push_back({runs.size(), hit});
      runs.push_back({hit.query, hit.query, hit.train, hit.train, 0, 0});
      add_hit(runs.back(), hit);
    } else {
      add_hit(runs[found->run], hit);
      found->last = hit;
    }
  }
  return runs;
}

}  // namespace vpr
