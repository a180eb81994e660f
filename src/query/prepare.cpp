#include "query/prepare.h"

#include <algorithm>
#include <limits>
#include <string>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "match/components.h"
#include "match/distance_statistics.h"
#include "match/filter_track.h"
#include "query/choices.h"
#include "query/thresholds.h"
#include "query/train_sequences.h"

namespace vpr {
namespace {

using SequencePairs = std::vector<std::pair<size_t, size_t>>;

constexpr std::string_view kAllDiffer = "none";

// The exclusion radius of every sequence: the setting, the stored or the computed one.
std::vector<uint32_t> radii_of(const SequenceDatabase& database,
                               const std::optional<uint64_t>& radius, const Monitor& monitor) {
  const std::vector<DescribedFrames> spans = code_spans(database);
  std::vector<uint32_t> radii;
  for (size_t s = 0; s < spans.size(); ++s) {
    const auto& stored = database.sequences[s].exclusion_radius;
    const size_t chosen = radius ? *radius : stored ? *stored : exclusion_radius(spans[s], monitor);
    radii.push_back(static_cast<uint32_t>(std::min(chosen, spans[s].rows.size())));
  }
  return radii;
}

SequencePairs overlapping_sequences(const SequenceDatabase& database, const Monitor& monitor) {
  if (database.overlapping_sequences) return *database.overlapping_sequences;
  return find_overlapping_sequences(code_spans(database), radii_of(database, std::nullopt, monitor),
                                    monitor);
}

// Parses "A=B". Names may contain "=".
std::pair<size_t, size_t> pair_of(const std::string& text, const std::vector<std::string>& names) {
  const auto index_of = [&](std::string_view name) {
    return static_cast<size_t>(std::find(names.begin(), names.end(), name) - names.begin());
  };
  for (size_t at = text.find('='); at != std::string::npos; at = text.find('=', at + 1)) {
    const size_t a = index_of(std::string_view(text).substr(0, at));
    const size_t b = index_of(std::string_view(text).substr(at + 1));
    if (a < names.size() && b < names.size() && a != b) return std::minmax(a, b);
  }
  throw Error(
      ErrorKind::usage,
      "same_place \"{}\" is neither {} nor a pair A=B of training sequences; the database has {}",
      text, kAllDiffer, fmt::join(names, ", "));
}

SequencePairs declared_pairs(const SequenceDatabase& database,
                             const std::vector<std::string>& same_place) {
  SequencePairs pairs;
  if (same_place.size() == 1 && same_place.front() == kAllDiffer) return pairs;
  for (const std::string& text : same_place) pairs.push_back(pair_of(text, names_of(database)));
  return pairs;
}

std::vector<RepeatedPlace> repeated_places(const SequenceDatabase& database,
                                           const Monitor& monitor) {
  if (database.repeated_places) return *database.repeated_places;
  constexpr uint32_t kLeastMargin = 12 * kScoreUnit;  // links recognize nothing by themselves
  return find_passes(descriptor_spans(database), *database.statistics, kLeastMargin, monitor);
}

void check_names(const SequenceDatabase& database, const SequenceQuerySettings& settings) {
  const std::vector<std::string> names = names_of(database);
  for (const std::string& name : settings.only_sequences)
    if (std::find(names.begin(), names.end(), name) == names.end())
      throw Error(ErrorKind::usage, "the database has no sequence \"{}\"; it has {}", name,
                  fmt::join(names, ", "));
}

// By sequence; 0 for those without windows.
std::vector<double> typical_distances(const PreparedDatabase& prepared,
                                      const SequenceQuerySettings& settings,
                                      const Monitor& monitor) {
  std::vector<double> all(prepared.train.size());
  for (size_t s = 0; s < all.size(); ++s) {
    const TrainSequence& stored = prepared.database->sequences[s];
    if (is_searched(settings, stored.sequence.name) &&
        count_windows(readable_runs(prepared.train[s]), window_length_of(settings.rule)) > 0)
      all[s] = typical_distance(stored, prepared.train[s], monitor);
  }
  return all;
}

// The table of the database, or a new one.
ThresholdTable threshold_table(const SequenceDatabase& database,
                               const SequenceQuerySettings& settings, size_t memory_limit,
                               const Monitor& monitor) {
  const size_t length = window_length_of(settings.rule);
  if (const ThresholdTable* stored = find_thresholds(database.thresholds, length)) return *stored;
  const double factor = database.thresholds.empty() ? 1 : database.thresholds.front().safety_factor;
  return {length, factor,
          find_closest_windows(code_spans(database), {length, memory_limit}, monitor)};
}

}  // namespace

void check_sums(const DescriptorStore& descriptors, uint64_t window_length) {
  const uint64_t longest =
      std::numeric_limits<int32_t>::max() / largest_distance(descriptors.shape());
  if (window_length > longest)
    throw Error(ErrorKind::usage, "c_l must be at most {} for {} descriptors, found {}", longest,
                descriptors.kind->name, window_length);
}

PreparedDatabase prepare(const SequenceDatabase& database, const SequenceQuerySettings& settings,
                         const QueryResources& resources, const Monitor& monitor) {
  check_settings(settings);
  check_names(database, settings);
  check_sums(database.descriptors, window_length_of(settings.rule));
  check_automatic(database, settings);
  PreparedDatabase prepared{
      &database, is_zscore(settings.rule) ? descriptor_spans(database) : code_spans(database)};
  const std::optional<uint64_t> radius = exclusion_frames_of(settings);
  const std::vector<std::string>& same_place = same_place_of(settings.rule);
  if (!std::holds_alternative<Lsh>(settings.rule) && (!settings.past || radius)) {
    prepared.exclusion_zones =
        make_exclusion_zones(radii_of(database, radius, monitor),
                             same_place.empty() ? overlapping_sequences(database, monitor)
                                                : declared_pairs(database, same_place));
    if (has_paths(settings.rule) && same_place.empty())
      prepared.passes = repeated_places(database, monitor);
  }
  if (const auto* margin = std::get_if<Margin>(&settings.rule); margin && !margin->margin)
    prepared.typical_distances = typical_distances(prepared, settings, monitor);
  if (has_automatic_threshold(settings))
    prepared.thresholds = threshold_table(database, settings, resources.memory_limit, monitor);
  return prepared;
}

void ensure_statistics(SequenceDatabase& database, const Monitor& monitor) {
  const std::vector<DescribedFrames> spans = descriptor_spans(database);
  if (!database.statistics) database.statistics = compute_statistics(spans, {}, monitor);
  if (!database.statistics->components)
    database.statistics->components =
        compute_components(spans, database.statistics->typical_distance, monitor);
}

void ensure_statistics(SequenceDatabase& database, const SequenceQuerySettings& settings,
                       const Monitor& monitor) {
  if (is_zscore(settings.rule)) ensure_statistics(database, monitor);
}

void ensure_exclusion_zones(SequenceDatabase& database, const Monitor& monitor) {
  ensure_statistics(database, monitor);
  const std::vector<uint32_t> radii = radii_of(database, std::nullopt, monitor);
  for (size_t s = 0; s < radii.size(); ++s) database.sequences[s].exclusion_radius = radii[s];
  database.overlapping_sequences = overlapping_sequences(database, monitor);
  database.repeated_places = repeated_places(database, monitor);
}

}  // namespace vpr
