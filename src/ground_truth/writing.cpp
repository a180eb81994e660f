#include "ground_truth/writing.h"

#include <fmt/format.h>

#include "base/error.h"
#include "base/monitor.h"
#include "base/output.h"
#include "ground_truth/ground_truth.h"

namespace vpr {
namespace {

constexpr size_t kPieceBytes = size_t{1} << 20;

}  // namespace

size_t only_written_sequence(const InspectedGroundTruth& ground_truth, std::string_view format) {
  size_t searched = 0;
  size_t index = 0;
  const auto& sequences = ground_truth.scope.sequences;
  for (size_t s = 0; s < sequences.size(); ++s) {
    if (!sequences[s].searched) continue;
    ++searched;
    index = s;
  }
  if (searched == 1) return index;
  throw Error(ErrorKind::usage,
              fmt::format("the format {} holds one training sequence, and there are {}; use pairs",
                          format, searched));
}

void require_writable(uint64_t count, uint64_t most, std::string_view what) {
  if (count > most)
    throw Error(ErrorKind::data,
                fmt::format("the file would hold {} {}; the limit is {}. Check the largest frame "
                            "numbers, or use fewer frames",
                            count, what, most));
}

void write_piece(Output& file, std::string& text, const Monitor& monitor) {
  if (text.size() < kPieceBytes) return;
  check_stop(monitor);
  file.write(text);
  text.clear();
}

}  // namespace vpr
