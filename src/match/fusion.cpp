#include "match/fusion.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <functional>
#include <limits>

#include "match/score_kernels.h"

namespace vpr {

namespace {

constexpr int32_t kMostBehind = 40 * kNatUnit;
constexpr int32_t kNothing = std::numeric_limits<int32_t>::min();
constexpr double kMostWeight = 1;
constexpr double kLargestScore = std::numeric_limits<uint16_t>::max();

size_t neighbors_of(size_t frames, const StatisticsSettings& settings) {
  return std::max(static_cast<size_t>(settings.neighbor_frames),
                  static_cast<size_t>(settings.neighbor_share * static_cast<double>(frames)));
}

// By matched training frame; kNothing for undecodable frames.
std::vector<int32_t> likelihoods_of(const FusionBasis& basis, const WordSet& words) {
  const std::vector<int32_t> of_views = view_likelihoods(*basis.evidence, words);
  std::vector<int32_t> likelihoods;
  likelihoods.reserve(basis.views.size());
  for (const uint32_t view : basis.views)
    likelihoods.push_back(view == FusedViews::kNoView ? kNothing : of_views[view]);
  return likelihoods;
}

// Excludes a training frame and its neighbors.
void leave_out(std::vector<int32_t>& likelihoods, const FusionBasis& basis, size_t own) {
  const std::vector<size_t>& frames = basis.evidence->of->frames;
  size_t sequence = 0;
  while (own >= frames[sequence]) own -= frames[sequence++];
  size_t first = 0;
  for (const FusedWalk& walk : basis.walks) {
    if (walk.sequence == sequence) {
      const size_t from = own < walk.neighbors ? 0 : own - walk.neighbors;
      const size_t to = std::min(own + walk.neighbors + 1, walk.frames);
      for (size_t i = from; i < to; ++i) likelihoods[first + i] = kNothing;
    }
    first += walk.frames;
  }
}

/// Statistics of the known likelihoods, in nats.
struct Spread {
  double mean = 0;
  double variance = 0;
};

Spread spread_of(std::span<const int32_t> behind) {
  int64_t sum = 0;
  uint64_t squares = 0;
  int64_t count = 0;
  for (const int32_t value : behind) {
    if (value == kNothing) continue;
    sum += value;
    squares += static_cast<uint64_t>(int64_t{value} * value);
    ++count;
  }
  const auto frames = static_cast<double>(count);
  const double mean = static_cast<double>(sum) / frames / kNatUnit;
  const double of_squares = static_cast<double>(squares) / frames / (double{kNatUnit} * kNatUnit);
  return {mean, std::max(0.0, of_squares - mean * mean)};
}

// The training frame of a frame's words.
std::optional<size_t> own_frame(const FusionBasis& basis, const WordSet& words) {
  const std::vector<WordSet>& trained = basis.evidence->of->words;
  const std::less<> before;
  if (before(&words, trained.data()) || !before(&words, trained.data() + trained.size()))
    return std::nullopt;
  return static_cast<size_t>(&words - trained.data());
}

struct FusedRows {
  FrameDistances scores;
  FusionBasis basis;
  std::shared_ptr<FusionState> state;
  FusionRow row;
};

void start_fused_row(FusedRows& rows, size_t query) {
  FusionState& state = *rows.state;
  rows.scores.start_row(query);
  const WordSet& words = rows.scores.query.words[query];
  const std::optional<size_t> own = own_frame(rows.basis, words);
  if (own) {
    rows.row = fusion_row(rows.basis, words, rows.basis.weight / 2, own);
    return;
  }
  state.agreement.count({state.likeliest, state.closest.frame()}, rows.basis.walks);
  rows.row = fusion_row(rows.basis, words, fusion_weight(rows.basis, state.agreement));
  state.likeliest = rows.row.likeliest;
  state.closest.reset();
}

void note_closest(FusedRows& rows, size_t first, std::span<const uint16_t> scores) {
  std::optional<size_t> closest;
  for (size_t i = 0; i < scores.size(); ++i) {
    const bool is_closer = !closest || scores[i] < scores[*closest];
    if (is_closer && rows.basis.views[first + i] != FusedViews::kNoView) closest = i;
  }
  if (closest) rows.state->closest.add(scores[*closest], first + *closest);
}

void fuse(const FusionRow& row, size_t first, std::span<uint16_t> scores) {
  if (!row.likeliest) return;
  for (size_t i = 0; i < scores.size(); ++i) {
    const double z =
        static_cast<double>(scores[i]) - kScoreBias + row.added[first + i] * kScoreUnit;
    const double score = z * row.scale + kScoreBias + 0.5;
    scores[i] = static_cast<uint16_t>(std::clamp(score, 0.0, kLargestScore));
  }
}

constexpr double kFirstFrames = 5;
constexpr double kFirstRatio = 0.6;
constexpr int kFrameBits = 40;

/// The position of a matched training frame.
struct Position {
  size_t walk = 0;
  size_t frame = 0;
};

Position position_of(size_t frame, std::span<const FusedWalk> walks) {
  Position position{0, frame};
  while (position.frame >= walks[position.walk].frames)
    position.frame -= walks[position.walk++].frames;
  return position;
}

bool are_near(size_t a, size_t b, std::span<const FusedWalk> walks) {
  const Position first = position_of(a, walks);
  return first.walk == position_of(b, walks).walk &&
         std::max(a, b) - std::min(a, b) <= walks[first.walk].neighbors;
}

// The probability that a random training frame is near this one.
double chance(size_t frame, std::span<const FusedWalk> walks) {
  size_t all = 0;
  for (const FusedWalk& walk : walks) all += walk.frames;
  const size_t near = 2 * walks[position_of(frame, walks).walk].neighbors + 1;
  return std::min(1.0, static_cast<double>(near) / static_cast<double>(all));
}

constexpr double kMostNats = 1e6;  // maximum that fits

int32_t in_units(double nats) {
  return static_cast<int32_t>(std::floor(std::clamp(nats, -kMostNats, kMostNats) * kNatUnit + 0.5));
}

}  // namespace

FusionBasis make_fusion_basis(std::shared_ptr<const FusedViews> views, double weight,
                              const StatisticsSettings& neighbors) {
  FusionBasis basis{nullptr, weight, views->views, {}};
  for (size_t s = 0; s < views->frames.size(); ++s)
    basis.walks.push_back({s, views->frames[s], neighbors_of(views->frames[s], neighbors)});
  basis.evidence = make_view_evidence(std::move(views));
  return basis;
}

FusionBasis fusion_of(const FusionBasis& all, const std::vector<uint8_t>& keep) {
  FusionBasis basis{all.evidence, all.weight, {}, {}};
  auto view = all.views.begin();
  for (const FusedWalk& walk : all.walks) {
    const auto end = view + static_cast<ptrdiff_t>(walk.frames);
    if (keep[walk.sequence] != 0) {
      basis.views.insert(basis.views.end(), view, end);
      basis.walks.push_back(walk);
    }
    view = end;
  }
  return basis;
}

FusionRow fusion_row(const FusionBasis& basis, const WordSet& words, double weight,
                     std::optional<size_t> own) {
  FusionRow row{std::vector<double>(basis.views.size(), 0), 1, std::nullopt};
  if (words.empty()) return row;
  std::vector<int32_t> behind = likelihoods_of(basis, words);
  if (own) leave_out(behind, basis, *own);
  const auto likeliest = std::max_element(behind.begin(), behind.end());
  if (likeliest == behind.end() || *likeliest == kNothing) return row;
  row.likeliest = static_cast<size_t>(likeliest - behind.begin());
  const int32_t most = *likeliest;
  for (int32_t& value : behind)
    if (value != kNothing) value = std::max(value - most, -kMostBehind);
  const Spread spread = spread_of(behind);
  for (size_t i = 0; i < behind.size(); ++i)
    if (behind[i] != kNothing)
      row.added[i] = weight * (spread.mean - static_cast<double>(behind[i]) / kNatUnit);
  row.scale = 1 / std::sqrt(1 + weight * weight * spread.variance);
  return row;
}

double fusion_weight(const FusionBasis& basis, const Agreement& agreement) {
  const double ratio = agreement.ratio();
  return std::min(basis.weight * ratio * std::sqrt(ratio), kMostWeight);
}

FrameDistances fused(FrameDistances scores, const FusionBasis& basis,
                     std::shared_ptr<FusionState> state) {
  if (basis.evidence == nullptr) return scores;
  assert(scores.is_in_order() && basis.views.size() == scores.train_frames);
  assert(scores.query.words.size() == scores.query_frames);
  if (!state) state = std::make_shared<FusionState>();
  const auto rows =
      std::make_shared<FusedRows>(FusedRows{scores, basis, std::move(state), FusionRow{}});
  scores.start_row = [rows](size_t query) { start_fused_row(*rows, query); };
  scores.tile = [rows](std::span<const uint32_t> queries, size_t first, size_t last, uint16_t* out,
                       size_t stride) {
    rows->scores.tile(queries, first, last, out, stride);
    note_closest(*rows, first, {out, last - first});
    fuse(rows->row, first, {out, last - first});
  };
  return scores;
}

void Agreement::count(const BestFrames& best, std::span<const FusedWalk> walks) {
  if (best.likeliest && best.closest) {
    if (last.likeliest && last.closest) {
      const double expected = chance(*last.likeliest, walks);
      likeliest_steps += are_near(*last.likeliest, *best.likeliest, walks) - expected;
      closest_steps += are_near(*last.closest, *best.closest, walks) - expected;
    }
    together += are_near(*best.likeliest, *best.closest, walks) - chance(*best.likeliest, walks);
  }
  last = best;
}

double Agreement::ratio() const {
  const double likeliest = std::max(0.0, (likeliest_steps + together) / 2);
  return (likeliest + kFirstFrames * kFirstRatio) / (std::max(0.0, closest_steps) + kFirstFrames);
}

void ClosestFrame::add(uint16_t score, size_t frame) {
  const uint64_t found = uint64_t{score} << kFrameBits | frame;
  uint64_t best = best_.load(std::memory_order_relaxed);
  while (found < best && !best_.compare_exchange_weak(best, found, std::memory_order_relaxed)) {
  }
}

std::optional<size_t> ClosestFrame::frame() const {
  const uint64_t best = best_.load(std::memory_order_relaxed);
  if (best == kNone) return std::nullopt;
  return static_cast<size_t>(best & ((uint64_t{1} << kFrameBits) - 1));
}

std::shared_ptr<const ViewEvidence> make_view_evidence(std::shared_ptr<const FusedViews> views) {
  const FabmapDatabase& database = views->fabmap;
  FabmapModel model = make_fabmap_model(database.tree, {}, WordModel::tree);
  FabmapIndex index = make_fabmap_index(model, database.views, database.index);
  return std::make_shared<const ViewEvidence>(
      ViewEvidence{std::move(views), std::move(model), std::move(index)});
}

std::vector<int32_t> view_likelihoods(const ViewEvidence& evidence, const WordSet& words) {
  const ViewWords& views = evidence.of->fabmap.views;
  const std::vector<double> nats =
      fabmap2_fixed_log_likelihoods({evidence.model, views, evidence.index, words, views.views()});
  std::vector<int32_t> likelihoods(nats.size());
  // The likelihood of the first view is arbitrary: a common constant cancels.
  std::transform(nats.begin(), nats.end(), likelihoods.begin(),
                 [&](double value) { return in_units(value - nats.front()); });
  return likelihoods;
}

}  // namespace vpr
