#include "truth/frame_times.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "base/error.h"
#include "base/mapped_file.h"
#include "base/npy.h"
#include "base/text.h"
#include "recordings/frames.h"
#include "recordings/live_source.h"
#include "truth/frame_cells.h"
#include "truth/times.h"

namespace vpr {
namespace {

constexpr int64_t kYear = 31'536'000 * kSecond;
constexpr size_t kDigitsOfClock = 10;  // seconds since 1970

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

// Whether a word after a date changes it: AM, PM, or the name of a zone.
bool changes_date(std::string_view word) {
  constexpr std::string_view kWords[] = {"am",  "pm",   "est", "edt", "cst",  "cdt",  "mst", "mdt",
                                         "pst", "pdt",  "bst", "ist", "cet",  "cest", "eet", "eest",
                                         "wet", "west", "msk", "jst", "aest", "aedt"};
  return std::ranges::find(kWords, lower_case(std::string(word))) != std::end(kWords);
}

// The time of the current row. Blanks between cells also split a date, its time of day and its
// zone.
std::string_view time_cell(const Rows& rows) {
  const std::string_view text = rows.text("time");
  const auto cells = rows.cells();
  const auto found = std::ranges::find(cells, text.data(), &std::string_view::data);
  const auto joined = [&](ptrdiff_t more) {
    const std::string_view last = found[more];
    return std::string_view(text.data(),
                            static_cast<size_t>(last.data() + last.size() - text.data()));
  };
  const ptrdiff_t most = std::min<ptrdiff_t>(3, cells.end() - found - 1);
  for (ptrdiff_t more = std::min<ptrdiff_t>(2, most); more >= 0; --more) {
    if (!parse_calendar_time(joined(more))) continue;
    if (more < most && changes_date(found[more + 1]) &&
        joined(more + 1).find_first_of(",;\t") == std::string_view::npos)
      rows.fail("\"{}\" after the date is not read. Write times of 24 hours, in UTC or with +hh:mm",
                found[more + 1]);
    return joined(more);
  }
  return text;
}

// The lines of a list of times.
struct ListedTimes {
  std::vector<int64_t> times = {};
  std::vector<size_t> lines = {};
  std::vector<std::string> images = {};  // empty: not named
};

// The names of the frames, if lines name images.
std::optional<FrameNames> names_for(const ListedTimes& listed, const NameReader& names,
                                    const std::string& file, const Monitor& monitor) {
  if (std::ranges::all_of(listed.images, &std::string::empty)) return std::nullopt;
  try {
    return find_names(names);
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::input) throw;
    warn(monitor,
         "{}: names images, but those of its frames are unknown, so each line belongs to the next "
         "frame: {}",
         file, error.what());
    return std::nullopt;
  }
}

// The times of the frames in their order; nullopt if no line names one of them.
std::optional<std::vector<int64_t>> times_by_name(const ListedTimes& listed,
                                                  const FrameNames& names,
                                                  const std::string& file) {
  const auto entries = entries_by_frame(names, listed.images, listed.lines, file);
  if (std::ranges::none_of(entries, [](const auto& entry) { return entry.has_value(); }))
    return std::nullopt;
  std::vector<int64_t> times;
  for (size_t frame = 0; frame < names.count(); ++frame) {
    if (!entries[frame]) FileLocation{file}.fail("has no time of {}", names.name(frame));
    const int64_t time = listed.times[*entries[frame]];
    if (frame > 0 && time == times.back())
      FileLocation{file, "line", listed.lines[*entries[frame]]}.fail(
          "{} has the same time as {}. If times are whole seconds, use the rate of the recording "
          "instead, with --recorded-fps",
          names.name(frame), names.name(frame - 1));
    if (frame > 0 && time < times.back())
      FileLocation{file, "line", listed.lines[*entries[frame]]}.fail(
          "{} is not later than {}, which is before it in the sequence. Pass a list of the images "
          "in the order of their times",
          names.name(frame), names.name(frame - 1));
    times.push_back(time);
  }
  return times;
}

std::string text_of(const SequenceArgument& argument) {
  return argument.path.string() + range_text(argument.range);
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

std::vector<int64_t> read_time_list(const std::filesystem::path& path, const NameReader& names,
                                    const Monitor& monitor) {
  const SequenceArgument source = parse_sequence_argument(path.string());
  Rows rows(source.path, path.string(), list_rules({"time", "image"}));
  TimeReader reader(unit_of_times(rows, "time"));
  ListedTimes listed;
  bool are_frames = rows.header().empty();  // the first column counts them
  std::optional<int64_t> first_frame;
  bool are_integers = rows.header().empty();  // of two columns, the first one in seconds
  for (size_t i = 0; rows.next(); ++i) {
    const auto cells = rows.cells();
    const std::string_view text = time_cell(rows);
    if (i == 0 && rows.header().empty() && !unit_of_time(text) && !parse_calendar_time(text))
      rows.fail(
          "its first line is neither a time nor a header with a column of times, such as \"time\" "
          "or \"time_ms\"");
    const auto number = parse_number<int64_t>(cells[0]);
    if (i == 0) first_frame = number;
    are_frames = are_frames && cells.size() >= 2 && cells.size() <= 3 && number &&
                 first_frame <= 1 && *number == *first_frame + static_cast<int64_t>(i) &&
                 unit_of_time(cells[1]);
    are_integers = are_integers && cells.size() == 2 && number && parse_number<int64_t>(cells[1]) &&
                   unit_of_time(cells[0]) == TimeUnit::seconds;
    const std::string_view image = rows.text("image");
    const int64_t time = reader.read(rows.location(), text);
    if (i == 1 && rows.header().empty() && listed.times == std::vector<int64_t>{0} &&
        cells.size() == 1 && time > kYear)
      rows.fail(
          "the line before, 0, seems to be a header of pandas. Name the column \"time\", or omit "
          "the header, as in to_csv(header=False)");
    if (!frame_in_range(source.range, i)) continue;
    listed.times.push_back(time);
    listed.lines.push_back(rows.line());
    const bool is_number = rows.header().empty() && parse_real(image);
    listed.images.emplace_back(is_number ? "" : image);
  }
  if (listed.times.empty()) rows.fail("has no times");
  if (are_frames && rows.size() > 1)
    rows.fail(
        "its first column counts {}, {}, {}, ... Add a first line that names the columns, such as "
        "frame time",
        *first_frame, *first_frame + 1, *first_frame + 2);
  if (are_integers)
    rows.fail(
        "its second column may be a fraction of the first one. Use a decimal point, or add a first "
        "line that names the columns, such as time,frame");
  if (const auto known = names_for(listed, names, path.string(), monitor))
    if (auto times = times_by_name(listed, *known, path.string())) return *std::move(times);
  for (size_t i = 1; i < listed.times.size(); ++i)
    if (listed.times[i] <= listed.times[i - 1])
      refuse_time_order({path.string(), "line", listed.lines[i]}, listed.times[i - 1],
                        listed.times[i]);
  return std::move(listed.times);
}

std::vector<int64_t> read_frame_times(const std::filesystem::path& path, const NameReader& names,
                                      const Monitor& monitor) {
  const SequenceArgument source = parse_sequence_argument(path.string());
  std::error_code error;
  if (std::filesystem::is_directory(source.path, error)) {
    const SequenceSource folder = open_sequence(source);
    std::vector<int64_t> times = times_of_names(folder);
    if (!states_times(folder))
      warn(monitor,
           "{}: the names of its frames, {} to {}, are interpreted as seconds; if they count "
           "frames, pass a list of their times",
           path.string(), time_text(times.front()), time_text(times.back()));
    return times;
  }
  const std::string start = read_file_start(source.path, kFileStart);
  const bool is_text = start.find('\0') == std::string::npos && !start.starts_with("YUV4MPEG2");
  return is_text ? read_time_list(path, names, monitor) : read_video_times(source, monitor);
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

bool states_times(const SequenceSource& sequence) {
  return sequence.kind == SequenceKind::video ||
         (!sequence.is_one_array() && is_named_by_time(sequence.files.front()));
}

size_t count_frames(const SequenceSource& sequence) {
  if (!sequence.is_one_array()) return sequence.files.size();
  SequenceArgument argument = sequence.argument;
  const auto array =
      argument.array ? argument.array : std::make_shared<const NpyArray>(argument.path);
  argument.range.last = argument.range.last.value_or(array->shape().at(0));
  return frame_count(argument.range).value_or(0);
}

std::vector<int64_t> even_times(size_t frames, double fps) {
  std::vector<int64_t> times;
  for (size_t i = 0; i < frames; ++i) times.push_back(even_time(i, fps));
  return times;
}

std::optional<std::vector<int64_t>> find_times(const SequenceSource& sequence,
                                               const std::filesystem::path& file,
                                               std::optional<double> recorded_fps,
                                               const Monitor& monitor) {
  if (!file.empty()) return read_frame_times(file, name_reader(sequence.argument), monitor);
  const SequenceArgument& argument = sequence.argument;
  if (sequence.kind == SequenceKind::video) return read_video_times(argument, monitor);
  if (states_times(sequence)) return times_of_names(sequence);
  if (!recorded_fps) return std::nullopt;
  return even_times(count_frames(sequence),
                    *recorded_fps / static_cast<double>(argument.range.step));
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
  if (!file.empty()) {
    const Monitor silent{{}, {}, monitor.stop};
    const size_t frames = sequence.kind == SequenceKind::video
                              ? read_video_times(argument, silent).size()
                              : count_frames(sequence);
    if (frames != times->size())
      throw Error(ErrorKind::data, "{}: has {}, but {} has {}", file.string(),
                  counted(times->size(), "time"), text_of(argument), counted(frames, "frame"));
  }
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
      if (frame && frame->is_gone()) {
        warn(monitor, "{}: does not exist, and is omitted", frame->file.string());
        continue;
      }
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
