// Any bytes as a score matrix.
#include "evaluate/score_matrix.h"
#include "fuzz.h"

using namespace vpr;

namespace {

// (Evaluating its rows takes as long as a thousand readings and finds nothing new.)
void read_rows(const std::filesystem::path& path, const ScoreFormat& format) {
  const ScoreMatrix matrix(path, format);
  matrix.fingerprint({});
  size_t rows = 0;
  matrix.for_each_row(1, {}, "", [&](size_t, size_t, std::span<const uint64_t> keys) {
    fuzz::require(keys.size() == matrix.references());
    ++rows;
  });
  fuzz::require(rows == matrix.queries());
}

}  // namespace

void fuzz::run(std::string_view input) {
  const std::filesystem::path path = memory_file(input);
  refuses([&] { read_rows(path, {}); });
  refuses([&] { read_rows(path, {true, true, 0}); });
}
