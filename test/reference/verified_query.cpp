#include "reference/verified_query.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>

#include <catch2/catch.hpp>

#include "base/parallel.h"
#include "match/score_kernels.h"
#include "query/run_query.h"
#include "reference/reference.h"
#include "reference/reference_past.h"
#include "reference/sampled_cells.h"

namespace vpr::test {
namespace {

/// The terms of sums: a value of training frame i of a sequence and query frame j.
using PairValue = std::function<double(size_t sequence, size_t i, size_t j)>;

double reference_sum(const PairValue& value, size_t window_length, const Cell& cell) {
  double sum = 0;
  for (size_t k = 0; k < window_length; ++k)
    sum += value(cell.sequence, cell.train_window + k, cell.query_window + k);
  return sum;
}

/// z of a training frame to all query frames that a cell needs, computed once.
class ReferenceScores {
 public:
  ReferenceScores(std::span<const DescribedFrames> train, const DescriptorRows& query,
                  const ReferenceUpdates& updates, const ScoreBasis& basis)
      : train_(train), query_(query), updates_(updates), basis_(basis) {}
  double operator()(size_t sequence, size_t i, size_t j) {
    auto& scores = known_[i];
    if (scores.empty()) {
      size_t frame = i;
      for (size_t s = 0; s < sequence; ++s) frame += train_[s].rows.size();
      scores = reference_frame_scores(train_[sequence].rows[i], frame, query_, updates_, basis_);
    }
    return scores[j];
  }

 private:
  std::span<const DescribedFrames> train_;
  DescriptorRows query_;
  const ReferenceUpdates& updates_;
  const ScoreBasis& basis_;
  std::map<size_t, std::vector<double>> known_;  // by training frame of the last sequence
};

// With a basis, of scores.
std::vector<Cell> wrong_sums(std::span<const Cell> cells, size_t window_length,
                             std::span<const DescribedFrames> train, const DescribedFrames& query,
                             const ScoreBasis* basis, const Monitor& monitor) {
  const ReferenceUpdates updates =
      basis != nullptr ? reference_updates(train, query, *basis, monitor) : ReferenceUpdates{};
  const auto distance = [&](size_t sequence, size_t i, size_t j) -> double {
    return reference_distance(train[sequence].rows, i, query.rows, j);
  };
  std::vector<double> right(cells.size());
  parallel_for(cells.size(), monitor, [&](size_t c) {
    if (basis == nullptr) {
      right[c] = reference_sum(distance, window_length, cells[c]);
      return;
    }
    const size_t known = cells[c].query_window + window_length;  // no score depends on later frames
    ReferenceScores scores(train, query.rows.first(known), updates, *basis);
    right[c] = reference_sum(std::ref(scores), window_length, cells[c]) * kScoreUnit +
               static_cast<double>(score_offset(window_length));
  });
  // Each score is rounded by less than one unit.
  const double tolerance = basis == nullptr ? 0 : static_cast<double>(window_length);
  std::vector<Cell> wrong;
  for (size_t c = 0; c < cells.size(); ++c) {
    if (std::abs(cells[c].score - right[c]) <= tolerance) continue;
    wrong.push_back(cells[c]);
    wrong.back().score = static_cast<uint32_t>(std::llround(right[c]));
  }
  return wrong;
}

std::vector<Cell> wrong_past_scores(std::span<const Cell> cells, const DescribedFrames& walk,
                                    std::span<const uint32_t> past, size_t window_length) {
  const ReferencePast shared = reference_past(walk, past, {});
  std::vector<Cell> wrong;
  for (const Cell& cell : cells) {
    double right = 0;
    for (size_t k = 0; k < window_length; ++k) {
      const size_t frame = cell.query_window + k;
      right += reference_past_scores(walk, past, shared, cell.train_window + k, frame)[frame];
    }
    const auto found = static_cast<double>(cell.score - score_offset(window_length));
    if (std::abs(found - right * kScoreUnit) > static_cast<double>(window_length))
      wrong.push_back(cell);
  }
  return wrong;
}

std::vector<Cell> find_wrong(std::span<const Cell> cells, const QueryPlan& plan) {
  const size_t length = plan.match.window_length;
  const bool has_scores = !plan.scores.rows.empty();
  if (has_scores && !plan.result.past.empty())
    return wrong_past_scores(cells, plan.query, plan.result.past, length);
  const ScoreBasis* basis = has_scores ? plan.scores.basis.get() : nullptr;
  return wrong_sums(cells, length, plan.train, plan.query, basis, {});
}

}  // namespace

QueryRun run_verified(const QueryPlan& plan, size_t cells, const Monitor& monitor) {
  const size_t length = plan.match.window_length;
  std::vector<Cell> chosen = choose_cells(searched_distances(plan), length, cells, plan.match.seed);
  if (plan.result.past.empty()) CHECK_FALSE(chosen.empty());
  std::erase_if(chosen, [&](const Cell& cell) {
    return !plan.result.past.empty() &&
           cell.train_window + length > plan.result.past[cell.query_window + length - 1];
  });
  CellScan scan(std::move(chosen));
  QueryRun run = run_query(plan, {{std::ref(scan)}}, monitor);
  CHECK(find_wrong(scan.result(), plan) == std::vector<Cell>{});
  return run;
}

}  // namespace vpr::test
