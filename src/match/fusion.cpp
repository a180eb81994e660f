#include "match/fusion.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "match/score_kernels.h"

namespace vpr {

namespace {

constexpr int32_t kNatUnit = 1024;           // integers per nat
constexpr int32_t kMostGap = 40 * kNatUnit;  // below the likeliest view
constexpr double kMostNats = 1e6;            // maximum that fits
constexpr int32_t kNothing = std::numeric_limits<int32_t>::min();
constexpr double kLargestScore = std::numeric_limits<uint16_t>::max();
constexpr double kPriorFrames = 5;
constexpr double kPriorRatio = 0.6;

// By matched training frame; kNothing for undecodable frames. The likelihood of the first view is
// subtracted, because a common constant cancels.
std::vector<int32_t> likelihoods_of(const FusionBasis& basis, const WordSet& words) {
  const ViewEvidence& evidence = *basis.evidence;
  const ViewWords& views = evidence.of->fabmap.views;
  const std::vector<double> nats =
      fabmap2_fixed_log_likelihoods({evidence.model, views, evidence.index, words, views.views()});
  std::vector<int32_t> likelihoods;
  likelihoods.reserve(basis.views.size());
  for (const uint32_t view : basis.views) {
    if (view == FusedViews::kNoView) {
      likelihoods.push_back(kNothing);
      continue;
    }
    const double value = std::clamp(nats[view] - nats.front(), -kMostNats, kMostNats);
    likelihoods.push_back(static_cast<int32_t>(std::floor(value * kNatUnit + 0.5)));
  }
  return likelihoods;
}

struct FusedRows {
  FrameDistances scores;
  std::shared_ptr<const FusionBasis> basis;
  std::shared_ptr<FusionState> state;
  std::vector<uint16_t> row;
};

// The first frame with the smallest score.
std::optional<size_t> closest_frame(const FusedRows& rows) {
  std::optional<size_t> closest;
  const std::vector<uint32_t>& views = rows.basis->views;
  for (size_t i = 0; i < views.size(); ++i)
    if ((!closest || rows.row[i] < rows.row[*closest]) && views[i] != FusedViews::kNoView)
      closest = i;
  return closest;
}

void compute_fused_row(FusedRows& rows, size_t query) {
  rows.scores.start_row(query);
  compute_row(rows.scores, query, rows.row);
  const WordSet& words = rows.scores.query.words[query];
  const FusionRow fusion = fusion_row(*rows.basis, words, fusion_weight(*rows.basis, *rows.state));
  rows.state->count({fusion.likeliest, closest_frame(rows)}, rows.basis->sequences);
  if (!fusion.likeliest) return;
  for_each_chunk(fusion.added.size(), [&](size_t first, size_t last) {
    for (size_t i = first; i < last; ++i) {
      const double z = static_cast<double>(rows.row[i]) - kScoreBias + fusion.added[i] * kScoreUnit;
      const double score = z * fusion.scale + kScoreBias + 0.5;
      rows.row[i] = static_cast<uint16_t>(std::clamp(score, 0.0, kLargestScore));
    }
  });
}

/// The position of a matched training frame.
struct Position {
  size_t sequence = 0;
  size_t frame = 0;
};

Position position_of(size_t frame, std::span<const FusedSequence> sequences) {
  Position position{0, frame};
  while (position.frame >= sequences[position.sequence].frames)
    position.frame -= sequences[position.sequence++].frames;
  return position;
}

bool are_near(size_t a, size_t b, std::span<const FusedSequence> sequences) {
  const Position first = position_of(a, sequences);
  return first.sequence == position_of(b, sequences).sequence &&
         std::max(a, b) - std::min(a, b) <= sequences[first.sequence].neighbors;
}

// The probability that a random training frame is near this one.
double chance(size_t frame, std::span<const FusedSequence> sequences) {
  size_t all = 0;
  for (const FusedSequence& sequence : sequences) all += sequence.frames;
  const size_t near = 2 * sequences[position_of(frame, sequences).sequence].neighbors + 1;
  return std::min(1.0, static_cast<double>(near) / static_cast<double>(all));
}

}  // namespace

FusionBasis make_fusion_basis(std::shared_ptr<const FusedViews> views, double weight,
                              const StatisticsSettings& neighbors) {
  FusionBasis basis{nullptr, weight, views->views, {}};
  for (const size_t frames : views->frames) {
    const auto share = static_cast<size_t>(neighbors.neighbor_share * static_cast<double>(frames));
    basis.sequences.push_back({frames, std::max<size_t>(neighbors.neighbor_frames, share)});
  }
  const FabmapDatabase& database = views->fabmap;
  FabmapModel model = make_fabmap_model(database.tree, {}, WordModel::tree);
  FabmapIndex index = make_fabmap_index(model, database.views, database.index);
  basis.evidence = std::make_shared<const ViewEvidence>(
      ViewEvidence{std::move(views), std::move(model), std::move(index)});
  return basis;
}

FusionRow fusion_row(const FusionBasis& basis, const WordSet& words, double weight) {
  FusionRow row{std::vector<double>(basis.views.size(), 0), 1, std::nullopt};
  if (words.empty()) return row;
  std::vector<int32_t> likelihoods = likelihoods_of(basis, words);
  const auto likeliest = std::ranges::max_element(likelihoods);
  if (likeliest == likelihoods.end() || *likeliest == kNothing) return row;
  row.likeliest = static_cast<size_t>(likeliest - likelihoods.begin());
  const int32_t most = *likeliest;
  int64_t sum = 0;
  uint64_t squares = 0;
  int64_t count = 0;
  for (int32_t& value : likelihoods) {
    if (value == kNothing) continue;
    value = std::max(value - most, -kMostGap);
    sum += value;
    squares += static_cast<uint64_t>(int64_t{value} * value);
    ++count;
  }
  const auto frames = static_cast<double>(count);
  const double mean = static_cast<double>(sum) / frames / kNatUnit;
  const double mean_square = static_cast<double>(squares) / frames / (double{kNatUnit} * kNatUnit);
  for (size_t i = 0; i < likelihoods.size(); ++i)
    if (likelihoods[i] != kNothing)
      row.added[i] = weight * (mean - static_cast<double>(likelihoods[i]) / kNatUnit);
  row.scale = 1 / std::sqrt(1 + weight * weight * std::max(0.0, mean_square - mean * mean));
  return row;
}

double fusion_weight(const FusionBasis& basis, const FusionState& state) {
  const double ratio = state.ratio();
  return std::min(basis.weight * ratio * std::sqrt(ratio), kMostFusionWeight);
}

FrameDistances fused(FrameDistances scores, std::shared_ptr<const FusionBasis> basis,
                     std::shared_ptr<FusionState> state) {
  assert(scores.is_in_order() && basis->views.size() == scores.train_frames);
  assert(scores.query.words.size() == scores.query_frames);
  const auto rows =
      std::make_shared<FusedRows>(FusedRows{scores, std::move(basis), std::move(state), {}});
  scores.start_row = [rows](size_t query) { compute_fused_row(*rows, query); };
  scores.tile = [rows](std::span<const uint32_t>, size_t first, size_t last, uint16_t* out,
                       size_t) {
    std::copy(rows->row.data() + first, rows->row.data() + last, out);
  };
  return scores;
}

void FusionState::count(const BestFrames& best, std::span<const FusedSequence> sequences) {
  if (best.likeliest && best.closest) {
    if (last.likeliest && last.closest) {
      const double expected = chance(*last.likeliest, sequences);
      likeliest_steps += are_near(*last.likeliest, *best.likeliest, sequences) - expected;
      closest_steps += are_near(*last.closest, *best.closest, sequences) - expected;
    }
    together +=
        are_near(*best.likeliest, *best.closest, sequences) - chance(*best.likeliest, sequences);
  }
  last = best;
}

double FusionState::ratio() const {
  const double likeliest = std::max(0.0, (likeliest_steps + together) / 2);
  return (likeliest + kPriorFrames * kPriorRatio) / (std::max(0.0, closest_steps) + kPriorFrames);
}

}  // namespace vpr
