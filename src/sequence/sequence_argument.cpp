#include "sequence/sequence_argument.h"

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <map>
#include <string_view>

#include <fmt/format.h>

#include "base/error.h"
#include "base/text.h"

namespace vpr {

namespace {

// The number in front of `text`, cut off; nothing if there is no digit. Throws when too large.
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

// Nothing if `text` is not of the form FIRST:LAST[:STEP].
std::optional<FrameRange> parse_range(std::string_view text, const std::string& argument) {
  if (text.find_first_not_of("0123456789:") != std::string_view::npos) return std::nullopt;
  FrameRange range;
  range.first = take_number(text, argument).value_or(0);
  if (!take_colon(text)) return std::nullopt;
  range.last = take_number(text, argument);
  if (take_colon(text)) range.step = take_number(text, argument).value_or(1);
  if (!text.empty()) return std::nullopt;
  return range;
}

namespace fs = std::filesystem;

/// A name that can grow until it differs from others.
struct SequenceName {
  fs::path path;                   // absolute
  std::vector<std::string> parts;  // own name first, then parents
  size_t used = 1;                 // parts
  bool with_extension = false;
  std::string range;
  bool with_range = false;
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
  name.range = range_text(argument.range);
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
  return name.with_range ? text + name.range : text;
}

// Lets the names of a group grow by one step: ranges of one path, extensions of one folder, and
// otherwise a parent. False if nothing is left to add.
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
    } else if (!name.with_range && !name.range.empty()) {
      changed = name.with_range = true;
    }
  }
  return changed;
}

}  // namespace

SequenceArgument parse_sequence_argument(const std::string& text) {
  std::error_code error;
  const size_t at = text.rfind('@');
  if (at == std::string::npos || std::filesystem::exists(text, error)) return {text, {}};
  const auto range = parse_range(std::string_view(text).substr(at + 1), text);
  if (!range) return {text, {}};
  if (range->step == 0)
    throw Error(ErrorKind::usage, fmt::format("{}: a step of 0 never ends; give 1 or more", text));
  if (range->last && *range->last <= range->first)
    throw Error(
        ErrorKind::usage,
        fmt::format("{}: the range is empty; LAST is excluded and must exceed FIRST", text));
  return {text.substr(0, at), *range};
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

std::vector<std::string> sequence_names(const std::vector<SequenceArgument>& arguments,
                                        const std::vector<std::string>& taken) {
  std::vector<SequenceName> names;
  for (const SequenceArgument& argument : arguments) names.push_back(make_name(argument));
  for (;;) {
    std::map<std::string, std::vector<size_t>> equal;
    for (size_t i = 0; i < names.size(); ++i) equal[name_text(names[i])].push_back(i);
    bool is_unique = true;
    for (const auto& [text, group] : equal) {
      if (group.size() == 1 && std::find(taken.begin(), taken.end(), text) == taken.end()) continue;
      is_unique = false;
      if (!distinguish(names, group))
        throw Error(ErrorKind::usage,
                    fmt::format("two training sequences are called {} and have the same path and "
                                "range; give each only once",
                                text));
    }
    if (is_unique) break;
  }
  std::vector<std::string> texts;
  for (const SequenceName& name : names) texts.push_back(name_text(name));
  return texts;
}

}  // namespace vpr
