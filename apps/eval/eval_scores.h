// Score matrices on the command line of vpr-eval.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/command.h"
#include "common/score_flags.h"
#include "descriptors/imported.h"
#include "pipeline/evaluate.h"

namespace vpr {

struct ScoreInputs {
  ScoreFlags matrix;
  std::string query_npy;      ///< descriptors that scores are computed of; empty: none
  std::string reference_npy;  ///< of the references
  DescriptorMetric metric = DescriptorMetric::cosine;
  std::string predictions;  ///< lists of what a program found; empty: none
  std::vector<uint64_t> recall_at;
  uint64_t stretch_frames = kRouteStretch;  ///< of the recall achievement rate
  std::optional<double> threshold;
  uint64_t window_length = 1;            ///< frames per row of --scores
  std::string warp;                      ///< how the query was replayed; empty: it was not
  std::optional<uint64_t> query_frames;  ///< of the query, before --warp
  std::string name;                      ///< for tables; empty: the file's, or the method
  std::string poses;                     ///< of the query, for metres

  /// Whether there are scores, read or computed.
  bool any() const { return !source().empty(); }
  /// Where they come from.
  const std::string& source() const {
    if (!matrix.path.empty()) return matrix.path;
    return query_npy.empty() ? predictions : query_npy;
  }
};

void add_score_options(const Command& app, ScoreInputs& inputs);

/// What the metrics are, for --help.
std::string metrics_help();

/// Throws Error(usage) for flags that need --scores, or that a result answers already.
void check_score_inputs(const ScoreInputs& inputs, bool has_result);

/// The matrix of --scores alone, or of descriptors. Throws Error(usage) unless its kind is known.
ScoreMatrix open_scores(const ScoreInputs& inputs);

/// The matrix that was saved with a result; `missing` stands where it has no score.
ScoreMatrix open_saved_scores(const ScoreInputs& inputs, double missing);

/// Throws Error(data) if `rows` windows do not have the frames that --query-frames or
/// `query_frames` states, or, where neither is known, if a window is longer than the matrix.
void check_rows(const ScoreInputs& inputs, size_t rows, std::optional<size_t> query_frames);

/// K of recall@K, rising, 1 among them; none where the flag was not given. Throws Error(usage) for
/// a K out of range.
std::vector<size_t> recall_at_of(const ScoreInputs& inputs);

/// Throws Error(usage) for a --stretch out of range.
size_t stretch_of(const ScoreInputs& inputs);

/// What a report says of --scores alone. `seed`: of a replay. Throws what replay throws.
ScoreSettings settings_of(const ScoreInputs& inputs, uint64_t seed);

/// Warns where the scores find more places in the other order: --distance instead of --similarity.
void warn_reversed(const Monitor& monitor, const ScoreInputs& inputs, const Judgement& judgement);

/// Warns where the best score of all may be what vpr-query writes where there is none.
void warn_negative(const Monitor& monitor, const ScoreInputs& inputs, const Judgement& judgement);

}  // namespace vpr
