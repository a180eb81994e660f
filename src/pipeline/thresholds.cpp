#include "pipeline/thresholds.h"

#include "matching/distance_statistics.h"
#include "pipeline/score_basis.h"
#include "pipeline/train.h"
#include "recognition/automatic_threshold.h"
#include "recognition/closest_windows.h"
#include "recognition/same_place.h"

namespace vpr {
namespace {

constexpr uint64_t kMostPairs = uint64_t{1} << 32;  // a few seconds

}  // namespace

bool is_left_to_queries(std::span<const DescriptorSpan> sequences) {
  uint64_t pairs = 0;
  uint64_t before = 0;
  for (const DescriptorSpan& sequence : sequences) {
    pairs += before * sequence.rows.size();
    before += sequence.rows.size();
  }
  return pairs > kMostPairs;
}

ThresholdTable compute_thresholds(std::span<const DescriptorSpan> sequences, size_t window_length,
                                  double safety_factor, const RowKernels& kernels,
                                  const Monitor& monitor) {
  const MatchSettings match{window_length, kDefaultMemoryLimit, kernels};
  return {window_length, safety_factor, find_closest_windows(sequences, nullptr, match, monitor)};
}

ThresholdTable closest_windows(const SequenceDatabase& database,
                               const SequenceQuerySettings& settings, const MatchSettings& match,
                               const Monitor& monitor) {
  const std::optional<ScoreBasis> basis =
      score_basis(database.statistics ? &*database.statistics : nullptr, settings);
  return {
      settings.window_length, settings.safety_factor.value_or(1),
      find_closest_windows(descriptor_spans(database), basis ? &*basis : nullptr, match, monitor)};
}

AutomaticThresholds automatic_thresholds(const SequenceDatabase& database, ThresholdTable table,
                                         const SequenceQuerySettings& settings,
                                         const Monitor& monitor) {
  SequenceQuerySettings used = settings;
  used.window_length = table.window_length;
  const std::vector<DescriptorSpan> spans = descriptor_spans(database);
  AutomaticThresholds automatic{std::move(table), {}};
  for (size_t s = 0; s < spans.size(); ++s) {
    auto& threshold = automatic.sequences.emplace_back();
    if (count_windows(readable_runs(spans[s]), used.window_length) == 0) continue;
    const auto typical = [&] {
      const auto& stored = database.sequences[s].typical_distance;
      return stored ? *stored : typical_distance(spans[s], monitor);
    };
    threshold = score_kind(used.score).automatic(automatic.table.closest, s, typical, used);
  }
  return automatic;
}

std::vector<AutomaticThresholds> stored_thresholds(const SequenceDatabase& database,
                                                   const Monitor& monitor) {
  std::vector<AutomaticThresholds> all;
  for (const ThresholdTable& table : database.thresholds) {
    SequenceQuerySettings settings;
    settings.safety_factor = table.safety_factor;
    all.push_back(automatic_thresholds(database, table, settings, monitor));
  }
  return all;
}

ThresholdScale automatic_scale(size_t sequences, const SequenceQuerySettings& settings) {
  const ScoreKind& kind = score_kind(settings.score);
  return sequences == 1 ? kind.single_scale : kind.automatic_scale;
}

void warn_of_overlaps(const SequenceDatabase& database, const ThresholdTable& table,
                      const Monitor& monitor) {
  const auto sentence = overlap_warning(table, database.sequences, descriptor_spans(database));
  if (sentence) warn(monitor, *sentence);
}

void explain_no_hits(const SequenceDatabase& database, size_t window_length,
                     const RowKernels& kernels, const Monitor& monitor) {
  const ThresholdTable* stored = find_thresholds(database.thresholds, window_length);
  const std::vector<DescriptorSpan> spans = descriptor_spans(database);
  if (stored == nullptr && is_left_to_queries(spans)) return;
  warn_of_overlaps(
      database,
      stored != nullptr ? *stored : compute_thresholds(spans, window_length, 1, kernels, monitor),
      monitor);
}

}  // namespace vpr
