#include "matching/fusion.h"

#include <algorithm>
#include <cassert>
#include <functional>
#include <limits>

#include "matching/view_evidence.h"

namespace vpr {
namespace {

constexpr int32_t kLeastLevel = -4 * kNatUnit;
constexpr int32_t kMostLevel = 6 * kNatUnit;
constexpr int32_t kUnsureLead = 2 * kNatUnit;
constexpr int32_t kMostLead = 10 * kNatUnit;
constexpr int32_t kNothing = std::numeric_limits<int32_t>::min();
constexpr int kLargestScore = std::numeric_limits<uint16_t>::max();

size_t neighbours_of(size_t frames, const StatisticsSettings& settings) {
  return std::max(static_cast<size_t>(settings.neighbour_frames),
                  static_cast<size_t>(settings.neighbour_share * static_cast<double>(frames)));
}

// By matched training frame; kNothing where it could not be decoded.
std::vector<int32_t> likelihoods_of(const FusionBasis& basis, const WordSet& words) {
  const std::vector<int32_t> of_views = view_likelihoods(*basis.evidence, words);
  std::vector<int32_t> likelihoods;
  likelihoods.reserve(basis.views.size());
  for (const uint32_t view : basis.views)
    likelihoods.push_back(view == FusedViews::kNoView ? kNothing : of_views[view]);
  return likelihoods;
}

// A training frame and its neighbours.
void leave_out(std::vector<int32_t>& likelihoods, const FusionBasis& basis, size_t own) {
  const std::vector<size_t>& frames = basis.evidence->of->frames;
  size_t sequence = 0;
  while (own >= frames[sequence]) own -= frames[sequence++];
  size_t first = 0;
  for (const FusedWalk& walk : basis.walks) {
    if (walk.sequence == sequence) {
      const size_t from = own < walk.neighbours ? 0 : own - walk.neighbours;
      const size_t to = std::min(own + walk.neighbours + 1, walk.frames);
      for (size_t i = from; i < to; ++i) likelihoods[first + i] = kNothing;
    }
    first += walk.frames;
  }
}

// Rounded to the nearest, a half up.
std::optional<int32_t> mean_of(std::span<const int32_t> likelihoods) {
  int64_t sum = 0;
  int64_t count = 0;
  for (const int32_t likelihood : likelihoods) {
    if (likelihood == kNothing) continue;
    sum += likelihood;
    ++count;
  }
  if (count == 0) return std::nullopt;
  const int64_t doubled = 2 * sum + count;
  const int64_t floor = doubled / (2 * count) - (doubled % (2 * count) < 0 ? 1 : 0);
  return static_cast<int32_t>(floor);
}

int32_t largest_of(std::span<const int32_t> values) {
  return values.empty() ? kNothing : *std::max_element(values.begin(), values.end());
}

bool share_place(const FusedViews& views, size_t a, size_t b) {
  return std::binary_search(views.shared_places.begin(), views.shared_places.end(),
                            std::pair(std::min(a, b), std::max(a, b)));
}

// The largest likelihood of walks that show another place than walk w.
int32_t largest_of_others(const FusionBasis& basis, std::span<const int32_t> largest, size_t w) {
  int32_t most = kNothing;
  for (size_t other = 0; other < largest.size(); ++other)
    if (other != w &&
        !share_place(*basis.evidence->of, basis.walks[w].sequence, basis.walks[other].sequence))
      most = std::max(most, largest[other]);
  return most;
}

// Per frame of a walk, the largest likelihood elsewhere: `others`, or of the walk's own frames more
// than `neighbours` before or behind.
std::vector<int32_t> elsewhere_of(std::span<const int32_t> walk, size_t neighbours,
                                  int32_t others) {
  std::vector<int32_t> elsewhere(walk.size(), others);
  int32_t before = kNothing;
  int32_t behind = kNothing;
  for (size_t i = neighbours + 1; i < walk.size(); ++i) {
    before = std::max(before, walk[i - neighbours - 1]);
    behind = std::max(behind, walk[walk.size() + neighbours - i]);
    elsewhere[i] = std::max(elsewhere[i], before);
    const size_t mirrored = walk.size() - 1 - i;
    elsewhere[mirrored] = std::max(elsewhere[mirrored], behind);
  }
  return elsewhere;
}

int32_t lead_of(int32_t likelihood, int32_t elsewhere) {
  if (elsewhere == kNothing) return 0;
  return std::clamp(likelihood - elsewhere - kUnsureLead, 0, kMostLead);
}

// Which training frame a frame's words are of.
std::optional<size_t> own_frame(const FusionBasis& basis, const WordSet& words) {
  const std::vector<WordSet>& trained = basis.evidence->of->words;
  const std::less<> before;
  if (before(&words, trained.data()) || !before(&words, trained.data() + trained.size()))
    return std::nullopt;
  return static_cast<size_t>(&words - trained.data());
}

}  // namespace

FusionBasis make_fusion_basis(std::shared_ptr<const FusedViews> views, double weight,
                              const StatisticsSettings& neighbours) {
  FusionBasis basis{nullptr, weight, views->views, {}};
  for (size_t s = 0; s < views->frames.size(); ++s)
    basis.walks.push_back({s, views->frames[s], neighbours_of(views->frames[s], neighbours)});
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

std::vector<int16_t> fusion_row(const FusionBasis& basis, const WordSet& words,
                                std::optional<size_t> own) {
  std::vector<int16_t> row(basis.views.size(), 0);
  if (words.empty()) return row;
  std::vector<int32_t> likelihoods = likelihoods_of(basis, words);
  if (own) leave_out(likelihoods, basis, *own);
  const std::optional<int32_t> mean = mean_of(likelihoods);
  if (!mean) return row;
  std::vector<std::span<const int32_t>> walks;
  std::vector<int32_t> largest;
  std::span<const int32_t> rest = likelihoods;
  for (const FusedWalk& walk : basis.walks) {
    walks.push_back(rest.first(walk.frames));
    largest.push_back(largest_of(walks.back()));
    rest = rest.subspan(walk.frames);
  }
  size_t frame = 0;
  for (size_t w = 0; w < walks.size(); ++w) {
    const std::vector<int32_t> elsewhere =
        elsewhere_of(walks[w], basis.walks[w].neighbours, largest_of_others(basis, largest, w));
    for (size_t i = 0; i < walks[w].size(); ++i, ++frame) {
      const int32_t likelihood = walks[w][i];
      if (likelihood == kNothing) continue;
      const int32_t level = std::clamp(likelihood - *mean, kLeastLevel, kMostLevel);
      const double taken = basis.weight / 2 * (level + 2 * lead_of(likelihood, elsewhere[i]));
      // Moved above 0, where casts round down.
      row[frame] = static_cast<int16_t>(static_cast<int32_t>(taken + 32768.5) - 32768);
    }
  }
  return row;
}

FrameDistances fused(FrameDistances scores, const FusionBasis& basis) {
  if (basis.evidence == nullptr) return scores;
  assert(scores.is_in_order() && basis.views.size() == scores.train_frames);
  assert(scores.query.words.size() == scores.query_frames);
  struct State {
    FrameDistances scores;
    FusionBasis basis;
    std::vector<int16_t> taken;
  };
  const auto state = std::make_shared<State>(State{scores, basis, {}});
  scores.start_row = [state](size_t query) {
    state->scores.start_row(query);
    const WordSet& words = state->scores.query.words[query];
    state->taken = fusion_row(state->basis, words, own_frame(state->basis, words));
  };
  scores.tile = [state](std::span<const uint32_t> queries, size_t first, size_t last, uint16_t* out,
                        size_t stride) {
    state->scores.tile(queries, first, last, out, stride);
    const int16_t* taken = state->taken.data() + first;
    for (size_t i = 0; i < last - first; ++i)
      out[i] = static_cast<uint16_t>(std::clamp(int{out[i]} - int{taken[i]}, 0, kLargestScore));
  };
  return scores;
}

}  // namespace vpr
