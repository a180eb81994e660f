// Pictures of an evaluation: --html and --plot of vpr-eval.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/json_fwd.h"
#include "common/command.h"
#include "pipeline/evaluate.h"

namespace vpr {

struct PictureInputs {
  std::string html;
  std::string plots;
  std::optional<std::string> query;  ///< a sequence, or a query's name in the data set
  std::vector<std::string> train;
};

void add_picture_options(const Command& app, PictureInputs& inputs);

/// Whether pictures of an evaluation are to be written.
bool wants_pictures(const PictureInputs& inputs);

/// Throws as the checks of outputs do. Call it before long work.
void check_picture_outputs(const Session& session, const PictureInputs& inputs);

/// Writes what was asked for. `dataset`: its path, or empty. `report`: of the evaluation; the page
/// opens with the sentence `summary`. Throws Error(usage) if sequences do not have as many frames
/// as the evaluation.
void write_pictures(Session& session, const PictureInputs& inputs, const std::string& dataset,
                    const Evaluation& evaluation, const Json& report, const std::string& summary);

}  // namespace vpr
