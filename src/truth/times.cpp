#include "truth/times.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <regex>
#include <utility>

#include <fmt/format.h>

#include "base/error.h"
#include "base/mapped_file.h"
#include "base/npy.h"
#include "base/text.h"
#include "recordings/frames.h"
#include "recordings/live_source.h"

namespace vpr {
namespace {

// 1896 and 2116 in nanoseconds since 1970: differences of two times and an offset fit 64 bits.
constexpr int64_t kMinTime = -(int64_t{1} << 61);
constexpr int64_t kMaxTime = int64_t{1} << 62;
/// Longer dates, which have many digits below nanoseconds, are refused.
constexpr size_t kMaxDate = 64;
constexpr int64_t kYear = 31'536'000 * kSecond;
constexpr size_t kDigitsOfClock = 10;  // seconds since 1970

/// Plausible steps between frames or poses, in nanoseconds; and those of clocks from 1970.
constexpr double kLeastStep = 2e6;
constexpr double kGreatestStep = 1e10;
constexpr double kLeastDateStep = 1e5;
constexpr double kGreatestDateStep = 3.6e12;
/// 2001 to 2039, in nanoseconds since 1970.
constexpr double kFirstDate = 1e18;
constexpr double kLastDate = 2.2e18;
constexpr std::array<std::pair<TimeUnit, std::string_view>, 4> kTimeUnits = {
    {{TimeUnit::seconds, "s"},
     {TimeUnit::milliseconds, "ms"},
     {TimeUnit::microseconds, "us"},
     {TimeUnit::nanoseconds, "ns"}}};

// Digits as an integer; 0 if empty. Nullopt if there are too many.
std::optional<int64_t> parse_digits(std::string_view digits) {
  return digits.empty() ? 0 : parse_number<int64_t>(digits);
}

// The times that are the names of a sequence's images.
std::vector<int64_t> times_of_names(const SequenceSource& sequence) {
  std::vector<std::string> names;
  for (const std::filesystem::path& file : sequence.files) names.push_back(file.stem().string());
  if (!names.empty() && !unit_of_time(names.front()))
    FileLocation{sequence.files.front().string()}.fail(
        "its name \"{}\" is not a time. scripts/convert/exif.py lists the times at "
        "which JPEG images were taken",
        names.front());
  TimeReader reader(unit_of_times({sequence.argument.path.string()},
                                  std::vector<std::string_view>(names.begin(), names.end())));
  std::vector<int64_t> times;
  for (size_t i = 0; i < names.size(); ++i)
    times.push_back(reader.read_next({sequence.files[i].string()}, names[i]));
  return times;
}

int64_t even_time(size_t frame, double fps) {
  return std::llround(static_cast<double>(frame) * 1e9 / fps);
}

// The time of the current row. Blanks between cells also split a date, its time of day and its
// zone.
std::string_view time_cell(const Rows& rows) {
  const std::string_view text = rows.text("time");
  const auto cells = rows.cells();
  const auto found = std::ranges::find(cells, text.data(), &std::string_view::data);
  for (ptrdiff_t more = std::min<ptrdiff_t>(2, cells.end() - found - 1); more > 0; --more) {
    const std::string_view last = found[more];
    const std::string_view date(text.data(),
                                static_cast<size_t>(last.data() + last.size() - text.data()));
    if (parse_calendar_time(date)) return date;
  }
  return text;
}

/// A line of a list of times.
struct ListedTime {
  int64_t time = 0;
  size_t line = 0;
  std::string image = {};  // empty: not named
};

// The times of frames by the names of their images; nullopt if no line names one of them.
std::optional<std::vector<int64_t>> times_by_name(const std::vector<ListedTime>& listed,
                                                  const std::vector<std::string>& names,
                                                  const std::string& file) {
  const FrameNames frames(names);
  std::vector<const ListedTime*> found(names.size());
  for (const ListedTime& one : listed)
    if (const auto frame = one.image.empty() ? std::nullopt : frames.find(one.image))
      found[*frame] = &one;
  if (std::ranges::all_of(found, [](const auto* one) { return one == nullptr; }))
    return std::nullopt;
  std::vector<int64_t> times;
  FileLocation location{file};
  for (size_t frame = 0; frame < names.size(); ++frame) {
    if (found[frame] == nullptr) location.fail("has no time of {}", names[frame]);
    location.at("line", found[frame]->line);
    if (frame > 0 && found[frame]->time <= times.back())
      location.fail(
          "{} is not later than {}, which is before it in the sequence. Pass a list of the images "
          "in the order of their times",
          names[frame], names[frame - 1]);
    times.push_back(found[frame]->time);
    location = {file};
  }
  return times;
}

std::vector<int64_t> times_in_order(const std::vector<ListedTime>& listed,
                                    const std::string& file) {
  std::vector<int64_t> times;
  for (const ListedTime& one : listed) {
    if (!times.empty() && one.time <= times.back())
      refuse_time_order({file, "line", one.line}, times.back(), one.time);
    times.push_back(one.time);
  }
  return times;
}

std::string text_of(const SequenceArgument& argument) {
  return argument.path.string() + range_text(argument.range);
}

// For sequences other than videos.
size_t count_frames(const SequenceSource& sequence) {
  if (!sequence.is_one_array()) return sequence.files.size();
  SequenceArgument argument = sequence.argument;
  const auto array =
      argument.array ? argument.array : std::make_shared<const NpyArray>(argument.path);
  argument.range.last = argument.range.last.value_or(array->shape().at(0));
  return frame_count(argument.range).value_or(0);
}

// Whether a video or the names of frames have times.
bool states_times(const SequenceSource& sequence) {
  return sequence.kind == SequenceKind::video ||
         (!sequence.is_one_array() && is_named_by_time(sequence.files.front()));
}

// The times of the frames of a sequence, or nullopt if unknown.
std::optional<std::vector<int64_t>> find_times(const SequenceSource& sequence,
                                               const std::filesystem::path& file,
                                               std::optional<double> recorded_fps,
                                               const Monitor& monitor) {
  if (!file.empty()) return read_frame_times(file, file_names(sequence), monitor);
  const SequenceArgument& argument = sequence.argument;
  if (sequence.kind == SequenceKind::video) return read_video_times(argument, monitor);
  if (states_times(sequence)) return times_of_names(sequence);
  if (!recorded_fps) return std::nullopt;
  std::vector<int64_t> times;
  for (size_t i = 0; i < count_frames(sequence); ++i)
    times.push_back(even_time(i, *recorded_fps / static_cast<double>(argument.range.step)));
  return times;
}

// For a video, the rate that it states: its frames are not read.
std::optional<double> stated_rate(const SequenceSource& sequence, const std::filesystem::path& file,
                                  std::optional<double> recorded_fps, const Monitor& monitor) {
  const SequenceArgument& argument = sequence.argument;
  if (file.empty() && sequence.kind == SequenceKind::video) {
    const double fps = VideoReader(argument, {}, Unreadable::fail).frames_per_second();
    if (!(fps > 0 && fps <= kMaxFps)) return std::nullopt;
    return fps / static_cast<double>(argument.range.step);
  }
  try {
    const auto times = find_times(sequence, file, recorded_fps, monitor);
    return times ? median_fps(*times) : std::nullopt;
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::data) throw;
    return std::nullopt;  // the names are not times
  }
}

}  // namespace

