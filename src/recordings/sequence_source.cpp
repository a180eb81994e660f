#include "recordings/sequence_source.h"

#include <algorithm>
#include <fstream>
#include <set>
#include <span>

#include <fmt/format.h>

#include "base/checksum.h"
#include "base/column_names.h"
#include "base/converters.h"
#include "base/error.h"
#include "base/mapped_file.h"
#include "base/output.h"
#include "base/rows.h"
#include "base/text.h"
#include "recordings/frame_order.h"

namespace vpr {

namespace {

namespace fs = std::filesystem;

constexpr std::string_view kImageExtensions[] = {".jpg", ".jpeg", ".jpe", ".jfif", ".png",
                                                 ".bmp", ".dib",  ".pgm", ".ppm",  ".pnm",
                                                 ".tif", ".tiff", ".webp"};
constexpr std::string_view kArrayExtensions[] = {".npy"};
constexpr std::string_view kListExtensions[] = {".txt", ".lst", ".csv"};

bool has_extension(const fs::path& path, std::span<const std::string_view> extensions) {
  return std::ranges::find(extensions, lower_case(path.extension().string())) != extensions.end();
}

// Also the folder that macOS adds to ZIP files.
bool is_hidden(const fs::path& path) {
  const std::string name = path.filename().string();
  return name.starts_with('.') || name == "__MACOSX";
}

bool is_there(const fs::path& path) {
  std::error_code ignored;
  return fs::exists(path, ignored);
}

// "PATH@100", which is not a range.
std::string range_question(const std::string& text) {
  const size_t at = text.rfind('@');
  if (at == std::string::npos || at + 1 == text.size() ||
      text.find_first_not_of("0123456789:-", at + 1) != std::string::npos ||
      !is_there(text.substr(0, at)))
    return "";
  return fmt::format(". A range is FIRST:LAST[:STEP], as in {}@0:100", text.substr(0, at));
}

// In natural order of their names, without hidden ones.
std::vector<fs::path> folder_entries(const fs::path& folder) {
  std::vector<fs::path> found;
  for (const fs::directory_entry& entry : entries_of(folder, ErrorKind::input))
    if (!is_hidden(entry.path())) found.push_back(entry.path());
  std::ranges::sort(found, natural_less,
                    [](const fs::path& path) { return path.filename().string(); });
  return found;
}

void sort_frames(std::vector<fs::path>& files, const fs::path& folder) {
  const auto name_of = [](const fs::path& path) { return path.filename().string(); };
  std::vector<std::string> names;
  for (const fs::path& file : files) names.push_back(name_of(file));
  if (const NameOrder order = name_order(std::move(names), folder))
    std::ranges::sort(files, order, name_of);
}

// The files with one of the extensions.
std::vector<fs::path> files_of(const std::vector<fs::path>& entries,
                               std::span<const std::string_view> extensions) {
  std::vector<fs::path> files;
  std::ranges::copy_if(entries, std::back_inserter(files), [&](const fs::path& path) {
    std::error_code ignored;
    return has_extension(path, extensions) && !fs::is_directory(path, ignored);
  });
  return files;
}

// Refuses an image that is not read, unless one that is read has its name without extension: it
// would shift the numbers of frames.
void refuse_unread_images(const std::vector<fs::path>& entries) {
  constexpr std::string_view kUnread[] = {
      ".heic", ".heif", ".hif", ".heics", ".avif", ".avifs", ".gif", ".jp2", ".j2k", ".j2c",
      ".jpc",  ".jpx",  ".jxl", ".jxr",   ".mpo",  ".pbm",   ".pam", ".pfm", ".pcx", ".ras",
      ".tga",  ".exr",  ".hdr", ".dng",   ".cr2",  ".cr3",   ".nef", ".arw", ".orf", ".raf",
      ".rw2",  ".pef",  ".srw", ".rwl",   ".3fr",  ".iiq",   ".raw"};
  constexpr size_t kHeif = 6;  // the first ones
  std::set<fs::path> read;
  for (const fs::path& path : files_of(entries, kImageExtensions)) read.insert(path.stem());
  for (const fs::path& path : files_of(entries, kUnread)) {
    if (read.contains(path.stem())) continue;
    const std::string all = "*" + path.extension().string();
    throw Error(
        ErrorKind::input,
        "{}: {} images are not supported. Convert them, or frame numbers would shift: {}",
        path.string(), all,
        has_extension(path, std::span(kUnread).first(kHeif))
            ? fmt::format("for f in {}; do heif-convert \"$f\" \"${{f%.*}}.jpg\"; done", all)
            : "mogrify -format png " + all);
  }
}

bool is_array(const fs::path& path) { return has_extension(path, kArrayExtensions); }

// A path that Windows wrote.
std::string with_slashes(std::string_view path) {
  std::string text(path);
  std::ranges::replace(text, '\\', '/');
  return text;
}

// The separators of a list with a column of images; empty for one image per line.
std::string_view table_separators(const fs::path& list, const std::string& text) {
  if (is_there(list.parent_path() / first_line_of(text))) return "";
  if (has_columns(first_row(text), {"image"})) return kTableSeparators;
  const bool has_times = has_columns(first_row(text, kListSeparators), {"time", "image"});
  return has_times ? kListSeparators : "";
}

// The images of a list, which need not exist: its lines, or a column. Backslashes separate folders
// unless a file has them in its name.
std::vector<std::string> read_list(const fs::path& list) {
  std::vector<std::string> names;
  const auto add = [&](std::string_view name) {
    const bool is_windows =
        name.find('\\') != std::string_view::npos && !is_there(list.parent_path() / name);
    names.push_back(is_windows ? with_slashes(name) : std::string(name));
  };
  const std::string file = read_whole_file(list);
  if (file.find('\0') != std::string::npos)
    throw Error(ErrorKind::input, "{}: is not a text file with one image path per line",
                list.string());
  if (const auto separators = table_separators(list, file); !separators.empty()) {
    Rows rows(list, list.string(), {{"image"}, 1, true, separators, /*has_others=*/true});
    while (rows.next()) add(rows.text("image"));
  } else {
    for (std::string_view line : split_lines(file)) {
      line = line.substr(0, line.find_last_not_of(" \t") + 1);
      if (!line.empty() && !line.starts_with('#')) add(line);
    }
  }
  if (names.empty()) throw Error(ErrorKind::input, "{}: the list names no images", list.string());
  return names;
}

template <class Name>
std::vector<Name> apply_range(const std::vector<Name>& all, const SequenceArgument& argument) {
  const FrameRange& range = argument.range;
  const uint64_t last = range.last.value_or(all.size());
  if (range.first >= all.size() || last > all.size())
    throw Error(ErrorKind::usage, "{0}{1} exceeds its {2}. {0}@0:{3} has all of them",
                argument.path.string(), range_text(range), counted(all.size(), "frame"),
                all.size());
  std::vector<Name> names;
  for (uint64_t i = range.first; i < last; i += std::min(range.step, last - i))
    names.push_back(all[i]);
  return names;
}

std::string_view file_name(std::string_view path) {
  return path.substr(path.rfind('/') + 1);  // npos + 1 is 0
}

// The number of equal last components of two paths.
size_t shared_components(std::string_view a, std::string_view b) {
  const auto left = split(a, '/');
  const auto right = split(b, '/');
  return static_cast<size_t>(
      std::mismatch(left.rbegin(), left.rend(), right.rbegin(), right.rend()).first -
      left.rbegin());
}

/// A name that can be extended until it differs from others.
struct SequenceName {
  fs::path path;                   // absolute
  std::vector<std::string> parts;  // own name first, then parents
  size_t used = 1;                 // parts
  bool with_extension = false;
  std::string range;  // empty for all frames
};

// Results are JSON, which is UTF-8: other bytes become %XX.
std::string as_utf8(const std::string& text) {
  if (is_utf8(text)) return text;
  std::string escaped;
  for (const char c : text)
    escaped +=
        (c & 0x80) != 0 ? fmt::format("%{:02X}", static_cast<uint8_t>(c)) : std::string(1, c);
  return escaped;
}

SequenceName make_name(const SequenceArgument& argument) {
  std::error_code error;
  SequenceName name;
  name.path = fs::absolute(argument.path, error).lexically_normal();
  if (!name.path.has_filename()) name.path = name.path.parent_path();
  if (!argument.range.is_all()) name.range = range_text(argument.range);
  const bool is_folder = fs::is_directory(name.path, error);
  name.parts.push_back(as_utf8((is_folder ? name.path.filename() : name.path.stem()).string()));
  for (fs::path parent = name.path.parent_path(); parent.has_filename();
       parent = parent.parent_path())
    name.parts.push_back(as_utf8(parent.filename().string()));
  return name;
}

std::string name_text(const SequenceName& name) {
  std::string text =
      name.with_extension ? as_utf8(name.path.filename().string()) : name.parts.front();
  for (size_t k = 1; k < name.used; ++k) text = fmt::format("{}/{}", name.parts[k], text);
  return text + name.range;
}

// Extends the names of a group by one step: extensions of one folder, otherwise a parent. Returns
// false if nothing is left to add.
bool distinguish(std::vector<SequenceName>& names, const std::vector<size_t>& group) {
  const SequenceName& first = names[group.front()];
  bool same_path = group.size() > 1;
  bool same_parents = group.size() > 1;
  for (const size_t i : group) {
    same_path = same_path && names[i].path == first.path;
    same_parents = same_parents && names[i].path.parent_path() == first.path.parent_path();
  }
  bool changed = false;
  for (const size_t i : group) {
    SequenceName& name = names[i];
    if (!same_path && same_parents && !name.with_extension) {
      changed = name.with_extension = true;
    } else if (!same_path && name.used < name.parts.size()) {
      ++name.used;
      changed = true;
    }
  }
  return changed;
}

}  // namespace

SequenceArgument parse_sequence_argument(const std::string& text) {
  const size_t at = text.rfind('@');
  if (at == std::string::npos || is_there(text)) return {text, {}};
  const auto range = parse_range(std::string_view(text).substr(at + 1), text);
  return range ? SequenceArgument{text.substr(0, at), *range} : SequenceArgument{text, {}};
}

std::vector<std::string> sequence_names(const std::vector<SequenceArgument>& arguments,
                                        const std::vector<std::string>& taken) {
  std::vector<SequenceName> names;
  for (const SequenceArgument& argument : arguments) names.push_back(make_name(argument));
  for (;;) {
    std::map<std::string, std::vector<size_t>> equal;
    for (size_t i = 0; i < names.size(); ++i) equal[name_text(names[i])].push_back(i);
    bool is_unique = true;
    for (const auto& [text, group] : equal) {
      if (group.size() == 1 && std::ranges::find(taken, text) == taken.end()) continue;
      is_unique = false;
      if (!distinguish(names, group))
        throw Error(ErrorKind::usage,
                    "two training sequences are named {} and have the same path and range. Pass "
                    "each only once",
                    text);
    }
    if (is_unique) break;
  }
  std::vector<std::string> texts;
  for (const SequenceName& name : names) texts.push_back(name_text(name));
  return texts;
}

bool is_frame_name(const fs::path& path) {
  return !is_hidden(path) && has_extension(path, kImageExtensions);
}

bool is_camera(const fs::path& path) {
  std::error_code ignored;
  return fs::is_character_file(path, ignored);
}

SequenceSource open_sequence(const SequenceArgument& argument) {
  const fs::path& path = argument.path;
  if (argument.array) return {argument, SequenceKind::descriptors, {path}};
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (!fs::exists(status))
    throw Error(ErrorKind::input, "{}: no such {}{}", path.string(),
                is_array(path) ? "file" : "folder, list or video", range_question(path.string()));
  SequenceSource sequence{argument, SequenceKind::images, {}};
  std::vector<fs::path> files;
  if (fs::is_directory(status)) {
    const std::vector<fs::path> entries = folder_entries(path);
    refuse_unread_images(entries);
    files = files_of(entries, kImageExtensions);
    if (files.empty()) files = files_of(entries, kArrayExtensions);
    sort_frames(files, path);
    if (files.empty())
      throw Error(ErrorKind::input,
                  "{}: the folder contains no images (subfolders are not searched)", path.string());
  } else if (has_extension(path, kListExtensions)) {
    for (const std::string& name : read_list(path)) files.push_back(path.parent_path() / name);
    if (std::ranges::none_of(files, is_there))
      throw Error(ErrorKind::input,
                  "{}: is not a list with one image path per line: no line names an existing file "
                  "(the first is {})",
                  path.string(), files.front().string());
  } else if (has_extension(path, kImageExtensions)) {
    throw Error(ErrorKind::input,
                "{}: is a single image. Pass its folder, a file that lists images, or a video",
                path.string());
  } else if (is_array(path)) {
    sequence.kind = SequenceKind::descriptors;
    sequence.files = {path};
    return sequence;
  } else if (!fs::is_regular_file(status)) {
    throw Error(ErrorKind::input, "{}: is neither a folder nor a regular file{}", path.string(),
                is_camera(path) ? ". To follow a camera, use vpr-query live" : "");
  } else if (fs::is_empty(path, error)) {  // a file in /proc, which would never end, has size 0
    throw Error(ErrorKind::input, "{}: is an empty file", path.string());
  } else if (path.extension() == ".npz") {
    throw Error(ErrorKind::usage,
                "{}: is an archive of arrays. Save one as .npy, as in numpy.save(\"q.npy\", "
                "numpy.load(\"q.npz\")[\"NAME\"])",
                path.string());
  } else {
    refuse_convertible(path, "", true);
    sequence.kind = SequenceKind::video;
    return sequence;
  }
  if (std::ranges::all_of(files, is_array)) sequence.kind = SequenceKind::descriptors;
  files = apply_range(files, argument);
  const Selection& selection = argument.sequence.selection;
  if (!selection.is_all() && selection.recorded_frames != files.size())
    throw Error(ErrorKind::input, "{}: had {} when their times were read, but now has {}",
                argument.path.string(), counted(selection.recorded_frames, "frame"), files.size());
  sequence.files = selected(std::move(files), selection);
  return sequence;
}

std::vector<SequenceArgument> subfolder_arguments(const fs::path& folder) {
  std::vector<SequenceArgument> arguments;
  std::error_code ignored;
  for (const fs::path& path : folder_entries(folder))
    if (fs::is_directory(path, ignored)) arguments.push_back({path, {}});
  if (arguments.empty())
    throw Error(ErrorKind::input, "{}: has no subfolders with sequences", folder.string());
  return arguments;
}

std::optional<std::vector<std::string>> known_frame_names(const SequenceArgument& argument) {
  if (has_extension(argument.path, kListExtensions))
    return apply_range(read_list(argument.path), argument);
  const SequenceSource sequence = open_sequence(argument);
  if (sequence.kind == SequenceKind::video || sequence.is_one_array()) return std::nullopt;
  std::vector<std::string> names;
  for (const auto& path : sequence.files) names.push_back(path.generic_string());
  return names;
}

std::vector<std::string> frame_names(const SequenceArgument& argument) {
  if (auto names = known_frame_names(argument)) return *std::move(names);
  throw Error(ErrorKind::usage, "{}: has no names of frames. Pass a folder or a list",
              argument.path.string());
}

NameReader name_reader(SequenceArgument argument) {
  return [argument = std::move(argument)] { return frame_names(argument); };
}

std::optional<FrameNames> find_names(const NameReader& names) {
  if (!names) return std::nullopt;
  try {
    return FrameNames(names());
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::usage) throw;
    return std::nullopt;
  }
}

