#include "recordings/sequence.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numeric>
#include <utility>

#include <fmt/format.h>

#include "base/error.h"
#include "base/named_table.h"
#include "base/statistics.h"
#include "base/text.h"
#include "recordings/sequence_json.h"

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
  } while (std::ranges::adjacent_find(order, follows) != order.end());
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

constexpr std::array kRules = {
    SpeedRule{"0.5", "half the pace: every frame twice"},
    SpeedRule{"0.67", "two thirds of the pace: every other frame twice"},
    SpeedRule{"1.5", "one and a half times the pace: every third frame is omitted"},
    SpeedRule{"2", "twice the pace: every other frame is omitted"},
    SpeedRule{"varying", "a different pace of 0.5, 0.667, 1, 1.5 or 2 after every 20 to 60 frames",
              1, varying},
    SpeedRule{"stops", "a stop of 10 to 40 frames after every 20 to 60 frames", 1, stops},
    SpeedRule{"reversed", "the last frame first", 1, reversed},
    SpeedRule{"kidnap", "parts of 40 frames in random order; no part follows its predecessor",
              kKidnapStretch + 1, kidnap}};

const SpeedRule* find_rule(const std::string& speed) { return find_in(kRules, speed); }

// In thousandths.
uint64_t parse_pace(const std::string& speed) {
  const auto pace = parse_number<double>(speed);
  if (!pace) refuse_name("speed", speed, names_of(kRules));
  if (!(*pace >= kSlowestPace && *pace <= kFastestPace))
    throw Error(ErrorKind::usage, "the pace of a speed must be from {} to {}, found {}",
                kSlowestPace, kFastestPace, speed);
  return static_cast<uint64_t>(std::llround(*pace * kWhole));
}

// Nullopt for an empty text. Throws if the number, which has only digits, is too large.
std::optional<uint64_t> parse_frame_number(std::string_view text, const std::string& argument) {
  if (text.empty()) return std::nullopt;
  const auto value = parse_number<uint64_t>(text);
  if (!value || *value > (uint64_t{1} << 62))
    throw Error(ErrorKind::usage, "{}: a frame number is too large", argument);
  return value;
}

// Whether the rows are valid frames of the recording. Frames of a resampled sequence increase.
bool add_sources(Selection& selection, std::span<const int32_t> rows) {
  for (const int32_t row : rows) {
    const bool does_rise = !selection.speed.empty() || selection.is_all() ||
                           int64_t{row} > int64_t{selection.sources.back()};
    if (row < 0 || static_cast<size_t>(row) >= selection.recorded_frames || !does_rise)
      return false;
    selection.sources.push_back(static_cast<uint32_t>(row));
  }
  return true;
}

}  // namespace

std::string selection_text(const Selection& selection) {
  std::string text;
  if (selection.selected_fps > 0)
    text = fmt::format("resampled to {} {} per second", selection.selected_fps,
                       selection.selected_fps == 1 ? "frame" : "frames");
  if (selection.speed.empty()) return text;
  if (!text.empty()) text += ", ";
  if (parse_number<double>(selection.speed))
    return text + fmt::format("at speed {}", selection.speed);
  return text + fmt::format("at speed {}, seed {}", selection.speed, selection.seed);
}

std::vector<size_t> selected_frames(const Selection& selection, std::vector<size_t> frames) {
  if (selection.is_all()) return frames;
  std::vector<size_t> found;
  for (size_t k = 0; k < selection.frames(); ++k)
    if (std::ranges::binary_search(frames, selection.sources[k])) found.push_back(k);
  return found;
}

std::optional<FrameRange> parse_range(std::string_view text, const std::string& argument) {
  if (text.find_first_not_of("0123456789:") != std::string_view::npos) return std::nullopt;
  const auto parts = split(text, ':');
  if (parts.size() < 2 || parts.size() > 3) return std::nullopt;
  FrameRange range{parse_frame_number(parts[0], argument).value_or(0),
                   parse_frame_number(parts[1], argument)};
  if (parts.size() == 3) range.step = parse_frame_number(parts[2], argument).value_or(1);
  if (range.step == 0)
    throw Error(ErrorKind::usage, "{}: a step of 0 never ends. Use 1 or more", argument);
  if (range.last && *range.last <= range.first)
    throw Error(ErrorKind::usage, "{}: the range is empty; LAST is excluded and must exceed FIRST",
                argument);
  return range;
}

std::optional<uint64_t> frame_in_range(const FrameRange& range, uint64_t recorded) {
  if (recorded < range.first || (range.last && recorded >= *range.last)) return std::nullopt;
  const uint64_t offset = recorded - range.first;
  return offset % range.step == 0 ? std::optional(offset / range.step) : std::nullopt;
}

std::optional<uint64_t> frame_count(const FrameRange& range) {
  if (!range.last) return std::nullopt;
  return *range.last <= range.first ? 0 : (*range.last - range.first - 1) / range.step + 1;
}

