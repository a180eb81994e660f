#include "run/thresholds.h"

#include "base/error.h"
#include "decide/automatic_margin.h"
#include "run/train.h"

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
  return {window_length, safety_factor, find_closest_windows(sequences, match, monitor)};
}

AutomaticThresholds automatic_thresholds(const SequenceDatabase& database, ThresholdTable table,
                                         const Monitor& monitor) {
  const std::vector<DescriptorSpan> spans = descriptor_spans(database);
  AutomaticThresholds automatic{std::move(table), {}};
  const size_t length = automatic.table.window_length;
  for (size_t s = 0; s < spans.size(); ++s) {
    auto& threshold = automatic.sequences.emplace_back();
    if (spans.size() == 1 || count_windows(readable_runs(spans[s]), length) == 0) continue;
    const auto& stored = database.sequences[s].typical_distance;
    threshold = automatic_threshold(automatic.table.closest[s],
                                    stored ? *stored : typical_distance(spans[s], monitor), length,
                                    automatic.table.safety_factor);
  }
  return automatic;
}

void check_automatic(const SequenceDatabase& database, const SequenceQuerySettings& settings) {
  const bool is_automatic =
      settings.decision == Decision::threshold && !settings.distance_threshold && !settings.loop;
  if (is_automatic && database.sequences.size() < 2)
    throw Error(ErrorKind::usage,
                "the automatic t_r needs two or more training sequences. Use --method filter, "
                "--score zscore --decide margin, or a number, as in --t-r 0.6.");
}

std::vector<AutomaticThresholds> stored_thresholds(const SequenceDatabase& database,
                                                   const Monitor& monitor) {
  std::vector<AutomaticThresholds> all;
  for (const ThresholdTable& table : database.thresholds)
    all.push_back(automatic_thresholds(database, table, monitor));
  return all;
}

void warn_of_overlaps(const SequenceDatabase& database, const ThresholdTable& table,
                      const Monitor& monitor) {
  const auto sentence = overlap_warning(table, database.sequences, descriptor_spans(database));
  if (sentence) warn(monitor, *sentence);
}

}  // namespace vpr
