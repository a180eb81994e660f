#include "images/frame_names.h"

#include <algorithm>
#include <array>
#include <charconv>

#include <fmt/format.h>

#include "base/counted.h"
#include "base/error.h"
#include "base/mapped_file.h"
#include "base/text.h"
#include "base/utf8.h"
#include "images/sequence.h"

namespace vpr {
namespace {

constexpr uint64_t kMostFrames = 10'000'000;

bool is_list(const std::filesystem::path& path) {
  constexpr std::array<std::string_view, 3> kExtensions = {".txt", ".lst", ".csv"};
  return std::ranges::find(kExtensions, path.extension().string()) != kExtensions.end();
}

std::vector<std::string> listed_names(const SequenceArgument& argument) {
  const MappedFile file(argument.path);
  std::vector<std::string> all;
  for (const std::string_view line : split_lines(without_byte_order_mark(file.text())))
    if (!line.empty() && !line.starts_with('#')) all.emplace_back(line);
  const uint64_t last = argument.range.last.value_or(all.size());
  if (argument.range.first >= last || last > all.size())
    throw Error(ErrorKind::usage,
                fmt::format("{}: has {}, and the range {} is none of it", argument.path.string(),
                            counted(all.size(), "name"), range_text(argument.range)));
  std::vector<std::string> names;
  for (uint64_t i = argument.range.first; i < last; i += argument.range.step)
    names.push_back(all[i]);
  return names;
}

std::string_view file_name(std::string_view path) {
  return path.substr(path.rfind('/') == std::string_view::npos ? 0 : path.rfind('/') + 1);
}

// How many last components of two paths are the same.
size_t shared_components(std::string_view a, std::string_view b) {
  const auto left = split(a, '/');
  const auto right = split(b, '/');
  size_t shared = 0;
  while (shared < std::min(left.size(), right.size()) &&
         left[left.size() - 1 - shared] == right[right.size() - 1 - shared])
    ++shared;
  return shared;
}

std::optional<size_t> parse_number(std::string_view text) {
  uint64_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc{} || end != text.data() + text.size() || number >= kMostFrames)
    return std::nullopt;
  return number;
}

}  // namespace

std::vector<std::string> frame_names(const SequenceArgument& argument) {
  if (is_list(argument.path)) return listed_names(argument);
  const Sequence sequence = open_sequence(argument);
  if (sequence.kind == SequenceKind::video || sequence.is_one_array())
    throw Error(ErrorKind::usage,
                fmt::format("{}: does not say what its frames are called; give a folder or a list",
                            argument.path.string()));
  std::vector<std::string> names;
  for (const auto& path : sequence.files) names.push_back(path.generic_string());
  return names;
}

FrameNames::FrameNames(std::vector<std::string> names) : names_(std::move(names)) {
  for (size_t i = 0; i < names_.size(); ++i) {
    const std::string_view name = file_name(names_[i]);
    by_file_name_[std::string(name)].push_back(i);
    by_stem_[std::string(name.substr(0, name.rfind('.')))].push_back(i);
  }
}

std::optional<size_t> FrameNames::count() const {
  return names_.empty() ? std::nullopt : std::optional(names_.size());
}

std::optional<size_t> FrameNames::find(std::string_view path) const {
  if (names_.empty()) return parse_number(path);
  const auto found = by_file_name_.find(file_name(path));
  if (found == by_file_name_.end()) {
    const auto stem = by_stem_.find(file_name(path));
    if (stem == by_stem_.end() || stem->second.size() > 1) return std::nullopt;
    return stem->second.front();
  }
  if (found->second.size() == 1) return found->second.front();
  std::optional<size_t> best;
  size_t most = 0;
  bool is_tied = false;
  for (const size_t i : found->second) {
    if (names_[i] == path) return i;
    const size_t shared = shared_components(names_[i], path);
    is_tied = shared == most || (shared < most && is_tied);
    if (shared <= most) continue;
    most = shared;
    best = i;
  }
  return is_tied ? std::nullopt : best;
}

}  // namespace vpr
