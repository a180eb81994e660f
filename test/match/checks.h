// Checks that hold for every kind of descriptor, and the cells of a match.
#pragma once

#include <algorithm>
#include <cmath>
#include <mutex>
#include <span>
#include <vector>

#include <catch2/catch.hpp>

#include "examples.h"
#include "match/components.h"
#include "match/distance_statistics.h"
#include "match/match.h"
#include "match/zscores.h"
#include "reference/reference.h"
#include "support.h"

namespace vpr::test {

/// Adds the cells of all rows, each of which must arrive once.
inline RowConsumer collecting(Cells& cells, std::mutex& mutex) {
  return [&](const ScoreRow& row) {
    const std::lock_guard lock(mutex);
    const size_t before = cells.size();
    for (size_t x = 0; x < row.scores.size(); ++x)
      cells.emplace(CellKey{row.query_window, row.sequence, row.train_window + x}, row.scores[x]);
    REQUIRE(cells.size() == before + row.scores.size());
  };
}

inline Cells cells_of(const FrameDistances& distances, const MatchSettings& settings) {
  Cells cells;
  std::mutex mutex;
  match(distances, settings, {{collecting(cells, mutex)}}, {});
  return cells;
}

/// The cells of large sets as a matrix: query windows x train windows, one sequence after the
/// other; kNoCell where no cell arrives. Each cell must arrive once.
inline std::vector<uint32_t> matrix_of(const FrameDistances& distances,
                                       const MatchSettings& settings, size_t query_windows,
                                       const std::vector<size_t>& train_windows) {
  std::vector<size_t> columns = {0};  // the first one of each sequence, then their number
  for (const size_t windows : train_windows) columns.push_back(columns.back() + windows);
  std::vector<uint32_t> matrix(query_windows * columns.back(), kNoCell);
  std::mutex mutex;
  const auto collect = [&](const ScoreRow& row) {
    const std::lock_guard lock(mutex);
    const size_t column = columns[row.sequence] + row.train_window;
    REQUIRE(row.query_window < query_windows);
    REQUIRE(column + row.scores.size() <= columns[row.sequence + 1]);
    const auto cells =
        std::span(matrix).subspan(row.query_window * columns.back() + column, row.scores.size());
    REQUIRE(std::ranges::all_of(cells, [](uint32_t score) { return score == kNoCell; }));
    std::ranges::copy(row.scores, cells.begin());
  };
  match(distances, settings, {{collect}}, {});
  return matrix;
}

inline MatchSettings by_method(const SequenceMethod& method, size_t length,
                               size_t memory = size_t{1} << 30) {
  MatchSettings settings{length, memory};
  settings.method = &method;
  return settings;
}

inline std::vector<DescriptorRow> rows_of(std::span<const DescribedFrames> train) {
  std::vector<DescriptorRow> rows;
  for (const DescribedFrames& sequence : train)
    for (size_t i = 0; i < sequence.rows.size(); ++i) rows.push_back(sequence.rows[i]);
  return rows;
}

/// On every SIMD target, tiles in any range and order, and single pairs, equal the reference
/// implementation. At least four query frames, and more than eight training frames.
inline void check_distances(std::span<const DescribedFrames> train, const DescribedFrames& query,
                            uint32_t largest) {
  const ElementType type = query.rows.shape.element;
  const std::vector<DescriptorRow> rows = rows_of(train);
  const auto last = static_cast<uint32_t>(query.rows.size() - 1);
  const std::vector<uint32_t> order = {last, 0, 1, 3, last, last, 2};
  const size_t stride = rows.size() + kBlockFrames;
  for (const std::string& target : simd_targets()) {
    const ChosenTarget chosen(target);
    const FrameDistances distances = frame_distances(train, query);
    CHECK(distances.largest == largest);
    std::vector<uint16_t> tile(order.size() * stride, 7);
    distances.tile(order, 8, rows.size(), tile.data(), stride);
    for (size_t t = 0; t < order.size(); ++t)
      for (size_t i = 8; i < rows.size(); ++i) {
        const DescriptorRow other = query.rows[order[t]];
        INFO(target << ", rows of " << other.size() << " bytes, frame " << i);
        const uint32_t expected = reference_distance(type, rows[i], other);
        REQUIRE(tile[t * stride + i - 8] == expected);
        REQUIRE(distance_of(type).pair(rows[i], other) == expected);
        REQUIRE(distance_of(type).pair(other, rows[i]) == expected);
      }
  }
}

/// Mean distances of rows equal those of single pairs up to rounding.
inline void check_means(const DescribedFrames& train, const DescribedFrames& query) {
  const FrameDistances distances = frame_distances({&train, 1}, query);
  const size_t readable = train.rows.size() - train.unreadable.size();
  CHECK(distances.readable_frames == readable);
  for (size_t j = 0; j < query.rows.size(); ++j) {
    double sum = 0;
    for (size_t i = 0; i < train.rows.size(); ++i)
      if (!std::ranges::binary_search(train.unreadable, i))
        sum += reference_distance(train.rows, i, query.rows, j);
    CHECK(row_mean(distances, j) == Approx(sum / static_cast<double>(readable)).margin(0.5));
  }
}

/// Windows of z-scores equal the reference implementation.
inline void check_zscores(const DescribedFrames& train, const DescribedFrames& query,
                          size_t length) {
  TrainStatistics statistics = compute_statistics({&train, 1}, {}, {});
  statistics.components = compute_components({&train, 1}, statistics.typical_distance, {});
  const ScoreBasis basis = make_score_basis(statistics);
  const Cells cells =
      cells_of(zscores(frame_distances({&train, 1}, query), basis), {length, size_t{1} << 30});
  CHECK(cells.size() == (train.rows.size() - length + 1) * (query.rows.size() - length + 1));
  const ReferenceUpdates updates = reference_updates({&train, 1}, query, basis, {});
  std::vector<std::vector<double>> plain;
  for (size_t i = 0; i < train.rows.size(); ++i)
    plain.push_back(reference_frame_scores(train.rows[i], i, query.rows, updates, basis));
  for (const auto& [cell, biased] : cells) {
    const auto& [j, s, i] = cell;
    double expected = 0;
    for (size_t k = 0; k < length; ++k) expected += plain[i + k][j + k];
    const double found =
        (static_cast<double>(biased) - static_cast<double>(length) * kScoreBias) / kScoreUnit;
    REQUIRE(std::abs(found - expected) <= score_tolerance(length));
  }
}

}  // namespace vpr::test
