#include "repeated_command.h"

#include <algorithm>

#include <fmt/ranges.h>

#include "base/text.h"

namespace vpr {
std::string repeated_command(const std::vector<std::string>& words,
                             const std::vector<std::string>& dropped,
                             const std::vector<std::string>& added) {
  std::vector<std::string> kept;
  for (size_t w = 0; w < words.size(); ++w) {
    const std::string flag = words[w].substr(0, words[w].find('='));
    if (std::find(dropped.begin(), dropped.end(), flag) == dropped.end())
      kept.push_back(shell_word(words[w]));
    else if (flag == words[w])
      ++w;  // its value
  }
  for (const std::string& word : added) kept.push_back(shell_word(word));
  return fmt::format("{}", fmt::join(kept, " "));
}

}  // namespace vpr
