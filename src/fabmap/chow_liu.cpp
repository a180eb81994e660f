// Compiled once per SIMD target: see Highway's foreach_target.h.
#include "fabmap/chow_liu.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>
#include <tuple>

#include <fmt/format.h>

#include "base/error.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "fabmap/chow_liu.cpp"
#include <hwy/foreach_target.h>  // IWYU pragma: keep
#include <hwy/highway.h>

#ifndef VPR_CHOW_LIU_ONCE
#define VPR_CHOW_LIU_ONCE
namespace vpr {
namespace {

/// Words per block of WordColumns.
constexpr size_t kColumnLanes = 16;

/// Consecutive blocks of 16 words, so that all words are counted in one pass.
struct WordColumns {
  size_t chunks = 0;        ///< number of chunks of 64 frames
  size_t padded_words = 0;  ///< a multiple of 16; no frame shows the padding
  std::vector<uint64_t> bits;

  /// Bit f % 64 of bits[at(f / 64, q)] is set if frame f shows word q.
  size_t at(size_t chunk, size_t word) const {
    return (word / kColumnLanes * chunks + chunk) * kColumnLanes + word % kColumnLanes;
  }
};

}  // namespace
}  // namespace vpr
#endif

HWY_BEFORE_NAMESPACE();
namespace vpr {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

// out[v] is the number of frames that show both `word` and v, for every v below padded_words.
void CountBothWithAll(const WordColumns& columns, size_t word, uint32_t* out) {
  const hn::CappedTag<uint64_t, kColumnLanes / 2> d;
  const hn::Rebind<uint32_t, decltype(d)> d32;
  const size_t lanes = hn::Lanes(d);
  std::vector<uint64_t> own(columns.chunks);
  for (size_t chunk = 0; chunk < own.size(); ++chunk)
    own[chunk] = columns.bits[columns.at(chunk, word)];
  for (size_t v = 0; v < columns.padded_words; v += 2 * lanes) {
    auto first = hn::Zero(d);
    auto second = hn::Zero(d);
    const uint64_t* bits = columns.bits.data() + columns.at(0, v);
    for (size_t chunk = 0; chunk < own.size(); ++chunk, bits += kColumnLanes) {
      const auto mine = hn::Set(d, own[chunk]);
      first = hn::Add(first, hn::PopulationCount(hn::And(mine, hn::LoadU(d, bits))));
      second = hn::Add(second, hn::PopulationCount(hn::And(mine, hn::LoadU(d, bits + lanes))));
    }
    hn::StoreU(hn::TruncateTo(d32, first), d32, out + v);
    hn::StoreU(hn::TruncateTo(d32, second), d32, out + v + lanes);
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace vpr
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace vpr {

HWY_EXPORT(CountBothWithAll);

namespace {

constexpr double kScale = 0.98;
constexpr double kFloor = 0.01;

/// An edge between words a < b.
struct Edge {
  double information = 0;
  uint32_t a = 0;
  uint32_t b = 0;
  uint32_t both = 0;  ///< frames that show both words
};

bool better(const Edge& x, const Edge& y) {
  return std::tuple(-x.information, x.a, x.b) < std::tuple(-y.information, y.a, y.b);
}

double smoothed(size_t n, size_t of) {
  return kScale * (of == 0 ? 0 : static_cast<double>(n) / static_cast<double>(of)) + kFloor;
}

// The columns of frames, each with increasing word ids below `words`.
WordColumns make_word_columns(std::span<const WordSet> frames, size_t words) {
  WordColumns columns;
  columns.chunks = (frames.size() + 63) / 64;
  columns.padded_words = (words + kColumnLanes - 1) / kColumnLanes * kColumnLanes;
  columns.bits.assign(columns.chunks * columns.padded_words, 0);
  for (size_t f = 0; f < frames.size(); ++f)
    for (const uint32_t word : frames[f])
      columns.bits[columns.at(f / 64, word)] |= uint64_t{1} << f % 64;
  return columns;
}

// Orients the edges away from the root, the smaller word of the best edge.
ChowLiuTree orient(const std::vector<Edge>& edges, const std::vector<uint32_t>& counts,
                   size_t frames) {
  const size_t words = counts.size();
  ChowLiuTree tree;
  tree.parent.resize(words);
  std::vector<std::vector<const Edge*>> edges_of(words);
  for (const Edge& edge : edges)
    for (const uint32_t word : {edge.a, edge.b}) edges_of[word].push_back(&edge);
  const uint32_t root = edges.empty() ? 0 : std::min_element(edges.begin(), edges.end(), better)->a;
  tree.parent[root] = root;
  std::vector<uint32_t> both(words, 0);  // frames that show a word and its parent
  std::vector<uint32_t> open = {root};
  while (!open.empty()) {
    const uint32_t word = open.back();
    open.pop_back();
    for (const Edge* edge : edges_of[word]) {
      const uint32_t next = edge->a == word ? edge->b : edge->a;
      if (next == tree.parent[word]) continue;
      tree.parent[next] = word;
      both[next] = edge->both;
      open.push_back(next);
    }
  }
  for (size_t q = 0; q < words; ++q) {
    const uint32_t parent = tree.parent[q];
    tree.p.push_back(smoothed(counts[q], frames));
    tree.p_given.push_back(parent == q ? tree.p[q] : smoothed(both[q], counts[parent]));
    tree.p_given_not.push_back(
        parent == q ? tree.p[q] : smoothed(counts[q] - both[q], frames - counts[parent]));
  }
  return tree;
}

constexpr double kLeastProbability = 1e-300;

// Whether every word reaches a root, so that there are no cycles. Parents are valid words.
bool reach_roots(std::span<const uint32_t> parent) {
  std::vector<uint8_t> state(parent.size(), 0);  // 1: on the current path, 2: reaches a root
  for (uint32_t start = 0; start < parent.size(); ++start) {
    std::vector<uint32_t> way;
    uint32_t q = start;
    while (state[q] == 0 && parent[q] != q) {
      state[q] = 1;
      way.push_back(q);
      q = parent[q];
    }
    if (state[q] == 1) return false;
    state[q] = 2;
    for (const uint32_t passed : way) state[passed] = 2;
  }
  return true;
}

}  // namespace

MutualInformation::MutualInformation(size_t frames) : frames_(frames) {
  const auto n = static_cast<double>(frames);
  const auto log_p = [&](size_t count) {
    return std::log(kScale * static_cast<double>(count) / n + kFloor);
  };
  for (size_t count = 0; count <= frames; ++count) {
    const auto seen = static_cast<double>(count);
    x_log_x_.push_back(count == 0 ? 0 : seen / n * std::log(seen / n));
    marginal_.push_back((seen * log_p(count) + (n - seen) * log_p(frames - count)) / n);
  }
}

double MutualInformation::operator()(size_t n_a, size_t n_b, size_t n_ab) const {
  const double joint = (x_log_x_[n_ab] + x_log_x_[frames_ + n_ab - n_a - n_b]) +
                       (x_log_x_[n_a - n_ab] + x_log_x_[n_b - n_ab]);
  return joint - (marginal_[n_a] + marginal_[n_b]);
}

// Prim's algorithm: each word outside the tree keeps its best edge into the tree.
ChowLiuTree train_chow_liu(std::span<const WordSet> frames, size_t words, const Monitor& monitor) {
  assert(words > 0 && !frames.empty());
  std::vector<uint32_t> counts(words, 0);
  for (const WordSet& frame : frames)
    for (const uint32_t word : frame) ++counts[word];
  const WordColumns columns = make_word_columns(frames, words);
  const MutualInformation information(frames.size());
  std::vector<Edge> best(words, {-1e300, 0, 0, 0});
  std::vector<uint32_t> outside(words - 1);
  std::iota(outside.begin(), outside.end(), 1U);
  std::vector<uint32_t> both(columns.padded_words);
  std::vector<Edge> edges;
  StepCounter counter(monitor, "tree", words);
  size_t added = 0;
  while (!outside.empty()) {
    HWY_DYNAMIC_DISPATCH(CountBothWithAll)(columns, added, both.data());
    size_t next = 0;
    for (size_t i = 0; i < outside.size(); ++i) {
      const uint32_t v = outside[i];
      const double shared = information(counts[added], counts[v], both[v]);
      if (shared >= best[v].information) {
        const auto [a, b] = std::minmax({static_cast<uint32_t>(added), v});
        const Edge edge{shared, a, b, both[v]};
        if (better(edge, best[v])) best[v] = edge;
      }
      if (best[v].information >= best[outside[next]].information &&
          better(best[v], best[outside[next]]))
        next = i;
    }
    added = outside[next];
    edges.push_back(best[added]);
    outside[next] = outside.back();
    outside.pop_back();
    counter.add();
  }
  return orient(edges, counts, frames.size());
}

std::vector<double> tree_rows(const ChowLiuTree& tree) {
  std::vector<double> rows(tree.parent.begin(), tree.parent.end());
  for (const auto* row : {&tree.p, &tree.p_given, &tree.p_given_not})
    rows.insert(rows.end(), row->begin(), row->end());
  return rows;
}

ChowLiuTree tree_of_rows(std::span<const double> rows, const std::string& name) {
  assert(rows.size() % 4 == 0);
  const size_t words = rows.size() / 4;
  const auto fail = [&](const std::string& what) {
    throw Error(ErrorKind::data, "{}: {}", name, what);
  };
  ChowLiuTree tree;
  for (size_t q = 0; q < words; ++q) {
    if (!(rows[q] >= 0 && rows[q] < static_cast<double>(words)) || rows[q] != std::floor(rows[q]))
      fail(fmt::format("the parent of word {} is not a word", q));
    tree.parent.push_back(static_cast<uint32_t>(rows[q]));
    for (size_t row = 1; row < 4; ++row) {
      const double p = rows[row * words + q];
      if (!(p > kLeastProbability && p < 1))
        fail(fmt::format("a probability of word {} is not between {} and 1, but {}", q,
                         kLeastProbability, p));
    }
    tree.p.push_back(rows[words + q]);
    tree.p_given.push_back(rows[2 * words + q]);
    tree.p_given_not.push_back(rows[3 * words + q]);
  }
  if (!reach_roots(tree.parent)) fail("its words form a cycle, not a tree");
  return tree;
}

}  // namespace vpr

#endif  // HWY_ONCE
