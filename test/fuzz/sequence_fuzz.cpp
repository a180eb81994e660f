// The name of a sequence, as on a command line, and a list of images.
#include "base/text.h"
#include "fuzz.h"
#include "recordings/sequence_source.h"

using namespace vpr;

namespace {

void read_name(const std::string& name) {
  const SequenceArgument argument = parse_sequence_argument(name);
  frame_in_range(argument.range, 7);
  frame_count(argument.range);
  range_text(argument.range);
  sequence_names({argument, {"other/walk", {}}});
}

// An order of byte strings.
void compare_names(std::string_view text) {
  const std::string_view a = text.substr(0, text.size() / 2);
  const std::string_view b = text.substr(text.size() / 2);
  fuzz::require(!natural_less(a, a) && !natural_less(b, b));
  fuzz::require(!(natural_less(a, b) && natural_less(b, a)));
  fuzz::require(a == b || natural_less(a, b) || natural_less(b, a));
}

}  // namespace

void fuzz::run(std::string_view input) {
  const std::vector<Part> parts = split_parts(input);
  const std::filesystem::path folder = folder_of(parts);
  const std::string* name = find_part(parts, "name");
  if (name != nullptr) {
    compare_names(*name);
    refuses([&] { read_name(*name); });
  }
  const SequenceArgument list = {folder / "list.txt", {}};
  refuses([&] { open_sequence(list); });
  refuses([&] { open_sequence({folder / "list.txt", {1, 3, 2}}); });
}
