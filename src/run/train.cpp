#include "run/train.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/error.h"
#include "base/monitor.h"
#include "base/text.h"
#include "describe/imported.h"
#include "match/distance_statistics.h"
#include "run/fuse.h"
#include "run/plan.h"
#include "run/thresholds.h"
#include "sequence/sequence_source.h"

namespace vpr {
namespace {

[[noreturn]] void refuse_shape(const NamedArgument& argument, const DescriptorShape& found,
                               const DescriptorShape& expected) {
  throw Error(ErrorKind::data, fmt::format("{}: its descriptors have {} {}, those of the database "
                                           "{}",
                                           argument.sequence.path.string(), found.length,
                                           element_words(found), expected.length));
}

void append_sequence(SequenceDatabase& database, const NamedArgument& argument,
                     bool skip_unreadable, const Monitor& monitor) {
  DescriptorSet described =
      describe_frames(open_sequence(argument.sequence), database, skip_unreadable, monitor);
  Sequence& sequence = described.sequence;
  sequence.name = argument.name;
  if (!sequence.unreadable.empty())
    warn(monitor, fmt::format("{}: {} of {} can't be decoded and will never match", sequence.name,
                              sequence.unreadable.size(), counted(sequence.frames, "frame")));
  if (!database.descriptors.owned.empty() &&
      described.descriptors.shape() != database.descriptors.shape())
    refuse_shape(argument, described.descriptors.shape(), database.descriptors.shape());
  database.descriptors.append(described.rows());
  database.sequences.push_back({std::move(sequence)});
}

void append_sequences(SequenceDatabase& database, const std::vector<NamedArgument>& sequences,
                      bool skip_unreadable, const Monitor& monitor) {
  for (size_t s = 0; s < sequences.size(); ++s)
    append_sequence(database, sequences[s], skip_unreadable,
                    part_of(monitor, sequences[s].name, s, sequences.size()));
}

std::vector<SequenceSource> opened(const std::vector<NamedArgument>& arguments) {
  std::vector<SequenceSource> sequences;
  for (const NamedArgument& argument : arguments)
    sequences.push_back(open_sequence(argument.sequence));
  return sequences;
}

void warn_of_short_sequences(const SequenceDatabase& database, size_t window_length,
                             const Monitor& monitor) {
  const std::vector<DescriptorSpan> spans = descriptor_spans(database);
  for (size_t s = 0; s < spans.size(); ++s)
    if (count_windows(readable_runs(spans[s]), window_length) == 0)
      warn(monitor, fmt::format("{}: has no {} readable frames in a row, so it can't be recognized "
                                "with this c_l",
                                database.sequences[s].sequence.name, window_length));
}

// Of imported directions: frames that differ from the next one by less than distances can say.
void warn_of_near_frames(const SequenceDatabase& database, const Monitor& monitor) {
  constexpr double kShare = 0.01;
  const ElementType element = database.descriptors.shape().element;
  if (!database.descriptors.kind->is_imported ||
      (element != ElementType::int8 && element != ElementType::int16))
    return;
  const DistanceKind& distance = distance_of(element);
  size_t near = 0;
  for (const DescriptorSpan& sequence : descriptor_spans(database))
    for (const FrameRun& run : readable_runs(sequence))
      for (size_t i = run.first + 1; i < run.first + run.count; ++i) {
        const DescriptorRow before = sequence.rows[i - 1];
        const DescriptorRow row = sequence.rows[i];
        near += distance.pair(before, row) <= 1 && !std::ranges::equal(before, row);
      }
  const size_t frames = database.descriptors.rows().size();
  if (static_cast<double>(near) > kShare * static_cast<double>(frames))
    warn(monitor, fmt::format("{} of {} frames differ from the next one by no more than cosine "
                              "distances are exact to ({:.1e}); --metric chord tells them apart",
                              near, frames, distance.unit.size));
}

void add_thresholds(SequenceDatabase& database, size_t window_length, double safety_factor,
                    const RowKernels& kernels, const Monitor& monitor) {
  if (is_left_to_queries(descriptor_spans(database))) {
    warn(monitor, fmt::format("the training sequences are long: their automatic t_r is computed "
                              "when a query needs it; vpr-tune threshold DB --c-l {} --write does "
                              "so once and keeps it",
                              window_length));
    return;
  }
  database.thresholds.push_back(compute_thresholds(descriptor_spans(database), window_length,
                                                   safety_factor, kernels, monitor));
}

void add_typical_distances(SequenceDatabase& database, const Monitor& monitor) {
  const std::vector<DescriptorSpan> spans = descriptor_spans(database);
  for (size_t s = 0; s < spans.size(); ++s)
    if (!database.sequences[s].typical_distance)
      database.sequences[s].typical_distance = typical_distance(spans[s], monitor);
}

void add_statistics(SequenceDatabase& database, const StatisticsSettings& settings,
                    const Monitor& monitor) {
  database.statistics = compute_statistics(descriptor_spans(database), settings, monitor);
}

}  // namespace

std::vector<DescriptorSpan> descriptor_spans(const SequenceDatabase& database) {
  std::vector<DescriptorSpan> spans;
  const DescriptorRows rows = database.descriptors.rows();
  size_t first = 0;
  const FusedViews* fused = fused_views(database);
  for (const auto& [sequence, typical, half_width] : database.sequences) {
    const size_t frames = sequence.frames;
    DescriptorSpan& span = spans.emplace_back();
    span.rows = rows.subspan(first, frames);
    span.unreadable = sequence.unreadable;
    if (fused != nullptr) span.words = std::span(fused->words).subspan(first, frames);
    first += frames;
  }
  return spans;
}

DescriptorSet describe_frames(const SequenceSource& source, const SequenceDatabase& database,
                              bool skip_unreadable, const Monitor& monitor) {
  const DescriptorKind& kind = *database.descriptors.kind;
  const bool has_frames = source.kind != SequenceKind::descriptors;
  if (kind.is_imported && has_frames)
    throw Error(ErrorKind::data,
                fmt::format("{}: has images, but frames of the database were described by another "
                            "program; give the same descriptors of these, as in q.npy",
                            source.argument.path.string()));
  if (!kind.is_imported && !has_frames)
    throw Error(
        ErrorKind::data,
        fmt::format("{}: holds descriptors, but frames of the database are described by {}; "
                    "give the images",
                    source.argument.path.string(), kind.name));
  const Unreadable unreadable = skip_unreadable ? Unreadable::skip : Unreadable::fail;
  DescriptorSettings settings = database.descriptor;
  settings.unit = database.descriptors.unit;
  DescriptorSet set = fused_views(database) != nullptr
                          ? describe_both(source, database, unreadable, monitor)
                          : kind.describe(source, settings, unreadable, monitor);
  const Selection shown = warped(source.argument.warp, set.sequence.frames, source.argument.seed);
  return selected(std::move(set), shown);
}

SequenceDatabase train_sequences(const std::vector<NamedArgument>& sequences,
                                 const SequenceTrainSettings& settings, const RowKernels& kernels,
                                 const Monitor& monitor) {
  check_window_length(settings.window_length);
  check_safety_factor(settings.safety_factor);
  SequenceDatabase database;
  database.descriptors.kind = &descriptor_kind(settings.descriptor_kind);
  database.descriptor = settings.descriptor;
  if (database.descriptors.kind->shape.element == ElementType::points16)
    database.descriptors.unit =
        coordinate_unit(settings.descriptor_kind, opened(sequences), monitor);
  append_sequences(database, sequences, settings.skip_unreadable, monitor);
  warn_of_short_sequences(database, settings.window_length, monitor);
  warn_of_near_frames(database, monitor);
  add_typical_distances(database, monitor);
  ensure_places(database, kernels, monitor);
  add_thresholds(database, settings.window_length, settings.safety_factor, kernels, monitor);
  add_statistics(database, settings.statistics, monitor);
  return database;
}

SequenceDatabase add_sequences(const SequenceDatabase& database,
                               const std::vector<NamedArgument>& sequences, bool skip_unreadable,
                               const RowKernels& kernels, const Monitor& monitor) {
  SequenceDatabase extended;
  extended.descriptor = database.descriptor;
  extended.sequences = database.sequences;
  extended.descriptors.kind = database.descriptors.kind;
  extended.descriptors.unit = database.descriptors.unit;
  extended.descriptors.append(database.descriptors.rows());
  append_sequences(extended, sequences, skip_unreadable, monitor);
  add_typical_distances(extended, monitor);
  ensure_places(extended, kernels, monitor);
  for (const ThresholdTable& table : database.thresholds) {
    warn_of_short_sequences(extended, table.window_length, monitor);
    add_thresholds(extended, table.window_length, table.safety_factor, kernels, monitor);
  }
  add_statistics(extended,
                 database.statistics ? database.statistics->settings : StatisticsSettings{},
                 monitor);
  return extended;
}

}  // namespace vpr
