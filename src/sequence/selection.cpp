#include "sequence/selection.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "base/error.h"
#include "base/named_table.h"
#include "base/statistics.h"
#include "base/text.h"

namespace vpr {

namespace {

using Sources = std::vector<uint32_t>;

/// A number of frames, drawn evenly from `least` to `most`.
struct Stretch {
  uint64_t least = 0;
  uint64_t most = 0;
};

constexpr Stretch kPaceStretch = {20, 60};  // that `varying` keeps a pace for
constexpr Stretch kWalkStretch = {20, 60};  // that `stops` walks between two stops,
constexpr Stretch kStopStretch = {10, 40};  // and stands at one
constexpr size_t kKidnapStretch = 40;       // after which `kidnap` goes on elsewhere

constexpr uint64_t kWhole = 1000;  // paces and positions are counted in thousandths of a frame

Sources at_pace(size_t frames, uint64_t pace) {
  Sources sources;
  for (uint64_t at = 0; at < frames * kWhole; at += pace)
    sources.push_back(static_cast<uint32_t>(at / kWhole));
  return sources;
}

template <uint64_t pace>
Sources at_fixed_pace(size_t frames, RandomEngine&) {
  return at_pace(frames, pace);
}

uint64_t drawn(const Stretch& stretch, RandomEngine& engine) {
  return stretch.least + uniform_below(engine, stretch.most - stretch.least + 1);
}

Sources varying(size_t frames, RandomEngine& engine) {
  constexpr std::array<uint64_t, 5> kPaces = {500, 667, 1000, 1500, 2000};
  Sources sources;
  size_t chosen = uniform_below(engine, kPaces.size());
  for (uint64_t at = 0; at < frames * kWhole;) {
    for (uint64_t left = drawn(kPaceStretch, engine); left > 0 && at < frames * kWhole; --left) {
      sources.push_back(static_cast<uint32_t>(at / kWhole));
      at += kPaces[chosen];
    }
    chosen = (chosen + 1 + uniform_below(engine, kPaces.size() - 1)) % kPaces.size();  // another
  }
  return sources;
}

Sources stops(size_t frames, RandomEngine& engine) {
  Sources sources;
  for (size_t at = 0; at < frames;) {
    const size_t end = std::min<size_t>(frames, at + drawn(kWalkStretch, engine));
    for (; at < end; ++at) sources.push_back(static_cast<uint32_t>(at));
    if (at < frames) sources.insert(sources.end(), drawn(kStopStretch, engine), sources.back());
  }
  return sources;
}

Sources reversed(size_t frames, RandomEngine&) {
  Sources sources(frames);
  std::iota(sources.rbegin(), sources.rend(), 0);
  return sources;
}

// Drawn anew until no stretch follows the one that it follows in the recording; about one order in
// three is such.
std::vector<size_t> stretch_order(size_t stretches, RandomEngine& engine) {
  std::vector<size_t> order(stretches);
  std::iota(order.begin(), order.end(), 0);
  const auto follows = [](size_t a, size_t b) { return b == a + 1; };
  do {
    for (size_t i = stretches; i > 1; --i) std::swap(order[i - 1], order[uniform_below(engine, i)]);
  } while (std::adjacent_find(order.begin(), order.end(), follows) != order.end());
  return order;
}

Sources kidnap(size_t frames, RandomEngine& engine) {
  Sources sources;
  for (const size_t stretch :
       stretch_order((frames + kKidnapStretch - 1) / kKidnapStretch, engine)) {
    const size_t end = std::min(frames, (stretch + 1) * kKidnapStretch);
    for (size_t at = stretch * kKidnapStretch; at < end; ++at)
      sources.push_back(static_cast<uint32_t>(at));
  }
  return sources;
}

constexpr WarpRule at(std::string_view name, std::string_view summary, double pace,
                      Sources (*sources)(size_t, RandomEngine&)) {
  return {name, summary, true, 1 / pace, 1 / pace, 1, sources};
}

constexpr std::array kRules = {
    at("0.5", "half the pace: every frame twice", 0.5, at_fixed_pace<500>),
    at("0.67", "two thirds of it: every other frame twice", 0.67, at_fixed_pace<670>),
    at("1.5", "one and a half: every third frame is left out", 1.5, at_fixed_pace<1500>),
    at("2", "twice the pace: every other frame is left out", 2, at_fixed_pace<2000>),
    WarpRule{"varying", "another of the paces 0.5, 0.667, 1, 1.5, 2 after every 20 to 60 frames",
             true, 0.5, 2, 1, varying},
    WarpRule{"stops", "stands for 10 to 40 frames after every 20 to 60 that are walked", true, 1, 3,
             1, stops},
    WarpRule{"reversed", "the last frame first", false, 1, 1, 1, reversed},
    WarpRule{"kidnap", "cut after every 40 frames, and never gone on where it was cut", false, 1, 1,
             kKidnapStretch + 1, kidnap}};

std::optional<double> number(const std::string& text) {
  double value = 0;
  const char* end = text.data() + text.size();
  const auto read = std::from_chars(text.data(), end, value);
  if (read.ec != std::errc() || read.ptr != end) return std::nullopt;
  return value;
}

const WarpRule* find_rule(const std::string& warp) {
  const auto found = std::ranges::find(kRules, std::string_view(warp), &WarpRule::name);
  return found == kRules.end() ? nullptr : &*found;
}

// In thousandths.
uint64_t parse_pace(const std::string& warp) {
  const std::optional<double> pace = number(warp);
  if (!pace) refuse_name("warp", warp, names_of(kRules));
  if (!(*pace >= kSlowestPace && *pace <= kFastestPace))
    throw Error(ErrorKind::usage, fmt::format("the pace of a warp must be from {} to {}, found {}",
                                              kSlowestPace, kFastestPace, warp));
  return static_cast<uint64_t>(std::llround(*pace * kWhole));
}

}  // namespace

std::span<const WarpRule> warp_rules() { return kRules; }

std::string warp_summaries() {
  std::string text;
  for (const WarpRule& rule : kRules) text += fmt::format("  {:<17}{}\n", rule.name, rule.summary);
  return text + fmt::format("  {:<17}any pace from {} to {}, in frames a frame\n", "NUMBER",
                            kSlowestPace, kFastestPace);
}

void check_warp(const std::string& warp) {
  if (find_rule(warp) == nullptr) parse_pace(warp);
}

Replay replay(const std::string& warp, size_t frames, uint64_t seed) {
  const WarpRule* rule = find_rule(warp);
  if (rule == nullptr) return {warp, seed, frames, at_pace(frames, parse_pace(warp))};
  if (frames < rule->least_frames)
    throw Error(ErrorKind::usage,
                fmt::format("the warp {} needs a query of {} frames or more, found {}", warp,
                            rule->least_frames, frames));
  RandomEngine engine = named_engine(seed, "warp " + warp);
  return {warp, seed, frames, rule->sources(frames, engine)};
}

std::string replay_text(const Replay& replay) {
  std::string text;
  if (replay.fps > 0) text = fmt::format("thinned to {} frames a second", replay.fps);
  if (replay.warp.empty()) return text;
  if (!text.empty()) text += ", ";
  if (number(replay.warp)) return text + fmt::format("replayed at pace {}", replay.warp);
  return text + fmt::format("replayed by {}, seed {}", replay.warp, replay.seed);
}

std::vector<size_t> replayed_frames(const Replay& replay, std::span<const size_t> frames) {
  std::vector<size_t> found;
  for (size_t k = 0; k < replay.frames(); ++k)
    if (std::binary_search(frames.begin(), frames.end(), replay.sources[k])) found.push_back(k);
  return found;
}

void check_fps(double fps, std::string_view name) {
  if (!(fps > 0 && fps <= kMostFps))
    throw Error(ErrorKind::usage,
                fmt::format("{} must be above 0 and at most {}, found {}", name, kMostFps, fps));
}

Thinner::Thinner(double fps) : interval_ns_(1e9 / fps) {}

bool Thinner::keeps_before(int64_t time_ns) {
  if (!first_) {
    first_ = last_ = time_ns;
    return false;
  }
  // The tick is the earlier frame's up to half way between both.
  const double middle =
      (static_cast<double>(last_ - *first_) + static_cast<double>(time_ns - *first_)) / 2;
  last_ = time_ns;
  if (tick() > middle) return false;
  tick_ = static_cast<uint64_t>(middle / interval_ns_);
  while (tick() <= middle) ++tick_;
  return true;
}

bool Thinner::keeps_last() const {
  return first_ && tick() <= static_cast<double>(last_ - *first_) + interval_ns_ / 10;
}

Replay thinned(std::span<const int64_t> times_ns, double fps) {
  Thinner thinner(fps);
  Replay kept;
  kept.recorded_frames = times_ns.size();
  kept.fps = fps;
  for (size_t i = 0; i < times_ns.size(); ++i)
    if (thinner.keeps_before(times_ns[i])) kept.sources.push_back(static_cast<uint32_t>(i - 1));
  if (thinner.keeps_last()) kept.sources.push_back(static_cast<uint32_t>(times_ns.size() - 1));
  return kept;
}

std::optional<Replay> kept_frames(std::span<const int32_t> sources, uint64_t recorded_frames,
                                  double fps) {
  if (sources.empty() || recorded_frames > kMostThinned * sources.size()) return std::nullopt;
  Replay kept;
  kept.recorded_frames = recorded_frames;
  kept.fps = fps;
  for (const int32_t source : sources) {
    const bool is_behind = kept.sources.empty() || int64_t{source} > kept.sources.back();
    if (source < 0 || !is_behind || static_cast<uint64_t>(source) >= recorded_frames)
      return std::nullopt;
    kept.sources.push_back(static_cast<uint32_t>(source));
  }
  return kept;
}

std::optional<double> median_fps(std::span<const int64_t> times_ns) {
  if (times_ns.size() < 2) return std::nullopt;
  std::vector<double> steps;
  for (size_t i = 1; i < times_ns.size(); ++i)
    steps.push_back(static_cast<double>(times_ns[i] - times_ns[i - 1]));
  return 1e9 / median(std::move(steps));
}

Replay replay_of_kept(const Replay& kept, Replay replay) {
  for (uint32_t& source : replay.sources) source = kept.sources[source];
  replay.recorded_frames = kept.recorded_frames;
  replay.fps = kept.fps;
  return replay;
}

}  // namespace vpr
