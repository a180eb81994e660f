#include "loops/loops.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "base/error.h"
#include "base/rows.h"
#include "base/text.h"
#include "truth/times.h"

namespace vpr {

namespace {

bool is_by_time(Rows& rows, const Trajectory& trajectory, LoopFrames frames) {
  if (frames != LoopFrames::automatic) return frames == LoopFrames::time;
  bool is_time = false;
  bool are_beyond = rows.size() > 0 && !trajectory.times_ns.empty();
  while (rows.next())
    for (const std::string_view text : {rows.text("query"), rows.text("match")}) {
      const auto frame = parse_frame(text);
      const bool is_index = frame && frame->in_range && frame->value < trajectory.poses.size();
      // numpy.savetxt writes 7 as 7.000000000000000000e+00.
      const bool is_integer = is_index && text.find('e') < text.size();
      is_time =
          is_time || (parse_real(text) && text.find_first_of(".eE") < text.size() && !is_integer);
      if (is_index) are_beyond = false;
    }
  return is_time || are_beyond;
}

size_t frame_of_index(const Rows& rows, std::string_view column, size_t frames) {
  const size_t frame = rows.frame(column);
  if (frame >= frames)
    rows.fail("there is no frame {}; the trajectory has {} (0 to {})", frame, frames,
              frames == 0 ? 0 : frames - 1);
  return frame;
}

// The unit in which the first time of a list is nearest to a pose; on a tie, the unit by its size.
std::optional<TimeUnit> unit_in(Rows& rows, const Trajectory& trajectory) {
  std::optional<TimeUnit> best;
  if (!rows.next()) return best;
  const std::string_view text = rows.text("query");
  int64_t least = 0;
  for (const auto unit :
       {unit_of_time(text), std::optional(TimeUnit::nanoseconds),
        std::optional(TimeUnit::microseconds), std::optional(TimeUnit::milliseconds),
        std::optional(TimeUnit::seconds)}) {
    const auto time = unit ? parse_time(text, *unit) : std::nullopt;
    if (!time) continue;
    const int64_t difference =
        std::abs(trajectory.times_ns[nearest_time(trajectory.times_ns, *time)] - *time);
    if (best && difference >= least) continue;
    best = unit;
    least = difference;
  }
  while (rows.next()) {
  }
  return best;
}

size_t frame_of_time(const Rows& rows, std::string_view column, TimeReader& times,
                     const Trajectory& trajectory, int64_t max_difference_ns) {
  const int64_t time = times.read(rows.location(), rows.text(column));
  const size_t frame = nearest_time(trajectory.times_ns, time);
  const int64_t difference = std::abs(trajectory.times_ns[frame] - time);
  if (difference > max_difference_ns)
    rows.fail("the pose nearest to the time {} is {} s away, but --max-difference is {} s",
              rows.text(column), time_text(difference), time_text(max_difference_ns));
  return frame;
}

constexpr double kMaxGap = 1e9;

// The best loop of each query.
Curve curve_of_best(const LoopJudgment& judgment, ScoreOrder order) {
  std::map<size_t, ScoredItem> best;
  for (const JudgedLoop& judged : judgment.loops) {
    if (judged.label == PlaceLabel::ignore) continue;
    const ScoredItem item{score_key(*judged.loop.score, order), judged.label == PlaceLabel::same};
    const auto [found, is_new] = best.emplace(judged.loop.query, item);
    if (!is_new && item.key < found->second.key) found->second = item;
  }
  std::vector<ScoredItem> items;
  for (const auto& [query, item] : best) items.push_back(item);
  sort_items(items);
  return curve_of(items, judgment.frames_with_loop(), order);
}

constexpr size_t kFirstLine = 2;  // after the header

bool is_recognition(const Result& result, const Match& match) {
  const auto position = [](const Match& one) { return std::pair(one.query, one.train); };
  return std::ranges::binary_search(result.recognitions, position(match), {}, position);
}

bool is_decided(const Result& result) {
  const auto* settings = std::get_if<SequenceQuerySettings>(&result.settings);
  return settings != nullptr &&
         (decision_of(settings->rule) == Decision::margin || limit_of(settings->rule).has_value());
}

PlaceLabel label_between(const Trajectory& trajectory, size_t a, size_t b,
                         const Nearness& nearness) {
  const auto label = label_of(*trajectory.poses[a], *trajectory.poses[b], nearness);
  if (!label) refuse_angle(trajectory.name, has_heading(*trajectory.poses[a]) ? b : a);
  return *label;
}

}  // namespace

LoopList read_loop_list(const std::filesystem::path& path, const Trajectory& trajectory,
                        const LoopListRules& rules) {
  Rows rows(path, path.string(),
            {{"query", "match", "score"}, 2, /*needs_header=*/false, kListSeparators});
  LoopList list;
  list.has_scores = rows.size() > 0 && rows.has("score");
  const bool are_times = is_by_time(rows, trajectory, rules.frames);
  if (are_times && trajectory.times_ns.empty())
    throw Error(ErrorKind::usage,
                "{}: names frames by time stamps, but {} has none; pass them with --pose-times",
                path.string(), trajectory.name);
  if (are_times) require_rising_times(trajectory);
  TimeReader times(are_times ? unit_in(rows, trajectory) : std::nullopt);
  const auto frame = [&](std::string_view column) {
    return are_times ? frame_of_time(rows, column, times, trajectory, rules.max_difference_ns)
                     : frame_of_index(rows, column, trajectory.poses.size());
  };
  while (rows.next()) {
    ListedLoop loop{frame("query"), frame("match"), {}, rows.line()};
    if (list.has_scores) loop.score = rows.real("score");
    for (const size_t end : {loop.query, loop.match})
      if (!trajectory.poses[end]) rows.fail("{} has no pose for frame {}", trajectory.name, end);
    if (loop.match == loop.query) rows.fail("frame {} cannot close a loop with itself", loop.query);
    if (loop.match > loop.query)
      rows.fail("frame {} closes a loop with the later frame {}; list the later frame as query",
                loop.query, loop.match);
    list.loops.push_back(loop);
  }
  return list;
}

LoopGap parse_loop_gap(const std::string& text, const std::string& flag) {
  const bool is_time = text.ends_with('s');
  const auto value = parse_real(is_time ? text.substr(0, text.size() - 1) : text);
  const bool is_whole = value && *value == std::floor(*value);
  if (!value || !(*value > 0 && *value <= kMaxGap) || (!is_time && !is_whole))
    throw Error(ErrorKind::usage,
                "{} is the minimum separation of the two frames of a loop, in seconds or in "
                "frames, such as {} 30s or {} 300; found \"{}\"",
                flag, flag, flag, text);
  if (!is_time) return {{}, static_cast<size_t>(*value)};
  return {std::llround(*value * double{kSecond}), 0};
}

std::string gap_fault(const LoopGap& gap, std::span<const int64_t> times_ns, size_t frames) {
  size_t without_effect = 0;
  size_t without_past = 0;
  for (size_t frame = 1; frame < frames; ++frame) {
    without_effect += is_past(gap, times_ns, frame, frame - 1) ? 1 : 0;
    without_past += is_past(gap, times_ns, frame, 0) ? 0 : 1;
  }
  if (frames < 3) return "";
  if (2 * without_effect >= frames && gap.nanoseconds)
    return fmt::format(
        "excludes no frame, because they are {} s apart",
        time_text((times_ns[frames - 1] - times_ns[0]) / static_cast<int64_t>(frames - 1)));
  if (without_past + 1 >= frames - frames / 20)
    return gap.nanoseconds ? fmt::format("excludes nearly all frames, because they cover {} s",
                                         time_text(times_ns[frames - 1] - times_ns[0]))
                           : fmt::format("excludes nearly all of the {} frames", frames);
  return "";
}

std::optional<Revisit> LoopJudgment::longest_missed() const {
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

std::vector<bool> frames_with_loop(const Trajectory& trajectory, const LoopRules& rules) {
  // Frames are sorted into cubes, whose side is larger than the radius by more than rounding.
  using Cube = std::array<double, 3>;  // integers
  const double radius_m = rules.nearness.radius_m;
  const double side = radius_m > 0 ? radius_m * 1.000001 : 1;
  const auto cube_of = [&](size_t frame) {
    const auto& position = trajectory.poses[frame]->position;
    return Cube{std::floor(position[0] / side), std::floor(position[1] / side),
                std::floor(position[2] / side)};
  };
  std::map<Cube, std::vector<size_t>> cubes;
  const auto is_near = [&](size_t query, const Cube& cube) {
    const auto frames = cubes.find(cube);
    return frames != cubes.end() && std::ranges::any_of(frames->second, [&](size_t frame) {
             return label_between(trajectory, query, frame, rules.nearness) == PlaceLabel::same;
           });
  };
  std::vector<bool> has_loop(trajectory.poses.size());
  size_t past = 0;
  for (size_t query = 0; query < has_loop.size(); ++query) {
    for (; past < query && is_past(rules.gap, trajectory.times_ns, query, past); ++past)
      if (trajectory.poses[past]) cubes[cube_of(past)].push_back(past);
    if (!trajectory.poses[query]) continue;
    const Cube own = cube_of(query);
    for (int neighbor = 0; neighbor < 27 && !has_loop[query]; ++neighbor)
      has_loop[query] = is_near(query, {own[0] + neighbor % 3 - 1, own[1] + neighbor / 3 % 3 - 1,
                                        own[2] + neighbor / 9 - 1});
  }
  return has_loop;
}

LoopJudgment judge_loops(const LoopList& list, const Trajectory& trajectory,
                         const LoopRules& rules) {
  check_nearness(rules.nearness);
  if (rules.gap.nanoseconds && trajectory.times_ns.empty())
    throw Error(
        ErrorKind::usage,
        "{}: a gap in seconds needs the times of all frames. Add them with --pose-times, or set "
        "the gap in frames, as in --gap 300",
        trajectory.name);
  if (rules.gap.nanoseconds) require_rising_times(trajectory);
  LoopJudgment judgment;
  judgment.has_loop = frames_with_loop(trajectory, rules);
  judgment.is_found.resize(judgment.has_loop.size());
  std::map<std::pair<size_t, size_t>, size_t> seen;  // the judged loop of a pair
  for (const ListedLoop& loop : list.loops) {
    const auto [found, is_new] = seen.try_emplace({loop.query, loop.match}, judgment.loops.size());
    if (!is_new) {
      ++judgment.repeated;
      ListedLoop& known = judgment.loops[found->second].loop;
      if (loop.score && score_key(*loop.score, rules.order) < score_key(*known.score, rules.order))
        known = loop;
      continue;
    }
    JudgedLoop judged{loop, std::sqrt(square_distance(*trajectory.poses[loop.query],
                                                      *trajectory.poses[loop.match]))};
    judged.is_too_near = !is_past(rules.gap, trajectory.times_ns, loop.query, loop.match);
    judged.label = judged.is_too_near
                       ? PlaceLabel::ignore
                       : label_between(trajectory, loop.query, loop.match, rules.nearness);
    if (judged.label == PlaceLabel::same) judgment.is_found[loop.query] = true;
    judgment.loops.push_back(judged);
  }
  for (size_t frame = 0; frame < judgment.has_loop.size(); ++frame) {
    if (!judgment.has_loop[frame]) continue;
    auto& revisits = judgment.revisits;
    if (revisits.empty() || revisits.back().last + 1 != frame) revisits.push_back({frame, frame});
    revisits.back().last = frame;
    if (judgment.is_found[frame]) revisits.back().is_found = true;
  }
  if (list.has_scores) judgment.curve = curve_of_best(judgment, rules.order);
  return judgment;
}

std::vector<ListedLoop> loops_of(const Result& result) {
  std::vector<ListedLoop> loops;
  const size_t length = result.window_length();
  const ScoreKind& kind = result.score();
  const size_t first = first_own_place(result);
  for (const auto& best : result.best) {
    if (!best || best->train < first) continue;
    if (is_decided(result) && !is_recognition(result, *best)) continue;
    const double score =
        kind.frame_value == nullptr ? best->score : kind.frame_value(best->score, length);
    loops.push_back({anchor_of(best->query, length), anchor_of(best->train - first, length), score,
                     loops.size() + kFirstLine});
  }
  return loops;
}

LoopList loop_list_of(const Result& result, const std::string& name, const Trajectory& trajectory) {
  if (!is_loop(result.settings))
    throw Error(ErrorKind::data,
                "{}: the result has no loops. Create one with vpr-query loops --query FOLDER",
                name);
  if (result.query.frames != trajectory.poses.size())
    throw Error(ErrorKind::data, "{}: the query has {}, but {} has {}", name,
                counted(result.query.frames, "frame"), trajectory.name,
                counted(trajectory.poses.size(), "pose"));
  LoopList list{loops_of(result), true};
  for (const ListedLoop& loop : list.loops)
    for (const size_t frame : {loop.query, loop.match})
      if (!trajectory.poses[frame])
        throw Error(ErrorKind::data, "{}: there is a loop at frame {}, but {} has no pose for it",
                    name, frame, trajectory.name);
  return list;
}

std::string loops_csv(const std::vector<ListedLoop>& loops) {
  std::string text = "query,match,score\n";
  for (const ListedLoop& loop : loops)
    text += fmt::format("{},{},{}\n", loop.query, loop.match, *loop.score);
  return text;
}

}  // namespace vpr
