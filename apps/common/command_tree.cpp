#include "command_tree.h"

#include "base/text.h"

namespace vpr {

std::vector<Section> split_sections(const std::string& footer) {
  std::vector<Section> sections;
  bool is_start = true;
  for (const std::string_view line : split_lines(footer)) {
    if (is_start && line.ends_with(':') && !line.starts_with(' '))
      sections.push_back({std::string(line.substr(0, line.size() - 1)), ""});
    else if (!sections.empty())
      sections.back().text += std::string(line) + "\n";
    is_start = line.empty();
  }
  for (Section& section : sections) section.text.erase(section.text.find_last_not_of('\n') + 1);
  return sections;
}

}  // namespace vpr
