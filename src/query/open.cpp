#include "query/open.h"

#include <algorithm>
#include <unordered_map>

#include "base/error.h"
#include "query/prepare.h"
#include "query/train_sequences.h"
#include "query/witness.h"

namespace vpr {
SequenceDatabase open_database(const std::string& path, const SequenceQuerySettings& settings,
                               const Monitor& monitor) {
  SequenceDatabase database = read_sequence_database(path);
  ensure_statistics(database, settings, monitor);
  return database;
}

SequenceDatabase open_live_database(const std::string& path, const SequenceQuerySettings& settings,
                                    const Monitor& monitor) {
  SequenceDatabase database = read_sequence_database(path);
  if (database.descriptors.kind->is_imported)
    throw Error(ErrorKind::data,
                "{}: holds imported descriptors, which cannot be computed for frames that arrive",
                path);
  ensure_statistics(database, settings, monitor);
  return database;
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
      describe_frames(open_sequence(query), database, settings.skip_unreadable, monitor,
                      tested_frames(database, settings.rule), FeatureTime::later);
  warn_of_rates(database, described.sequence.fps, settings, monitor);
  warn_of_shapes(database, described.sequence, settings, monitor);
  warn_of_same_frames(database, described, settings, monitor);
  return described;
}

}  // namespace vpr
