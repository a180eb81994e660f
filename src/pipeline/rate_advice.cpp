#include "pipeline/rate_advice.h"

#include <algorithm>

#include <fmt/format.h>

#include "matching/methods.h"

namespace vpr {
namespace {

constexpr double kAlike = 1.1;

bool is_searched(const SequenceQuerySettings& settings, const std::string& name) {
  const auto& only = settings.only_sequences;
  return only.empty() || std::ranges::find(only, name) != only.end();
}

}  // namespace

void warn_of_rates(const SequenceDatabase& database, std::optional<double> query_fps,
                   const SequenceQuerySettings& settings, const Monitor& monitor) {
  const bool has_windows = settings.window_length > 1 && settings.rates.empty();
  if (!query_fps || !has_windows || has_paths(settings.method)) return;
  for (const TrainSequence& sequence : database.sequences) {
    if (!sequence.fps || !is_searched(settings, sequence.name)) continue;
    const auto [slow, fast] = std::minmax(*sequence.fps, *query_fps);
    if (fast <= kAlike * slow) continue;
    warn(monitor,
         fmt::format("the query has {:.3g} frames a second and the training sequence {} has "
                     "{:.3g}, so that windows of both last differently: give {} --fps {:.3g}, or "
                     "use --method filter, which finds the rate",
                     *query_fps, sequence.name, *sequence.fps,
                     slow == *query_fps ? "vpr-train" : "the query", slow));
    return;
  }
}

}  // namespace vpr