std::optional<TimeUnit> unit_of_time(std::string_view text) {
  const auto value = parse_real(text);
  if (!value) return std::nullopt;
  const double size = std::abs(*value);
  return size < 1e11   ? TimeUnit::seconds
         : size < 1e14 ? TimeUnit::milliseconds
         : size < 1e17 ? TimeUnit::microseconds
                       : TimeUnit::nanoseconds;
}

std::optional<TimeUnit> unit_of_times(const FileLocation& file,
                                      std::span<const std::string_view> texts) {
  const auto first = texts.empty() ? std::nullopt : parse_real(texts.front());
  if (!first) return std::nullopt;
  std::vector<double> steps;
  double last = *first;
  bool has_points = false;
  for (const std::string_view text : texts) {
    const double value = parse_real(text).value_or(last);
    if (value != last) steps.push_back(std::abs(value - last));
    last = value;
    has_points = has_points || text.find('.') < text.size();
  }
  if (steps.empty()) return unit_of_time(texts.front());
  const auto middle = steps.begin() + static_cast<ptrdiff_t>((steps.size() - 1) / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  const auto is_between = [](double value, TimeUnit unit, double least, double greatest) {
    const double ns = value * static_cast<double>(unit);
    return ns >= least * (1 - 1e-9) && ns <= greatest * (1 + 1e-9);
  };
  std::vector<std::pair<TimeUnit, std::string_view>> plausible;
  for (const auto& [unit, symbol] : kTimeUnits) {
    // A phone that has been on for weeks counts as many nanoseconds as dates have microseconds.
    const double greatest = unit == TimeUnit::microseconds ? kGreatestStep : kGreatestDateStep;
    const bool is_date = is_between(*first, unit, kFirstDate, kLastDate) &&
                         is_between(*middle, unit, kLeastDateStep, kGreatestDateStep);
    if (is_date && is_between(*middle, unit, 0, greatest)) return unit;
    if (is_date || is_between(*middle, unit, kLeastStep, kGreatestStep))
      plausible.emplace_back(unit, symbol);
  }
  if (plausible.empty()) return unit_of_time(texts.front());
  if (has_points && plausible.front().first == TimeUnit::seconds) return TimeUnit::seconds;
  // A recording of less than a second has a larger unit.
  const double duration = std::abs(last - *first);
  while (plausible.size() > 1 &&
         duration * static_cast<double>(plausible.back().first) < double{kSecond})
    plausible.pop_back();
  if (plausible.size() > 1)
    file.fail(
        "the unit of its times is unclear: they are {} {} or {} {} apart. Add a first line with "
        "the names of the columns, such as time_{} or time_{}, or write seconds with a point",
        *middle, plausible[0].second, *middle, plausible[1].second, plausible[0].second,
        plausible[1].second);
  return plausible.front().first;
}

std::optional<TimeUnit> unit_of_times(Rows& rows, std::string_view column) {
  if (const auto unit = rows.time_unit(column)) return unit;
  if (!rows.has(column)) return std::nullopt;
  const FileLocation file{rows.location().file};
  std::vector<std::string_view> texts;
  while (rows.next()) texts.push_back(rows.text(column));
  return unit_of_times(file, texts);
}

std::optional<int64_t> parse_time(std::string_view text, TimeUnit unit) {
  const auto value = parse_real(text);
  if (!value) return std::nullopt;
  const int64_t scale = static_cast<int64_t>(unit);
  if (text.find_first_of("eE") != std::string_view::npos) {
    const double rounded = *value * static_cast<double>(scale);
    if (!(rounded >= static_cast<double>(kMinTime) && rounded <= static_cast<double>(kMaxTime)))
      return std::nullopt;
    return std::llround(rounded);
  }
  const bool is_negative = text.starts_with('-');
  if (is_negative || text.starts_with('+')) text.remove_prefix(1);
  const size_t point = std::min(text.find('.'), text.size());
  const auto whole = parse_digits(text.substr(0, point));
  if (!whole || *whole > kMaxTime / scale) return std::nullopt;
  int64_t nanoseconds = *whole * scale;
  int64_t digit = scale;
  for (size_t i = point + 1; i < text.size() && digit > 1; ++i) {
    digit /= 10;
    nanoseconds += (text[i] - '0') * digit;
  }
  if (is_negative) nanoseconds = -nanoseconds;
  return nanoseconds >= kMinTime ? std::optional(nanoseconds) : std::nullopt;
}

std::string time_text(int64_t nanoseconds) {
  const bool is_negative = nanoseconds < 0;
  const uint64_t size = is_negative ? uint64_t{0} - static_cast<uint64_t>(nanoseconds)
                                    : static_cast<uint64_t>(nanoseconds);
  std::string text =
      fmt::format("{}{}.{:09}", is_negative ? "-" : "", size / kSecond, size % kSecond);
  while (text.back() == '0') text.pop_back();
  if (text.back() == '.') text.pop_back();
  return text;
}

size_t nearest_time(std::span<const int64_t> times, int64_t time) {
  const auto after = std::lower_bound(times.begin(), times.end(), time);
  const auto index = static_cast<size_t>(after - times.begin());
  if (index == times.size()) return index - 1;
  if (index == 0) return 0;
  return time - times[index - 1] <= times[index] - time ? index - 1 : index;
}

std::optional<int64_t> parse_calendar_time(std::string_view text) {
  static const std::regex kDate(
      R"((\d{4})([-/:]?)(\d\d)\2(\d\d)[Tt ](\d\d)(:?)(\d\d)\6(\d\d)(?:[.,](\d+))?)"
      R"(( ?(?:[Zz]|UTC|GMT)| ?([+-]\d\d)(?::?(\d\d))?(?: UTC)?)?)");
  std::cmatch parts;
  if (text.size() > kMaxDate ||
      !std::regex_match(text.data(), text.data() + text.size(), parts, kDate))
    return std::nullopt;
  const auto number = [&](size_t part) { return std::atoi(parts.str(part).c_str()); };
  const int zone_hours = std::abs(number(11));
  const std::chrono::seconds zone =
      std::chrono::hours(zone_hours) + std::chrono::minutes(number(12));
  const std::chrono::year_month_day date{std::chrono::year(number(1)),
                                         std::chrono::month(static_cast<unsigned>(number(3))),
                                         std::chrono::day(static_cast<unsigned>(number(4)))};
  if (number(1) < 1900 || number(1) > 2200 || !date.ok() || number(5) > 23 || number(7) > 59 ||
      number(8) > 60 || zone_hours > 15 || number(12) > 59)
    return std::nullopt;
  const std::chrono::sys_seconds local =
      std::chrono::sys_days(date) + std::chrono::hours(number(5)) +
      std::chrono::minutes(number(7)) + std::chrono::seconds(number(8));
  const std::chrono::sys_seconds utc = parts.str(11).starts_with('-') ? local + zone : local - zone;
  std::string fraction = parts.str(9);
  fraction.resize(9, '0');
  return utc.time_since_epoch().count() * kSecond + *parse_digits(fraction);
}

void refuse_time_order(const FileLocation& location, int64_t before, int64_t time) {
  location.fail("its time {} {}; times must increase", time_text(time),
                time == before ? "equals the time of the previous frame"
                               : fmt::format("is before the time of the previous frame, {}",
                                             time_text(before)));
}

int64_t TimeReader::read(const FileLocation& location, std::string_view text) {
  if (!unit_) unit_ = unit_of_time(text);
  auto time = unit_ ? parse_time(text, *unit_) : std::nullopt;
  if (!time) time = parse_calendar_time(text);
  if (!time)
    location.fail(
        "\"{}\" is not a valid time{}. Use numbers, or dates such as 2020-03-23T12:00:10Z", text,
        decimal_comma_hint(text));
  return *time;
}

int64_t TimeReader::read_next(const FileLocation& location, std::string_view text) {
  const int64_t time = read(location, text);
  if (last_ && time <= *last_) refuse_time_order(location, *last_, time);
  return *(last_ = time);
}

std::vector<int64_t> read_time_list(const std::filesystem::path& path,
                                    const std::vector<std::string>& names) {
  const SequenceArgument source = parse_sequence_argument(path.string());
  Rows rows(source.path, path.string(),
            {{"time", "image"},
             1,
             /*needs_header=*/false,
             kListSeparators,
             /*has_others=*/true,
             /*is_ragged=*/true});
  TimeReader reader(unit_of_times(rows, "time"));
  std::vector<ListedTime> listed;
  bool are_frames = rows.header().empty();    // the first of two columns counts them
  bool are_integers = rows.header().empty();  // of two columns, the first one in seconds
  for (size_t i = 0; rows.next(); ++i) {
    const auto cells = rows.cells();
    const std::string_view text = time_cell(rows);
    if (i == 0 && rows.header().empty() && !unit_of_time(text) && !parse_calendar_time(text))
      rows.fail(
          "its first line is neither a time nor a header with a column of times, such as \"time\" "
          "or \"time_ms\"");
    are_frames =
        are_frames && cells.size() == 2 && cells[0] == std::to_string(i) && unit_of_time(cells[1]);
    are_integers = are_integers && cells.size() == 2 && parse_number<int64_t>(cells[0]) &&
                   parse_number<int64_t>(cells[1]) && unit_of_time(cells[0]) == TimeUnit::seconds;
    const std::string_view image = rows.text("image");
    const ListedTime line{reader.read(rows.location(), text), rows.line(),
                          std::string(parse_real(image) ? "" : image)};
    if (i == 1 && rows.header().empty() && listed.size() == 1 && listed[0].time == 0 &&
        cells.size() == 1 && line.time > kYear)
      rows.fail(
          "the line before, 0, seems to be a header of pandas. Name the column \"time\", or omit "
          "the header, as in to_csv(header=False)");
    if (frame_in_range(source.range, i)) listed.push_back(line);
  }
  if (listed.empty()) rows.fail("has no times");
  if (are_frames && rows.size() > 1)
    rows.fail(
        "its first column counts 0, 1, 2, ... Add a first line that names the columns, such as "
        "frame,time");
  if (are_integers)
    rows.fail(
        "its second column may be a fraction of the first one. Use a decimal point, or add a first "
        "line that names the columns, such as time,frame");
  if (auto times = times_by_name(listed, names, path.string())) return *std::move(times);
  return times_in_order(listed, path.string());
}

std::vector<int64_t> read_frame_times(const std::filesystem::path& path,
                                      const std::vector<std::string>& names,
                                      const Monitor& monitor) {
  const SequenceArgument source = parse_sequence_argument(path.string());
  std::error_code error;
  if (std::filesystem::is_directory(source.path, error))
    return times_of_names(open_sequence(source));
  const bool is_text = read_file_start(source.path, kFileStart).find('\0') == std::string::npos;
  return is_text ? read_time_list(path, names) : read_video_times(source, monitor);
}

bool is_named_by_time(const std::filesystem::path& file) {
  const std::string name = file.stem().string();
  const size_t point = std::min(name.find('.'), name.size());
  const auto is_number = [](std::string_view text) {
    return !text.empty() && text.find_first_not_of("0123456789") == std::string_view::npos;
  };
  if (!is_number(std::string_view(name).substr(0, point))) return false;
  return point < name.size() ? is_number(std::string_view(name).substr(point + 1))
                             : name.size() >= kDigitsOfClock && !name.starts_with('0');
}

void check_rates(const SelectionSettings& settings) {
  if (settings.fps) check_fps(*settings.fps, "--fps");
  if (settings.recorded_fps) check_fps(*settings.recorded_fps, "--recorded-fps");
}

SequenceArgument selected(SequenceArgument argument, const SelectionSettings& settings,
                          const std::filesystem::path& file, uint64_t seed,
                          const Monitor& monitor) {
  check_rates(settings);
  const SequenceSource sequence = open_sequence(argument);
  argument.speed = settings.speed;
  argument.seed = seed;
  const auto& fps = settings.fps;
  const auto& recorded_fps = settings.recorded_fps ? settings.recorded_fps : settings.fallback_fps;
  if (settings.recorded_fps && (!file.empty() || states_times(sequence)))
    warn(monitor, "{}: its times are known, so --recorded-fps has no effect",
         argument.path.string());
  if (!fps) {
    argument.sequence.fps = stated_rate(sequence, file, recorded_fps, monitor);
    return argument;
  }
  const auto times = find_times(sequence, file, recorded_fps, monitor);
  if (!times)
    throw Error(ErrorKind::usage,
                "{}: the times of its frames are unknown, but --fps needs them. Use "
                "--recorded-fps, a video, images with times as names, or a data set with \"fps\"",
                text_of(argument));
  if (!file.empty() && sequence.kind != SequenceKind::video)
    if (const size_t frames = count_frames(sequence); frames != times->size())
      throw Error(ErrorKind::data, "{}: has {}, but {} has {}", file.string(),
                  counted(times->size(), "time"), text_of(argument), counted(frames, "frame"));
  const std::optional<double> own = median_fps(*times);
  Selection kept = resampled(*times, *fps);
  if (times->size() > kMaxThinned * kept.frames())
    throw Error(ErrorKind::usage, "{}: --fps {} keeps {} of its {}; use a larger value",
                text_of(argument), *fps, kept.frames(), counted(times->size(), "frame"));
  if (kept.frames() < times->size()) argument.sequence.selection = std::move(kept);
  argument.sequence.fps = own ? std::optional(std::min(*own, *fps)) : std::nullopt;
  return argument;
}

LiveSource open_resampled_source(LiveSource source, double fps,
                                 std::optional<double> recorded_fps) {
  struct State {
    LiveSource source;
    Thinner thinner;
    TimeReader names = TimeReader();
    bool is_named = false;
    std::filesystem::path first = {};
    size_t frames = 0;
    std::optional<LiveFrame> last = {};
  };
  const auto state = std::make_shared<State>(State{std::move(source), Thinner(fps)});
  const auto time_of = [=](const LiveFrame& frame) {
    const size_t index = state->frames++;
    if (index == 0) state->is_named = is_named_by_time(frame.file);
    if (state->is_named) {
      const std::string name = frame.file.stem().string();
      if (index == 0) state->first = frame.file;
      if (index == 1) {  // two times show their unit
        const std::string first = state->first.stem().string();
        state->names = TimeReader(
            unit_of_times({frame.file.string()}, std::vector<std::string_view>{first, name}));
        state->thinner = Thinner(fps);
        state->thinner.keeps_before(state->names.read_next({state->first.string()}, first));
      }
      return state->names.read_next({frame.file.string()}, name);
    }
    if (!recorded_fps)
      throw Error(ErrorKind::usage,
                  "{}: its time is unknown, but --fps needs it. Use --recorded-fps, or images with "
                  "times as names",
                  frame.file.string());
    return even_time(index, *recorded_fps);
  };
  return {[=](const Monitor& monitor) -> std::optional<LiveFrame> {
    for (;;) {
      std::optional<LiveFrame> frame = state->source.next(monitor);
      const bool is_kept =
          frame ? state->thinner.keeps_before(time_of(*frame)) : state->thinner.keeps_last();
      const bool is_end = !frame;
      std::optional<LiveFrame> before = std::exchange(state->last, std::move(frame));
      if (is_kept) return before;
      if (is_end) return std::nullopt;
    }
  }};
}

}  // namespace vpr
