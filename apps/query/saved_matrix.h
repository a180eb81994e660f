// vpr-query --save-matrix: the scores of all windows as a file or a picture.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "present/score_matrix.h"
#include "query_inputs.h"
#include "run/plan.h"
#include "truth/ground_truth.h"

namespace vpr {

/// What is made of the rows that pass.
struct SavedMatrix {
  std::optional<MatrixFile> file;
  std::optional<RowPixels> pixels;
};

/// Claims the file, if one is asked for. Throws Error(usage) for another ending than .npy or .png.
void claim_matrix(const QueryInputs& inputs, Outputs& outputs);

/// What takes the rows of a query; nothing without a path. `shape`: the result, of which nothing is
/// found yet.
std::vector<RowConsumer> start_matrix(SavedMatrix& saved, const std::string& path,
                                      const QueryPlan& plan, const Result& shape,
                                      const Session& session);

/// Writes the picture, or what the result says of the file.
void finish_matrix(const SavedMatrix& saved, const std::string& path, const Result& result,
                   const std::optional<GroundTruth>& truth, ResultContext& context,
                   const Session& session);

}  // namespace vpr
