// Frames with two descriptors: fast distances equal the reference, and the code alone equals LDB.
#include <algorithm>
#include <memory>
#include <mutex>

#include <catch2/catch.hpp>

#include "base/random.h"
#include "match/components.h"
#include "match/distance_statistics.h"
#include "match/lsh.h"
#include "match/match.h"
#include "reference/reference.h"
#include "support.h"

using namespace vpr;

namespace {

/// Random rows, and their codes alone.
struct Frames {
  std::vector<uint8_t> bytes;
  std::vector<LdbCode> codes;

  explicit Frames(size_t count, uint64_t seed) {
    RandomEngine engine(seed);
    for (size_t i = 0; i < count; ++i) {
      LdbCode& code = codes.emplace_back();
      for (size_t bit = 0; bit < kLdbBits; ++bit)
        code[bit / 8] = static_cast<uint8_t>(code[bit / 8] | uniform_below(engine, 2) << bit % 8);
      bytes.insert(bytes.end(), code.begin(), code.end());
      for (size_t x = 0; x < kHogLength; ++x)
        bytes.push_back(static_cast<uint8_t>(uniform_below(engine, 128)));
    }
  }
  DescribedFrames both() const { return {{kLdbHogShape, bytes}, {}}; }
  DescribedFrames code() const { return {codes_of({kLdbHogShape, bytes}), {}}; }
  DescribedFrames ldb() const { return {codes, {}}; }
};

std::vector<uint16_t> row_of(const FrameDistances& distances, size_t query) {
  std::vector<uint16_t> row;
  compute_row(distances, query, row);
  row.resize(distances.train_frames);
  return row;
}

}  // namespace

TEST_CASE("the distance of two descriptors is the sum of theirs, by hand") {
  LdbHogRow a{};
  LdbHogRow b{};
  b[0] = 0b101;        // two bits
  a[kLdbBytes] = 100;  // the directions (1, 0, ...) and (3, 4, ...) / 5: 1 - cos = 0.4
  b[kLdbBytes] = 30;
  b[kLdbBytes + 1] = 40;
  std::vector<uint8_t> bytes(a.begin(), a.end());
  bytes.insert(bytes.end(), b.begin(), b.end());
  const DescriptorRows rows(kLdbHogShape, bytes);
  // 0.4 * 65535 / 2 = 13107; / 256 = 51.2
  CHECK(frame_distance(rows, 0, 1) == 2 + 51);
  CHECK(reference_distance(rows, 0, rows, 1) == 2 + 51);
  CHECK(frame_distance(codes_of(rows), 0, 1) == 2);
  CHECK(largest_distance(kLdbHogShape) == 1386 + 256);
  CHECK(largest_distance(codes_of(rows).shape) == 1386);
}

TEST_CASE("distances of two descriptors equal the reference for any number of frames") {
  for (const size_t count : {1, 7, 8, 9, 70}) {
    const Frames train(count, 1);
    const Frames query(3, 2);
    const std::vector<DescribedFrames> both{train.both()};
    const FrameDistances distances = frame_distances(both, query.both());
    for (size_t j = 0; j < 3; ++j) {
      const std::vector<uint16_t> row = row_of(distances, j);
      for (size_t i = 0; i < count; ++i)
        CHECK(row[i] == reference_distance(train.both().rows, i, query.both().rows, j));
    }
  }
}

TEST_CASE("the codes of rows with two descriptors have the distances of LDB") {
  const Frames train(70, 1);
  const Frames query(30, 2);
  const std::vector<DescribedFrames> by_part{train.code()};
  const std::vector<DescribedFrames> by_ldb{train.ldb()};
  const FrameDistances part = frame_distances(by_part, query.code());
  const FrameDistances ldb = frame_distances(by_ldb, query.ldb());
  CHECK(part.largest == ldb.largest);
  for (size_t j = 0; j < 30; ++j) {
    CHECK(row_of(part, j) == row_of(ldb, j));
    CHECK(part.row_total(j) == ldb.row_total(j));
  }
  const TrainStatistics a = compute_statistics(by_part, {}, {});
  const TrainStatistics b = compute_statistics(by_ldb, {}, {});
  CHECK(a.bias == b.bias);
  const TrainComponents found = compute_components(by_part, a.typical_distance, {});
  const TrainComponents expected = compute_components(by_ldb, b.typical_distance, {});
  CHECK(found.weights == expected.weights);
  CHECK(make_projector(found)(query.code().rows[0]) ==
        make_projector(expected)(query.ldb().rows[0]));
  std::vector<std::pair<size_t, uint32_t>> windows[2];
  MatchSettings settings;
  settings.window_length = 2;
  const auto collect = [](auto& found_windows) {
    return [&found_windows, mutex = std::make_shared<std::mutex>()](const ScoreRow& row) {
      const std::lock_guard lock(*mutex);
      found_windows.emplace_back(row.query_window * 1000 + row.train_window, row.scores[0]);
    };
  };
  match_lsh(part, settings, {}, collect(windows[0]));
  match_lsh(ldb, settings, {}, collect(windows[1]));
  std::ranges::sort(windows[0]);
  std::ranges::sort(windows[1]);
  CHECK(windows[0] == windows[1]);
}
