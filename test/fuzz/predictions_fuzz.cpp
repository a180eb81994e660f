// Any bytes as a prediction list, and as the file of one query.
#include "evaluate/prediction_lists.h"
#include "fuzz.h"

using namespace vpr;

namespace {

void read_rows(const std::filesystem::path& path, const FrameNames& names,
               std::optional<ScoreOrder> kind) {
  const ScoreMatrix matrix = prediction_scores(path, names, names, kind);
  if (matrix.queries * matrix.references > 1'000'000) return;
  size_t rows = 0;
  matrix.for_each_row(1, {}, "", [&](size_t, size_t, std::span<const uint64_t> keys) {
    fuzz::require(keys.size() == matrix.references);
    ++rows;
  });
  fuzz::require(rows == matrix.queries);
}

}  // namespace

void fuzz::run(std::string_view input) {
  const FrameNames names({"a/1.jpg", "a/2.jpg", "b/1.jpg", "b/2.jpg"});
  const std::string bytes(input);
  for (const char* name : {"list.txt", "list.csv"}) {
    const std::filesystem::path folder = folder_of({{name, bytes}});
    refuses([&] { read_rows(folder / name, names, {}); });
    refuses([&] { read_rows(folder / name, FrameNames({}), ScoreOrder::similarity); });
    refuses([&] { read_rows(folder, names, {}); });
  }
}
