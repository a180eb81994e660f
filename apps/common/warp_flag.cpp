#include "warp_flag.h"

#include "base/named_table.h"
#include "images/selection.h"

namespace vpr {

Flag add_warp_flag(const Command& command, std::string& warp, const std::string& about) {
  std::vector<std::string> names = names_of(warp_rules());
  names.emplace_back("NUMBER");
  command.add_footer("Warps:\n" + warp_summaries());
  return command.add_option("--warp", warp, about).choices("WARP", names);
}

}  // namespace vpr
