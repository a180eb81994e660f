#include "query/open.h"

#include <algorithm>
#include <limits>
#include <unordered_map>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "match/components.h"
#include "match/distance_statistics.h"
#include "match/filter_track.h"
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

}  // namespace

bool is_searched(const SequenceQuerySettings& settings, const std::string& sequence) {
  const auto& only = settings.only_sequences;
  return only.empty() || std::find(only.begin(), only.end(), sequence) != only.end();
}

void check_names(const SequenceDatabase& database, const SequenceQuerySettings& settings) {
  const std::vector<std::string> names = names_of(database);
  for (const std::string& name : settings.only_sequences)
    if (std::find(names.begin(), names.end(), name) == names.end())
      throw Error(ErrorKind::usage, "the database has no sequence \"{}\"; it has {}", name,
                  fmt::join(names, ", "));
}

void check_sums(const DescriptorStore& descriptors, uint64_t window_length) {
  const uint64_t longest =
      std::numeric_limits<int32_t>::max() / largest_distance(descriptors.shape());
  if (window_length > longest)
    throw Error(ErrorKind::usage, "c_l must be at most {} for {} descriptors, found {}", longest,
                descriptors.kind->name, window_length);
}

void ensure_statistics(SequenceDatabase& database, const Monitor& monitor) {
  const std::vector<DescribedFrames> spans = descriptor_spans(database);
  if (!database.statistics) database.statistics = compute_statistics(spans, {}, monitor);
  if (!database.statistics->components)
    database.statistics->components =
        compute_components(spans, database.statistics->typical_distance, monitor);
}

void ensure_exclusion_zones(SequenceDatabase& database, const Monitor& monitor) {
  ensure_statistics(database, monitor);
  const std::vector<uint32_t> radii = radii_of(database, std::nullopt, monitor);
  for (size_t s = 0; s < radii.size(); ++s) database.sequences[s].exclusion_radius = radii[s];
  database.overlapping_sequences = overlapping_sequences(database, monitor);
  database.repeated_places = repeated_places(database, monitor);
}

std::vector<RepeatedPlace> repeated_places(const SequenceDatabase& database,
                                           const Monitor& monitor) {
  if (database.repeated_places) return *database.repeated_places;
  constexpr uint32_t kLeastMargin = 12 * kScoreUnit;  // links recognize nothing by themselves
  return find_passes(descriptor_spans(database), *database.statistics, kLeastMargin, monitor);
}

ExclusionZones exclusion_zones_of(const SequenceDatabase& database,
                                  const std::optional<uint64_t>& radius,
                                  const std::vector<std::string>& same_place,
                                  const Monitor& monitor) {
  return make_exclusion_zones(radii_of(database, radius, monitor),
                              same_place.empty() ? overlapping_sequences(database, monitor)
                                                 : declared_pairs(database, same_place));
}

SequenceDatabase open_database(const std::string& path, const SequenceQuerySettings& settings,
                               const Monitor& monitor) {
  SequenceDatabase database = read_sequence_database(path);
  prepare_database(database, settings, monitor);
  return database;
}

SequenceDatabase open_live_database(const std::string& path, const SequenceQuerySettings& settings,
                                    const Monitor& monitor) {
  SequenceDatabase database = read_sequence_database(path);
  if (database.descriptors.kind->is_imported)
    throw Error(ErrorKind::data,
                "{}: holds imported descriptors, which cannot be computed for frames that arrive",
                path);
  prepare_database(database, settings, monitor);
  return database;
}

void prepare_database(SequenceDatabase& database, const SequenceQuerySettings& settings,
                      const Monitor& monitor) {
  if (is_zscore(settings.rule)) ensure_statistics(database, monitor);
}