std::string argument_text(const SequenceArgument& argument) {
  if (argument.array) return "";
  return argument.path.string() + range_text(argument.range);
}

std::vector<std::string> file_names(const SequenceSource& source) {
  std::vector<std::string> names;
  if (source.kind == SequenceKind::video || source.is_one_array()) return names;
  for (const fs::path& file : source.files) names.push_back(file.filename().string());
  return names;
}

std::string images_checksum(const SequenceSource& source) {
  constexpr size_t kReadFiles = 16;
  constexpr size_t kReadBytes = 1 << 20;  // per file
  if (source.kind == SequenceKind::descriptors) return "";
  const std::vector<fs::path> video = {source.argument.path};
  const auto& files = source.kind == SequenceKind::video ? video : source.files;
  ChecksumStream sum;
  std::error_code ignored;
  std::string sizes;
  for (const fs::path& file : files)
    sizes += fmt::format("{}\n{}\n", file.filename().string(), fs::file_size(file, ignored));
  sum.add(std::as_bytes(std::span(sizes)));
  const size_t count = std::min(kReadFiles, files.size());
  std::string bytes(kReadBytes, '\0');
  for (size_t i = 0; i < count; ++i) {
    std::ifstream input(files[i * files.size() / count], std::ios::binary);
    input.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    sum.add(std::as_bytes(std::span(bytes.data(), static_cast<size_t>(input.gcount()))));
  }
  return sum.text();
}

