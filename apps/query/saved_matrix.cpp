#include "saved_matrix.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/error.h"
#include "base/json.h"
#include "present/evaluation_charts.h"

namespace vpr {
namespace {

constexpr size_t kMatrixPictureSide = 2000;  // pixels

bool has_gaps(const QueryPlan& plan) {
  return !plan.query_sequence.unreadable.empty() || !plan.past.empty() ||
         std::any_of(plan.train.begin(), plan.train.end(),
                     [](const DescriptorSpan& sequence) { return !sequence.unreadable.empty(); });
}

}  // namespace

void claim_matrix(const QueryInputs& inputs, Outputs& outputs) {
  if (inputs.matrix.empty()) return;
  if (!inputs.matrix.ends_with(".npy") && !inputs.matrix.ends_with(".png"))
    throw Error(ErrorKind::usage,
                fmt::format("--save-matrix writes .npy or .png, found {}", inputs.matrix));
  outputs.claim_file(inputs.matrix);
}

std::vector<RowConsumer> start_matrix(SavedMatrix& saved, const std::string& path,
                                      const QueryPlan& plan, const Result& shape,
                                      const Session& session) {
  if (path.ends_with(".npy"))
    return {std::ref(
        saved.file.emplace(session.outputs.file(path), shape, has_gaps(plan), session.monitor))};
  if (path.ends_with(".png"))
    return {std::ref(saved.pixels.emplace(layout_of(shape), kMatrixPictureSide))};
  return {};
}

void finish_matrix(const SavedMatrix& saved, const std::string& path, const Result& result,
                   const std::optional<GroundTruth>& truth, ResultContext& context,
                   const Session& session) {
  if (saved.file) {
    context.matrix = matrix_layout_json(layout_of(result));
    context.files["matrix"] = saved.file->entry(session.monitor);
    context.checksums[path] = context.files["matrix"]["checksum"];
  }
  if (saved.pixels)
    session.outputs.file(path).write(chart_png(
        {result_matrix_chart(result, *saved.pixels, truth ? &*truth : nullptr, session.monitor)}));
}

}  // namespace vpr