std::string range_hint(const std::filesystem::path& path) {
  return fmt::format(
      ". If the sequence is a range of a recording, add the range to this file, as in {}@60:111",
      path.string());
}

std::string range_text(const FrameRange& range) {
  if (range.is_all()) return "";
  return fmt::format("@{}:{}{}", range.first, range.last ? std::to_string(*range.last) : "",
                     range.step == 1 ? "" : fmt::format(":{}", range.step));
}

std::span<const SpeedRule> speed_rules() { return kRules; }

std::string speed_summaries() {
  std::string text;
  for (const SpeedRule& rule : kRules) text += fmt::format("  {:<17}{}\n", rule.name, rule.summary);
  return text +
         fmt::format("  {:<17}any pace from {} to {}, in frames of the recording per frame\n",
                     "NUMBER", kSlowestPace, kFastestPace);
}

void check_speed(const std::string& speed) {
  if (find_rule(speed) == nullptr) parse_pace(speed);
}

Selection at_speed(const std::string& speed, size_t frames, uint64_t seed) {
  if (speed.empty()) return {};
  const SpeedRule* rule = find_rule(speed);
  if (rule == nullptr || rule->sources == nullptr)
    return {speed, seed, frames, at_pace(frames, parse_pace(speed))};
  if (frames < rule->least_frames)
    throw Error(ErrorKind::usage, "the speed {} needs a query of {} frames or more, found {}",
                speed, rule->least_frames, frames);
  RandomEngine engine = named_engine(seed, "warp " + speed);
  return {speed, seed, frames, rule->sources(frames, engine)};
}

void check_fps(double fps, std::string_view name) {
  if (!(fps > 0 && fps <= kMaxFps))
    throw Error(ErrorKind::usage, "{} must be above 0 and at most {}, found {}", name, kMaxFps,
                fps);
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

Selection resampled(std::span<const int64_t> times_ns, double fps) {
  Thinner thinner(fps);
  Selection kept;
  kept.recorded_frames = times_ns.size();
  kept.selected_fps = fps;
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

Sequence selected(Sequence sequence, const Selection& selection) {
  if (selection.is_all()) return sequence;
  sequence.frames = selection.frames();
  if (!sequence.frame_names.empty())
    sequence.frame_names = selected(std::move(sequence.frame_names), selection);
  sequence.unreadable = selected_frames(selection, std::move(sequence.unreadable));
  const Selection first = std::exchange(sequence.selection, selection);
  if (first.is_all()) return sequence;
  for (uint32_t& source : sequence.selection.sources) source = first.sources[source];
  sequence.selection.recorded_frames = first.recorded_frames;
  sequence.selection.selected_fps = first.selected_fps;
  return sequence;
}

void check_sequence(const Sequence& sequence, uint64_t most_frames, const JsonSource& source) {
  const auto require = [&](bool is_valid, std::string_view key) {
    if (!is_valid) source.fail(fmt::format("\"{}\" is out of range", key));
  };
  require(sequence.frames <= most_frames, "frames");
  const std::vector<size_t>& unreadable = sequence.unreadable;
  require(std::ranges::adjacent_find(unreadable, std::greater_equal<>()) == unreadable.end() &&
              (unreadable.empty() || unreadable.back() < sequence.frames),
          "unreadable");
  require(!sequence.fps || (*sequence.fps > 0 && std::isfinite(*sequence.fps)), "fps");
  const Selection& selection = sequence.selection;
  require(std::isfinite(selection.selected_fps), "resampled");
  const uint64_t thinning = selection.selected_fps > 0 ? kMaxThinned : 1;
  const uint64_t warping = selection.speed.empty() ? 1 : static_cast<uint64_t>(kFastestPace);
  require(selection.recorded_frames <= thinning * warping * sequence.frames, "speed");
}

std::vector<int32_t> source_rows(std::span<const Sequence* const> sequences) {
  std::vector<int32_t> rows;
  for (const Sequence* sequence : sequences)
    rows.insert(rows.end(), sequence->selection.sources.begin(), sequence->selection.sources.end());
  return rows;
}

void read_sources(std::span<Sequence* const> sequences,
                  const std::function<std::vector<int32_t>()>& open_rows,
                  const std::function<void()>& fail) {
  const auto needs = [](const Sequence* sequence) { return sequence->selection.is_selected(); };
  if (std::ranges::none_of(sequences, needs)) return;
  const std::vector<int32_t> all = open_rows();
  std::span<const int32_t> rows = all;
  for (Sequence* sequence : sequences) {
    if (!needs(sequence)) continue;
    if (sequence->frames > rows.size()) fail();
    if (!add_sources(sequence->selection, rows.first(sequence->frames))) fail();
    rows = rows.subspan(sequence->frames);
  }
  if (!rows.empty()) fail();
}

}  // namespace vpr
