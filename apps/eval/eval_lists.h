// Lists of other programs: --predictions, and --pairs of vpr-eval.
#pragma once

#include <optional>
#include <string>

#include "common/command.h"
#include "evaluation/score_layout.h"

namespace vpr {

struct EvalInputs;
struct JudgedBy;

struct PairInputs {
  std::string path;              ///< empty: not asked for
  std::optional<uint64_t> most;  ///< K of --top-k

  bool any() const { return most || !path.empty(); }
};

void add_list_options(const Command& app, EvalInputs& inputs);

/// Throws Error(usage) for flags that do not go together; claims the output. Call it before long
/// work.
void check_lists(const Session& session, const EvalInputs& inputs);

/// Frames of --query or of the data set's query; none where neither is given, or it is not a
/// sequence of images. Throws as open_sequence does.
std::optional<size_t> query_frames(const EvalInputs& inputs);

/// How a ground truth may name frames: as --query and --train do, or the data set, whose query is
/// the one of this name. It is looked for when a name is needed.
void add_names(JudgedBy& by, const EvalInputs& inputs,
               const std::optional<std::string>& query_name);

/// The scores of --predictions. Throws as prediction_scores does.
ScoreMatrix open_predictions(const EvalInputs& inputs);

/// Writes --pairs, if it is asked for: of the matrix, or of a result without one. Returns how many.
size_t write_pairs(const Session& session, const EvalInputs& inputs, const ScoreMatrix* matrix,
                   const ScoreLayout& layout, const Result* result);

/// Whether pairs are all that is asked for: there is no ground truth to judge by.
bool only_lists(const EvalInputs& inputs);

/// Writes them, and says so.
void run_lists(Session& session, const EvalInputs& inputs);

}  // namespace vpr
