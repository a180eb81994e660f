// Any bytes as a matrix of scores for windows: its values must agree with its units.
#include "fuzz.h"
#include "match/match.h"
#include "match/row_kernels.h"
#include "run/own_database.h"
#include "run/train.h"

using namespace vpr;

namespace {

constexpr size_t kMaxPairs = 20'000;

void match(const PrecomputedDistances& given, const FrameDistances& distances,
           size_t window_length) {
  MatchSettings settings;
  settings.window_length = window_length;
  settings.memory_limit = size_t{1} << 24;
  settings.kernels = select_kernels();
  const uint64_t most = uint64_t{given.units().largest} * window_length;
  const auto check = [&](const ScoreRow& row) {
    for (const uint32_t sum : row.scores) fuzz::require(sum <= most);
  };
  vpr::match(distances, settings, {{check}}, {});
}

void read_matrix(const std::filesystem::path& path, const ScoreFormat& format) {
  const PrecomputedDistances given(path, format, {});
  given.fingerprint({});
  if (given.queries() * given.references() > kMaxPairs) return;
  std::vector<uint16_t> row(given.references());
  for (size_t q = 0; q < given.queries(); ++q) {
    given.read(q, 0, row.size(), row.data());
    for (size_t r = 0; r < row.size(); ++r) {
      fuzz::require(row[r] <= given.units().largest);
      // Computed in two ways, a value between two steps may be rounded to either.
      const uint32_t plain = given.distance(q, r);
      fuzz::require(row[r] <= plain + 1 && plain <= row[r] + uint32_t{1});
    }
  }
  const MatrixQuery query = matrix_query(given, {});
  const FrameDistances distances =
      frame_distances(descriptor_spans(query.database), query.query.span());
  for (const size_t window_length : {1, 2}) match(given, distances, window_length);
}

}  // namespace

void fuzz::run(std::string_view input) {
  const std::filesystem::path path = memory_file(input);
  refuses([&] { read_matrix(path, {}); });
  refuses([&] { read_matrix(path, {true, true, 0}); });
}
