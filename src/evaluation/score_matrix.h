// A query x reference matrix of scores, in a .npy file of any program or computed row by row; never
// whole in memory.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>

#include "base/monitor.h"
#include "matching/score_file.h"
#include "recognition/score_order.h"

namespace vpr {

/// Scores that are computed when they are asked for.
struct ComputedScores {
  size_t queries = 0;
  size_t references = 0;
  size_t block = 1;  ///< queries that are computed together, at most
  ScoreOrder kind = ScoreOrder::distance;
  /// Writes the scores of queries [first, first + count) to all references, row by row; NaN where
  /// there is none. May be called from several threads at once.
  std::function<void(size_t first, size_t count, std::span<double> scores)> compute;
  std::function<std::string(const Monitor& monitor)> fingerprint;  ///< of what they are made of
};

/// A file of scores, or computed ones. NaN is not a score.
class ScoreMatrix {
 public:
  /// Throws as ScoreFile does.
  ScoreMatrix(const std::filesystem::path& path, const ScoreFormat& format);

  explicit ScoreMatrix(ComputedScores computed);

  size_t queries() const { return queries_; }
  size_t references() const { return references_; }
  ScoreOrder kind() const { return kind_; }

  /// Keys (score_key) of all references of one query; they live while the call lasts.
  using RowBody = std::function<void(size_t worker, size_t query, std::span<const uint64_t> keys)>;
  /// Calls body once for every query, in any order. `workers` (at least 1) calls may run at once,
  /// each with its own number below `workers`. Throws Error(data) for 64-bit integers beyond 2^53,
  /// which would not be told apart.
  void for_each_row(size_t workers, const Monitor& monitor, const std::string& step,
                    const RowBody& body) const;

  /// Of the whole file, or of what scores are computed of, as provenance has it.
  std::string fingerprint(const Monitor& monitor) const;

 private:
  void compute_block(size_t first, size_t count, std::span<uint64_t> keys) const;
  void read_block(size_t first, size_t count, std::span<uint64_t> keys) const;

  std::optional<ScoreFile> file_;  ///< none: computed
  ComputedScores computed_;
  ScoreOrder kind_ = ScoreOrder::distance;
  size_t queries_ = 0;
  size_t references_ = 0;
};

}  // namespace vpr
