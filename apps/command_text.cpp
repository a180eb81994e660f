#include "command_text.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace vpr {
namespace {

std::string quoted(const std::string& argument) {
  const auto is_plain = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
           std::string_view("_-./:=@%+,").find(c) != std::string_view::npos;
  };
  bool plain = !argument.empty();
  std::string text = "'";
  for (const char c : argument) {
    plain = plain && is_plain(c);
    text += c == '\'' ? "'\\''" : std::string(1, c);
  }
  return plain ? argument : text + "'";
}

}  // namespace

std::string command_with(const std::vector<std::string>& command_line, const std::string& flag,
                         const std::string& value) {
  std::vector<std::string> words;
  for (size_t i = 0; i < command_line.size(); ++i) {
    const std::string& argument = command_line[i];
    if (argument == flag)
      ++i;  // its value goes with it
    else if (!argument.starts_with(flag + "="))
      words.push_back(quoted(argument));
  }
  words.push_back(flag);
  words.push_back(quoted(value));
  return fmt::format("{}", fmt::join(words, " "));
}

}  // namespace vpr