void warn_of_rates(const SequenceDatabase& database, std::optional<double> query_fps,
                   const SequenceQuerySettings& settings, const Monitor& monitor) {
  constexpr double kAlike = 1.1;
  constexpr double kFilterRange = 2.05;  // from half to twice the rate
  const bool is_filter = has_paths(settings.rule);
  if (!query_fps || (window_length_of(settings.rule) == 1 && !is_filter)) return;
  for (const TrainSequence& train : database.sequences) {
    const Sequence& sequence = train.sequence;
    if (!sequence.fps || !is_searched(settings, sequence.name)) continue;
    const auto [slow, fast] = std::minmax(*sequence.fps, *query_fps);
    if (fast <= (is_filter ? kFilterRange : kAlike) * slow) continue;
    return warn(monitor,
                "the query has {:.3g} frames per second, the training sequence {} has {:.3g}: "
                "{}. Use --fps {:.3g} for {}{}.",
                *query_fps, sequence.name, *sequence.fps,
                is_filter ? "the filter needs half to twice as many"
                          : "their windows have different durations",
                slow, slow == *query_fps ? "vpr-train" : "the query",
                is_filter || fast > kFilterRange * slow
                    ? ""
                    : ", or --method filter, which estimates the rate");
  }
}

// Warns if the images have another shape than those of a searched training sequence.
void warn_of_shapes(const SequenceDatabase& database, const Sequence& query,
                    const SequenceQuerySettings& settings, const Monitor& monitor) {
  constexpr double kAlike = 1.05;
  for (const TrainSequence& train : database.sequences) {
    const auto& size = train.sequence.size;
    if (!query.size || !size || !is_searched(settings, train.sequence.name)) continue;
    const auto [width, height] = *query.size;
    const auto [train_width, train_height] = *size;
    const double across = static_cast<double>(width) * train_height;
    const double down = static_cast<double>(train_width) * height;
    if (std::max(across, down) <= kAlike * std::min(across, down)) continue;
    return warn(monitor,
                "the query's images are {} x {}, those of {} are {} x {}: views of different shape "
                "are hard to match. Is one of them rotated or cropped?",
                width, height, train.sequence.name, train_width, train_height);
  }
}

// Warns if nearly all frames of the query are frames of one training sequence.
void warn_of_same_frames(const SequenceDatabase& database, const DescriptorSet& query,
                         const SequenceQuerySettings& settings, const Monitor& monitor) {
  constexpr size_t kFew = 20;  // one of 20 frames may differ
  const auto key = [](const DescriptorRows& rows, size_t i) {
    return std::string_view(reinterpret_cast<const char*>(rows[i].data()), rows[i].size());
  };
  const DescriptorRows rows = query.rows();
  std::unordered_map<std::string_view, size_t> copies;  // of each descriptor of the query
  for (size_t i = 0; i < rows.size(); ++i) ++copies[key(rows, i)];
  const std::vector<DescribedFrames> spans = descriptor_spans(database);
  for (size_t s = 0; s < spans.size(); ++s) {
    if (!is_searched(settings, database.sequences[s].sequence.name)) continue;
    std::unordered_map<std::string_view, size_t> others = copies;
    for (size_t i = 0; i < spans[s].rows.size() && !others.empty(); ++i)
      others.erase(key(spans[s].rows, i));
    size_t other_frames = 0;
    for (const auto& [_, frames] : others) other_frames += frames;
    if (rows.empty() || kFew * other_frames > rows.size()) continue;
    return warn(monitor,
                "the query has the same frames as the training sequence {}: this says nothing "
                "about another recording",
                database.sequences[s].sequence.name);
  }
}

DescriptorSet describe_query(const SequenceArgument& query, const SequenceDatabase& database,
                             const SequenceQuerySettings& settings, const Monitor& monitor) {
  DescriptorSet described =
      describe_frames(open_sequence(query), database, settings.skip_unreadable, monitor);
  warn_of_rates(database, described.sequence.fps, settings, monitor);
  warn_of_shapes(database, described.sequence, settings, monitor);
  warn_of_same_frames(database, described, settings, monitor);
  return described;
}

}  // namespace vpr
