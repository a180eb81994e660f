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

/// A number of frames, uniformly drawn from `least` to `most`.
struct Stretch {
  uint64_t least = 0;
  uint64_t most = 0;
};

constexpr Stretch kPaceStretch = {20, 60};  // frames per speed of `varying`
constexpr Stretch kWalkStretch = {20, 60};  // moving frames between two stops of `stops`
constexpr Stretch kStopStretch = {10, 40};  // frames of a stop
constexpr size_t kKidnapStretch = 40;       // frames per part of `kidnap`

constexpr uint64_t kWhole = 1000;  // speeds and positions are in thousandths of a frame

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
    // a different one
    chosen = (chosen + 1 + uniform_below(engine, kPaces.size() - 1)) % kPaces.size();
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

// Draws until no part follows its predecessor in the recording, which holds for about one order in
// three.
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

// Removes the leading number from `text`; nullopt if there is no digit. Throws if it is too large.
std::optional<uint64_t> take_number(std::string_view& text, const std::string& argument) {
  uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error == std::errc::invalid_argument) return std::nullopt;
  if (error == std::errc::result_out_of_range || value > (uint64_t{1} << 62))
    throw Error(ErrorKind::usage, fmt::format("{}: a frame number is too large", argument));
  text.remove_prefix(static_cast<size_t>(end - text.data()));
  return value;
}

bool take_colon(std::string_view& text) {
  if (!text.starts_with(':')) return false;
  text.remove_prefix(1);
  return true;
}

}  // namespace

std::string selection_text(const Selection& selection) {
  std::string text;
  if (selection.thinned_fps > 0)
    text = fmt::format("thinned to {} frames a second", selection.thinned_fps);
  if (selection.warp.empty()) return text;
  if (!text.empty()) text += ", ";
  if (number(selection.warp)) return text + fmt::format("replayed at pace {}", selection.warp);
  return text + fmt::format("replayed by {}, seed {}", selection.warp, selection.seed);
}

std::vector<size_t> selected_frames(const Selection& selection, std::vector<size_t> frames) {
  if (selection.is_all()) return frames;
  std::vector<size_t> found;
  for (size_t k = 0; k < selection.frames(); ++k)
    if (std::ranges::binary_search(frames, selection.sources[k])) found.push_back(k);
  return found;
}

Selection composed(const Selection& first, Selection second) {
  if (first.is_all()) return second;
  if (second.is_all()) return first;
  for (uint32_t& source : second.sources) source = first.sources[source];
  second.recorded_frames = first.recorded_frames;
  second.thinned_fps = first.thinned_fps;
  return second;
}

std::optional<FrameRange> parse_range(std::string_view text, const std::string& argument) {
  if (text.find_first_not_of("0123456789:") != std::string_view::npos) return std::nullopt;
  FrameRange range;
  range.first = take_number(text, argument).value_or(0);
  if (!take_colon(text)) return std::nullopt;
  range.last = take_number(text, argument);
  if (take_colon(text)) range.step = take_number(text, argument).value_or(1);
  if (!text.empty()) return std::nullopt;
  if (range.step == 0)
    throw Error(ErrorKind::usage,
                fmt::format("{}: a step of 0 never ends; give 1 or more", argument));
  if (range.last && *range.last <= range.first)
    throw Error(
        ErrorKind::usage,
        fmt::format("{}: the range is empty; LAST is excluded and must exceed FIRST", argument));
  return range;
}

std::optional<uint64_t> frame_in_range(const FrameRange& range, uint64_t recorded) {
  if (recorded < range.first || (range.last && recorded >= *range.last)) return std::nullopt;
  const uint64_t behind = recorded - range.first;
  return behind % range.step == 0 ? std::optional(behind / range.step) : std::nullopt;
}

std::optional<uint64_t> frame_count(const FrameRange& range) {
  if (!range.last) return std::nullopt;
  return *range.last <= range.first ? 0 : (*range.last - range.first - 1) / range.step + 1;
}

std::string range_hint(const std::filesystem::path& path) {
  return fmt::format(
      "; where the sequence is a range of a recording, give this file the same "
      "range, as in {}@60:111",
      path.string());
}

std::string range_text(const FrameRange& range) {
  if (range.is_all()) return "";
  return fmt::format("@{}:{}{}", range.first == 0 ? "" : std::to_string(range.first),
                     range.last ? std::to_string(*range.last) : "",
                     range.step == 1 ? "" : fmt::format(":{}", range.step));
}

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

Selection warped(const std::string& warp, size_t frames, uint64_t seed) {
  if (warp.empty()) return {};
  const WarpRule* rule = find_rule(warp);
  if (rule == nullptr) return {warp, seed, frames, at_pace(frames, parse_pace(warp))};
  if (frames < rule->least_frames)
    throw Error(ErrorKind::usage,
                fmt::format("the warp {} needs a query of {} frames or more, found {}", warp,
                            rule->least_frames, frames));
  RandomEngine engine = named_engine(seed, "warp " + warp);
  return {warp, seed, frames, rule->sources(frames, engine)};
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
  // The midpoint between both frames; ticks up to it belong to the earlier one.
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

Selection thinned(std::span<const int64_t> times_ns, double fps) {
  Thinner thinner(fps);
  Selection kept;
  kept.recorded_frames = times_ns.size();
  kept.thinned_fps = fps;
  for (size_t i = 0; i < times_ns.size(); ++i)
    if (thinner.keeps_before(times_ns[i])) kept.sources.push_back(static_cast<uint32_t>(i - 1));
  if (thinner.keeps_last()) kept.sources.push_back(static_cast<uint32_t>(times_ns.size() - 1));
  return kept;
}

std::optional<double> median_fps(std::span<const int64_t> times_ns) {
  if (times_ns.size() < 2) return std::nullopt;
  std::vector<double> steps;
  for (size_t i = 1; i < times_ns.size(); ++i)
    steps.push_back(static_cast<double>(times_ns[i] - times_ns[i - 1]));
  return 1e9 / median(std::move(steps));
}

}  // namespace vpr
