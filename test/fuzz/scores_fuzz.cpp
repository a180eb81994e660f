// Any bytes as an array, as a matrix of scores to evaluate, and as distances of frames for windows,
// whose values must agree with their units.
#include "evaluate/score_matrix.h"
#include "fuzz.h"
#include "loops/sequence_query.h"
#include "match/match.h"
#include "run/train_sequences.h"

using namespace vpr;

namespace {

constexpr size_t kMaxPairs = 20'000;

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

void match(const PrecomputedDistances& scores, const FrameDistances& distances,
           size_t window_length) {
  MatchSettings settings;
  settings.window_length = window_length;
  settings.memory_limit = size_t{1} << 24;
  const uint64_t most = uint64_t{scores.units().largest} * window_length;
  const auto check = [&](const ScoreRow& row) {
    for (const uint32_t sum : row.scores) fuzz::require(sum <= most);
  };
  vpr::match(distances, settings, {{check}}, {});
}

void read_distances(const std::filesystem::path& path, const ScoreFormat& format) {
  const PrecomputedDistances scores(ScoreFile(path, format), {});
  scores.fingerprint({});
  if (scores.queries() * scores.references() > kMaxPairs) return;
  std::vector<uint16_t> row(scores.references());
  for (size_t q = 0; q < scores.queries(); ++q) {
    scores.read(q, 0, row.size(), row.data());
    for (size_t r = 0; r < row.size(); ++r) {
      fuzz::require(row[r] <= scores.units().largest);
      // Computed in two ways, a value between two steps may be rounded to either.
      const uint32_t plain = scores.distance(q, r);
      fuzz::require(row[r] <= plain + 1 && plain <= row[r] + uint32_t{1});
    }
  }
  const QueryData query = matrix_query(scores, {});
  const FrameDistances distances =
      frame_distances(descriptor_spans(*query.database), query.query.span());
  for (const size_t window_length : {1, 2}) match(scores, distances, window_length);
}

}  // namespace

void fuzz::run(std::string_view input) {
  const std::filesystem::path path = memory_file(input);
  refuses([&] { read_array(path); });
  for (const ScoreFormat& format : {ScoreFormat{}, ScoreFormat{true, true, 0}}) {
    refuses([&] { read_rows(path, format); });
    refuses([&] { read_distances(path, format); });
  }
}
