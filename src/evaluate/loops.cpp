#include "evaluate/loops.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <map>
#include <set>
#include <unordered_map>
#include <utility>

#include <fmt/format.h>

#include "base/error.h"
#include "base/text.h"

namespace vpr {

namespace {

using Cube = std::array<double, 3>;  // whole numbers

struct CubeHash {
  size_t operator()(const Cube& cube) const {
    uint64_t hash = 0;
    for (const double side : cube) {
      hash = (hash ^ std::bit_cast<uint64_t>(side == 0 ? 0.0 : side)) * 0x9e3779b97f4a7c15U;
      hash ^= hash >> 29;
    }
    return hash;
  }
};

/// Frames by the cube that they lie in.
using Cubes = std::unordered_map<Cube, std::vector<size_t>, CubeHash>;

Cube cube_of(const Pose& pose, double side) {
  return {std::floor(pose.position[0] / side), std::floor(pose.position[1] / side),
          std::floor(pose.position[2] / side)};
}

bool is_any_near(const Trajectory& trajectory, const Cubes& cubes, const Cube& cube, size_t query,
                 double radius_m) {
  const auto found = cubes.find(cube);
  if (found == cubes.end()) return false;
  return std::any_of(found->second.begin(), found->second.end(), [&](size_t frame) {
    return distance_between(trajectory, query, frame) <= radius_m;
  });
}

// In the cube itself first, where most are.
bool has_near(const Trajectory& trajectory, const Cubes& cubes, double side, size_t query,
              double radius_m) {
  const Cube own = cube_of(*trajectory.poses[query], side);
  if (is_any_near(trajectory, cubes, own, query, radius_m)) return true;
  for (int neighbour = 0; neighbour < 27; ++neighbour) {
    const Cube cube = {own[0] + neighbour % 3 - 1, own[1] + neighbour / 3 % 3 - 1,
                       own[2] + neighbour / 9 - 1};
    if (neighbour != 13 && is_any_near(trajectory, cubes, cube, query, radius_m)) return true;
  }
  return false;
}

void check_rules(const LoopRules& rules, const Trajectory& trajectory) {
  if (!(rules.radius_m >= 0 && std::isfinite(rules.radius_m)))
    throw Error(ErrorKind::usage, "the radius of loops must be a number of metres, 0 or more");
  if (rules.gap.nanoseconds && trajectory.times_ns.empty())
    throw Error(ErrorKind::usage,
                fmt::format("{}: has no times for a gap in seconds; give them with --times, or the "
                            "gap in frames, as in --gap 300",
                            trajectory.name));
}

std::vector<Revisit> find_revisits(const LoopJudgement& judgement) {
  std::vector<Revisit> revisits;
  for (size_t frame = 0; frame < judgement.has_loop.size(); ++frame) {
    if (!judgement.has_loop[frame]) continue;
    if (revisits.empty() || revisits.back().last + 1 != frame) revisits.push_back({frame, frame});
    revisits.back().last = frame;
    if (judgement.is_found[frame]) revisits.back().is_found = true;
  }
  return revisits;
}

Curve curve_of_best(const LoopJudgement& judgement, ScoreOrder order) {
  std::map<size_t, ScoredItem> best;
  for (const JudgedLoop& judged : judgement.loops) {
    if (judged.label == PlaceLabel::ignore) continue;
    const ScoredItem item{score_key(*judged.loop.score, order), judged.label == PlaceLabel::same};
    const auto [found, is_new] = best.emplace(judged.loop.query, item);
    if (!is_new && item.key < found->second.key) found->second = item;
  }
  std::vector<ScoredItem> items;
  for (const auto& [query, item] : best) items.push_back(item);
  sort_items(items);
  return curve_of(items, judgement.frames_with_loop(), order);
}

constexpr size_t kFirstLine = 2;  // behind the header

bool is_hit(const Result& result, const Match& match) {
  const auto found = std::lower_bound(
      result.hits.begin(), result.hits.end(), match, [](const Match& a, const Match& b) {
        return a.query != b.query ? a.query < b.query : a.train < b.train;
      });
  return found != result.hits.end() && found->query == match.query && found->train == match.train;
}

bool is_decided(const Result& result) {
  const auto* settings = std::get_if<SequenceQuerySettings>(&result.settings);
  return settings != nullptr &&
         (settings->decision == Decision::margin || settings->distance_threshold);
}

// FAB-MAP's places are the query's own frames, behind those of a database, if it has any.
size_t first_own_place(const Result& result) {
  return result.places ? result.targets.front().frames - result.query_frames : 0;
}

}  // namespace

uint64_t LoopJudgement::count(PlaceLabel label) const {
  return static_cast<uint64_t>(std::ranges::count(loops, label, &JudgedLoop::label));
}

uint64_t LoopJudgement::frames_with_loop() const {
  return static_cast<uint64_t>(std::ranges::count(has_loop, true));
}

uint64_t LoopJudgement::frames_found() const {
  return static_cast<uint64_t>(std::ranges::count(is_found, true));
}

uint64_t LoopJudgement::revisits_found() const {
  return static_cast<uint64_t>(std::ranges::count(revisits, true, &Revisit::is_found));
}

std::optional<Revisit> LoopJudgement::longest_missed() const {
  std::optional<Revisit> longest;
  for (size_t first = 0; first < has_loop.size(); ++first) {
    size_t end = first;
    while (end < has_loop.size() && has_loop[end] && !is_found[end]) ++end;
    if (end == first) continue;
    if (!longest || end - first > longest->last - longest->first + 1) longest = {first, end - 1};
    first = end;
  }
  return longest;
}

double distance_between(const Trajectory& trajectory, size_t a, size_t b) {
  double square = 0;
  for (size_t k = 0; k < 3; ++k) {
    const double difference = trajectory.poses[a]->position[k] - trajectory.poses[b]->position[k];
    square += difference * difference;
  }
  return std::sqrt(square);
}

std::vector<bool> frames_with_loop(const Trajectory& trajectory, const LoopRules& rules) {
  // A little more, for what is just within the radius after rounding.
  const double side = rules.radius_m > 0 ? rules.radius_m * 1.000001 : 1;
  Cubes cubes;
  size_t past = 0;
  std::vector<bool> has_loop(trajectory.poses.size());
  for (size_t query = 0; query < has_loop.size(); ++query) {
    for (; past < query && is_past(rules.gap, trajectory.times_ns, query, past); ++past)
      if (trajectory.poses[past]) cubes[cube_of(*trajectory.poses[past], side)].push_back(past);
    has_loop[query] =
        trajectory.poses[query] && has_near(trajectory, cubes, side, query, rules.radius_m);
  }
  return has_loop;
}

LoopJudgement judge_loops(const LoopList& list, const Trajectory& trajectory,
                          const LoopRules& rules) {
  check_rules(rules, trajectory);
  LoopJudgement judgement;
  judgement.has_loop = frames_with_loop(trajectory, rules);
  judgement.is_found.resize(judgement.has_loop.size());
  std::set<std::pair<size_t, size_t>> seen;
  for (const ListedLoop& loop : list.loops) {
    if (!seen.emplace(loop.query, loop.match).second) {
      ++judgement.repeated;
      continue;
    }
    JudgedLoop judged{loop, distance_between(trajectory, loop.query, loop.match)};
    judged.label = !is_past(rules.gap, trajectory.times_ns, loop.query, loop.match)
                       ? PlaceLabel::ignore
                   : judged.distance_m <= rules.radius_m ? PlaceLabel::same
                                                         : PlaceLabel::different;
    if (judged.label == PlaceLabel::same) judgement.is_found[loop.query] = true;
    judgement.loops.push_back(judged);
  }
  judgement.revisits = find_revisits(judgement);
  if (list.has_scores) judgement.curve = curve_of_best(judgement, rules.order);
  return judgement;
}

std::vector<ListedLoop> loops_of(const Result& result) {
  std::vector<ListedLoop> loops;
  const size_t length = result.window_length();
  const ScoreKind& kind = result.score();
  const size_t first = first_own_place(result);
  for (const auto& best : result.best) {
    if (!best || best->train < first) continue;
    if (is_decided(result) && !is_hit(result, *best)) continue;
    const double score =
        kind.frame_value == nullptr ? best->score : kind.frame_value(best->score, length);
    loops.push_back({anchor_of(best->query, length), anchor_of(best->train - first, length), score,
                     loops.size() + kFirstLine});
  }
  return loops;
}

LoopList loop_list_of(const Result& result, const std::string& name, const Trajectory& trajectory) {
  if (!std::visit([](const auto& settings) { return settings.loop; }, result.settings))
    throw Error(ErrorKind::data,
                fmt::format("{}: is not of a walk against its own past, and has no loops; make one "
                            "with vpr-query --loop --query FOLDER",
                            name));
  if (result.query_frames != trajectory.poses.size())
    throw Error(ErrorKind::data,
                fmt::format("{}: is of {}, and {} has {}; give the poses of these frames", name,
                            counted(result.query_frames, "frame"), trajectory.name,
                            counted(trajectory.poses.size(), "pose")));
  LoopList list{name, loops_of(result), false, true};
  for (const ListedLoop& loop : list.loops)
    for (const size_t frame : {loop.query, loop.match})
      if (!trajectory.poses[frame])
        throw Error(ErrorKind::data, fmt::format("{}: has a loop of frame {}, of which {} has no "
                                                 "pose",
                                                 name, frame, trajectory.name));
  return list;
}

std::string loops_csv(const std::vector<ListedLoop>& loops) {
  std::string text = "query,match,score\n";
  for (const ListedLoop& loop : loops)
    text += fmt::format("{},{},{}\n", loop.query, loop.match, *loop.score);
  return text;
}

}  // namespace vpr
