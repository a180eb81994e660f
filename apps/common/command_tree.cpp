#include "command_tree.h"

#include <sstream>

namespace vpr {

std::vector<Section> split_sections(const std::string& footer) {
  std::vector<Section> sections;
  std::istringstream text(footer);
  bool is_start = true;
  for (std::string line; std::getline(text, line); is_start = line.empty()) {
    if (is_start && line.ends_with(':') && !line.starts_with(' '))
      sections.push_back({line.substr(0, line.size() - 1), ""});
    else if (!sections.empty())
      sections.back().text += line + "\n";
  }
  for (Section& section : sections) section.text.erase(section.text.find_last_not_of('\n') + 1);
  return sections;
}

}  // namespace vpr
