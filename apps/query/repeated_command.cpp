#include "repeated_command.h"

#include <algorithm>
#include <string_view>

#include <fmt/ranges.h>

namespace vpr {
namespace {

std::string quoted(const std::string& word) {
  constexpr std::string_view kPlain =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-+=.,:/@%";
  if (!word.empty() && word.find_first_not_of(kPlain) == std::string::npos) return word;
  std::string text = "'";
  for (const char letter : word)
    text += letter == '\'' ? std::string("'\\''") : std::string(1, letter);
  return text + "'";
}

}  // namespace

std::string repeated_command(const std::vector<std::string>& words,
                             const std::vector<std::string>& dropped,
                             const std::vector<std::string>& added) {
  std::vector<std::string> kept;
  for (size_t w = 0; w < words.size(); ++w) {
    const std::string flag = words[w].substr(0, words[w].find('='));
    if (std::find(dropped.begin(), dropped.end(), flag) == dropped.end())
      kept.push_back(quoted(words[w]));
    else if (flag == words[w])
      ++w;  // its value
  }
  for (const std::string& word : added) kept.push_back(quoted(word));
  return fmt::format("{}", fmt::join(kept, " "));
}

}  // namespace vpr
