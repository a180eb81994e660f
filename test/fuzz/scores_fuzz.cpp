// Any bytes as an array, and as a matrix of scores to evaluate.
#include "evaluate/score_matrix.h"
#include "fuzz.h"

using namespace vpr;

namespace {

void read_array(const std::filesystem::path& path) {
  const NpyArray array(path);
  volatile float sum = 0;
  for (const float value : array.values<float>(2)) sum = sum + value;
}

void read_rows(const std::filesystem::path& path, const ScoreFormat& format) {
  const ScoreMatrix matrix(path, format);
  matrix.fingerprint({});
  size_t rows = 0;
  matrix.for_each_row(1, {}, "", [&](size_t, size_t, std::span<const uint64_t> keys) {
    fuzz::require(keys.size() == matrix.references);
    ++rows;
  });
  fuzz::require(rows == matrix.queries);
}

}  // namespace

void fuzz::run(std::string_view input) {
  const std::filesystem::path path = memory_file(input);
  refuses([&] { read_array(path); });
  for (const ScoreFormat& format : {ScoreFormat{}, ScoreFormat{true, true, 0}})
    refuses([&] { read_rows(path, format); });
}
