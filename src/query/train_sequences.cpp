#include "query/train_sequences.h"

#include <algorithm>

#include "base/error.h"
#include "base/text.h"
#include "database/imported.h"
#include "match/distance_statistics.h"
#include "query/prepare.h"
#include "query/thresholds.h"
#include "query/witness.h"
#include "recordings/decode.h"

namespace vpr {
namespace {

void append_sequence(SequenceDatabase& database, const NamedArgument& argument,
                     bool skip_unreadable, const Monitor& monitor) {
  const FeatureChoice choose =
      database.features ? choose_changes(database.descriptors.shape().element) : FeatureChoice{};
  DescriptorSet described =
      describe_frames(open_sequence(argument.sequence), database, skip_unreadable, monitor, choose);
  Sequence& sequence = described.sequence;
  sequence.name = argument.name;
  if (!sequence.unreadable.empty())
    warn(monitor, "{}: {} of {} cannot be decoded and will never match", sequence.name,
         sequence.unreadable.size(), counted(sequence.frames, "frame"));
  const DescriptorShape found = described.descriptors.shape();
  const DescriptorShape expected = database.descriptors.shape();
  if (!database.descriptors.rows().empty() && found != expected)
    throw Error(ErrorKind::data, "{}: its descriptors have {} {}, descriptors of the database {}",
                argument.sequence.path.string(), found.length, element_noun(found),
                expected.length);
  const DescriptorRows rows = described.descriptors.rows();
  const std::vector<DescribedFrames> known = descriptor_spans(database);
  for (size_t s = 0; s < known.size(); ++s)
    if (std::ranges::equal(known[s].rows.bytes, rows.bytes))
      throw Error(ErrorKind::usage,
                  "{}: has the same frames as the training sequence {}. Train each recording once",
                  argument.sequence.path.string(), database.sequences[s].sequence.name);
  const auto first = static_cast<uint32_t>(database.descriptors.rows().size());
  for (size_t k = 0; k < described.features.frames.size(); ++k)
    database.features->append(first + described.features.frames[k], described.features.of(k));
  database.descriptors.append(std::move(described.descriptors));
  database.sequences.push_back({std::move(sequence)});
  database.sequences.back().path = argument_text(argument.sequence);
}

// Warns if many consecutive frames with imported directions are closer than cosine distances
// resolve.
void warn_of_near_frames(const SequenceDatabase& database, const Monitor& monitor) {
  constexpr double kShare = 0.01;
  const ElementType element = database.descriptors.shape().element;
  if (!database.descriptors.kind->is_imported ||
      (element != ElementType::int8 && element != ElementType::int16))
    return;
  const DistanceKind& distance = distance_of(element);
  size_t near = 0;
  for (const DescribedFrames& sequence : descriptor_spans(database))
    for (const FrameStretch& run : readable_runs(sequence))
      for (size_t i = run.first + 1; i < run.first + run.count; ++i) {
        const DescriptorRow before = sequence.rows[i - 1];
        const DescriptorRow row = sequence.rows[i];
        near += distance.pair(before, row) <= 1 && !std::ranges::equal(before, row);
      }
  const size_t frames = database.descriptors.rows().size();
  if (static_cast<double>(near) > kShare * static_cast<double>(frames))
    warn(monitor,
         "{} of {} frames differ from the next one by at most the resolution of cosine distances "
         "({:.1e}). Use --metric chord.",
         near, frames, distance.unit.size);
}

void add_thresholds(SequenceDatabase& database, size_t window_length, double safety_factor,
                    const Monitor& monitor) {
  const std::vector<DescribedFrames> spans = code_spans(database);
  if (!is_left_to_queries(spans))
    database.thresholds.push_back(compute_thresholds(spans, window_length, safety_factor, monitor));
}

// Appends sequences and computes everything except thresholds.
void extend(SequenceDatabase& database, const std::vector<NamedArgument>& sequences,
            bool skip_unreadable, const StatisticsSettings& settings, const Monitor& monitor) {
  for (size_t s = 0; s < sequences.size(); ++s)
    append_sequence(database, sequences[s], skip_unreadable,
                    part_of(monitor, sequences[s].name, s, sequences.size()));
  const std::vector<DescribedFrames> codes = code_spans(database);
  for (size_t s = 0; s < codes.size(); ++s)
    database.sequences[s].typical_distance =
        typical_distance(database.sequences[s], codes[s], monitor);
  database.statistics = compute_statistics(descriptor_spans(database), settings, monitor);
  if (database.descriptors.shape().element == ElementType::ldb_hog)
    database.statistics->code_distance =
        compute_statistics(codes, settings, monitor).typical_distance;
  ensure_exclusion_zones(database, monitor);
  if (database.features && database.features->all.empty()) database.features.reset();
}

}  // namespace

SequenceDatabase train_sequences(const std::vector<NamedArgument>& sequences,
                                 const SequenceTrainSettings& settings, const Monitor& monitor) {
  check_window_length(settings.window_length);
  check_safety_factor(settings.safety_factor);
  SequenceDatabase database;
  database.descriptors.kind = &descriptor_kind(settings.descriptor_kind);
  database.descriptor = settings.descriptor;
  if (database.descriptors.kind->shape.element == ElementType::points16) {
    std::vector<SequenceSource> sources;
    for (const NamedArgument& argument : sequences)
      sources.push_back(open_sequence(argument.sequence));
    database.descriptors.unit = coordinate_unit(settings.descriptor_kind, sources, monitor);
  }
  if (settings.features != Witness::none && !database.descriptors.kind->is_imported)
    database.features.emplace();
  extend(database, sequences, settings.skip_unreadable, settings.statistics, monitor);
  warn_of_near_frames(database, monitor);
  add_thresholds(database, settings.window_length, settings.safety_factor, monitor);
  return database;
}

SequenceDatabase add_sequences(const SequenceDatabase& database,
                               const std::vector<NamedArgument>& sequences, bool skip_unreadable,
                               const Monitor& monitor) {
  SequenceDatabase extended;
  extended.descriptor = database.descriptor;
  extended.sequences = database.sequences;
  extended.descriptors.kind = database.descriptors.kind;
  extended.descriptors.unit = database.descriptors.unit;
  extended.descriptors.append(database.descriptors.rows());
  extended.features = database.features;
  extend(extended, sequences, skip_unreadable,
         database.statistics ? database.statistics->settings : StatisticsSettings{}, monitor);
  for (const ThresholdTable& table : database.thresholds)
    add_thresholds(extended, table.window_length, table.safety_factor, monitor);
  return extended;
}

namespace {

FeatureLookup features_of_files(const std::vector<std::filesystem::path>& files,
                                const DescriptorSettings& settings) {
  const auto shared = std::make_shared<const std::vector<std::filesystem::path>>(files);
  return [shared, format = pixel_format(settings)](size_t frame) {
    const cv::Mat gray = in_format(decode_image((*shared)[frame], format), PixelFormat::gray);
    return find_local_features(working_image(gray));
  };
}

// Each chosen frame stands for the frames up to the next one.
FeatureLookup features_of_keyframes(KeyframeFeatures features) {
  const auto shared = std::make_shared<const KeyframeFeatures>(std::move(features));
  return [shared](size_t frame) {
    const size_t until = shared->count_until(frame);
    const auto found = until == 0 ? std::span<const LocalFeature>{} : shared->of(until - 1);
    return std::vector<LocalFeature>(found.begin(), found.end());
  };
}

}  // namespace

// Warns if nearly all frames have one descriptor, as in darkness or a range of pixels that was cut.
void warn_of_uniform_frames(const DescriptorSet& set, const std::string& name,
                            const Monitor& monitor) {
  constexpr double kNearlyAll = 0.95;
  constexpr size_t kEnough = 16;  // frames
  const DescriptorRows rows = set.rows();
  size_t equal = 0;
  for (size_t i = 1; i < rows.size(); ++i) equal += std::ranges::equal(rows[i - 1], rows[i]);
  const size_t pairs = rows.size() < 2 ? 0 : rows.size() - 1;
  if (pairs >= kEnough && static_cast<double>(equal) >= kNearlyAll * static_cast<double>(pairs))
    warn(monitor,
         "{}: {} of {} frames look like the one before, so places cannot be told apart. Are the "
         "images uniform, or is the camera still?",
         name, equal, rows.size());
}

DescriptorSet describe_frames(const SequenceSource& source, const SequenceDatabase& database,
                              bool skip_unreadable, const Monitor& monitor,
                              const FeatureChoice& choose, FeatureTime time) {
  const DescriptorKind& kind = *database.descriptors.kind;
  const bool has_frames = source.kind != SequenceKind::descriptors;
  if (kind.is_imported && has_frames)
    throw Error(ErrorKind::data,
                "{}: has images, but the database has imported descriptors. Use descriptors of the "
                "same program, as in q.npy.",
                source.argument.path.string());
  if (!kind.is_imported && !has_frames)
    throw Error(ErrorKind::data,
                "{}: holds descriptors (.npy), but frames of the database are described by {}. Use "
                "a folder of images.",
                source.argument.path.string(), kind.name);
  const Unreadable unreadable = skip_unreadable ? Unreadable::skip : Unreadable::fail;
  DescriptorSettings settings = database.descriptor;
  settings.unit = database.descriptors.unit;
  const bool decodes_again = time == FeatureTime::later && source.kind == SequenceKind::images;
  DescriptorSet set = kind.describe(source, settings, unreadable, monitor,
                                    decodes_again ? FeatureChoice{} : choose);
  if (choose && time == FeatureTime::later)
    set.features_of = decodes_again ? features_of_files(source.files, settings)
                                    : features_of_keyframes(std::move(set.features));
  warn_of_uniform_frames(set, source.argument.path.string(), monitor);
  const Selection shown =
      at_speed(source.argument.speed, set.sequence.frames, source.argument.seed);
  return selected(std::move(set), shown);
}

std::vector<DescribedFrames> descriptor_spans(const SequenceDatabase& database) {
  std::vector<DescribedFrames> spans;
  const DescriptorRows rows = database.descriptors.rows();
  size_t first = 0;
  for (const TrainSequence& train : database.sequences) {
    const size_t frames = train.sequence.frames;
    DescribedFrames& span = spans.emplace_back();
    span.rows = rows.subspan(first, frames);
    span.unreadable = train.sequence.unreadable;
    first += frames;
  }
  return spans;
}

std::vector<DescribedFrames> code_spans(const SequenceDatabase& database) {
  std::vector<DescribedFrames> spans = descriptor_spans(database);
  for (DescribedFrames& span : spans) span.rows = codes_of(span.rows);
  return spans;
}

}  // namespace vpr
