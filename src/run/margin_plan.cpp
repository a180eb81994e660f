#include "run/margin_plan.h"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "decide/automatic_margin.h"
#include "decide/automatic_threshold.h"
#include "decide/elsewhere.h"
#include "decide/shared_places.h"
#include "run/score_basis.h"
#include "run/train.h"

namespace vpr {
namespace {

using SharedPlaces = std::vector<std::pair<size_t, size_t>>;

constexpr std::string_view kAllDiffer = "none";

std::vector<uint32_t> widths_of(const SequenceDatabase& database,
                                const std::optional<uint64_t>& width, const Monitor& monitor) {
  const std::vector<DescriptorSpan> spans = descriptor_spans(database);
  std::vector<uint32_t> widths;
  for (size_t s = 0; s < spans.size(); ++s) {
    const auto& stored = database.sequences[s].half_width;
    const size_t chosen = width ? *width : stored ? *stored : half_width(spans[s], monitor);
    // Nothing is farther away than all of its frames.
    widths.push_back(static_cast<uint32_t>(std::min(chosen, spans[s].rows.size())));
  }
  return widths;
}

SharedPlaces found_places(const SequenceDatabase& database, const RowKernels& kernels,
                          const Monitor& monitor) {
  if (database.shared_places) return *database.shared_places;
  return find_shared_places(descriptor_spans(database), widths_of(database, std::nullopt, monitor),
                            kernels, monitor);
}

std::pair<size_t, size_t> pair_of(const std::string& text,
                                  const std::vector<TrainSequence>& sequences) {
  const auto index_of = [&](std::string_view name) {
    const auto found =
        std::find_if(sequences.begin(), sequences.end(),
                     [&](const TrainSequence& s) { return s.sequence.name == name; });
    return static_cast<size_t>(found - sequences.begin());
  };
  // Names may hold "=".
  for (size_t at = text.find('='); at != std::string::npos; at = text.find('=', at + 1)) {
    const size_t a = index_of(std::string_view(text).substr(0, at));
    const size_t b = index_of(std::string_view(text).substr(at + 1));
    if (a < sequences.size() && b < sequences.size() && a != b) return std::minmax(a, b);
  }
  std::vector<std::string> names;
  for (const TrainSequence& train : sequences) names.push_back(train.sequence.name);
  throw Error(ErrorKind::usage,
              fmt::format("same_place \"{}\" is no pair of training sequences, as in A=B, nor {}; "
                          "the database has {}",
                          text, kAllDiffer, fmt::join(names, ", ")));
}

SharedPlaces declared_places(const SequenceDatabase& database,
                             const std::vector<std::string>& same_place) {
  SharedPlaces pairs;
  if (same_place.size() == 1 && same_place.front() == kAllDiffer) return pairs;
  for (const std::string& text : same_place) pairs.push_back(pair_of(text, database.sequences));
  return pairs;
}

// What no best match is by chance that much better than elsewhere.
std::vector<uint32_t> margins_of(const QueryPlan& plan, const QueryResources& resources,
                                 const Monitor& monitor) {
  const std::optional<ScoreBasis> basis = score_basis(plan.learned, plan.settings);
  const MatchSettings match{plan.settings.window_length, resources.memory_limit, resources.kernels};
  return false_margins(plan.train, *plan.elsewhere, basis ? &*basis : nullptr, match, monitor);
}

}  // namespace

void add_half_widths(SequenceDatabase& database, const Monitor& monitor) {
  const std::vector<DescriptorSpan> spans = descriptor_spans(database);
  for (size_t s = 0; s < spans.size(); ++s)
    if (!database.sequences[s].half_width)
      database.sequences[s].half_width = half_width(spans[s], monitor);
}

void add_shared_places(SequenceDatabase& database, const RowKernels& kernels,
                       const Monitor& monitor) {
  database.shared_places = found_places(database, kernels, monitor);
}

void ensure_places(SequenceDatabase& database, const RowKernels& kernels, const Monitor& monitor) {
  add_half_widths(database, monitor);
  add_shared_places(database, kernels, monitor);
}

Elsewhere plan_elsewhere(const SequenceDatabase& database, const SequenceQuerySettings& settings,
                         const RowKernels& kernels, const Monitor& monitor) {
  return make_elsewhere(widths_of(database, settings.margin_width, monitor),
                        settings.same_place.empty()
                            ? found_places(database, kernels, monitor)
                            : declared_places(database, settings.same_place));
}

void plan_margins(QueryPlan& plan, const SequenceDatabase& database,
                  const QueryResources& resources, const Monitor& monitor) {
  const SequenceQuerySettings& settings = plan.settings;
  std::vector<uint32_t> wrong;
  if (!settings.margin) wrong = margins_of(plan, resources, monitor);
  for (size_t s = 0; s < plan.sequences.size(); ++s) {
    Target& target = plan.sequences[s];
    if (!target.searched || target.windows == 0) continue;
    const auto& stored = database.sequences[s].typical_distance;
    target.margin =
        settings.margin
            ? *settings.margin
            : automatic_margin(wrong, score_kind(settings.score),
                               stored ? *stored : typical_distance(plan.train[s], monitor),
                               settings.window_length);
  }
}

}  // namespace vpr