FrameNames::FrameNames(std::vector<std::string> names) : names_(std::move(names)) {
  for (size_t i = 0; i < names_.size(); ++i) {
    const std::string_view name = file_name(names_[i]);
    by_file_name_[std::string(name)].push_back(i);
    by_stem_[std::string(name.substr(0, name.rfind('.')))].push_back(i);
  }
}

bool FrameNames::has(std::string_view path) const {
  const std::string_view name = file_name(path);
  return by_file_name_.contains(name) || by_stem_.contains(name) ||
         (name.find('\\') != std::string_view::npos && has(with_slashes(path)));
}

std::optional<size_t> FrameNames::find(std::string_view path) const {
  const std::string_view name = file_name(path);
  if (name.find('\\') != std::string_view::npos && !by_file_name_.contains(name))
    return find(with_slashes(path));
  const bool is_stem = !by_file_name_.contains(name);
  const auto& names = is_stem ? by_stem_ : by_file_name_;
  const auto found = names.find(name);
  if (found == names.end() || (is_stem && found->second.size() > 1)) return std::nullopt;
  const std::string_view folder = path.substr(0, path.size() - name.size());
  for (size_t at = 0; (at = folder.find_first_of(" \t,;", at)) < folder.size(); ++at)
    if (names.contains(file_name(path.substr(0, at)))) return std::nullopt;  // several paths
  if (found->second.size() == 1) return found->second.front();
  std::optional<size_t> best;
  size_t most = 0;
  bool is_tied = false;
  for (const size_t i : found->second) {
    const size_t shared = names_[i] == path ? path.size() + 1 : shared_components(names_[i], path);
    is_tied = shared == most || (shared < most && is_tied);
    if (shared <= most) continue;
    most = shared;
    best = i;
  }
  return is_tied ? std::nullopt : best;
}

}  // namespace vpr
