#include "loops/own_database.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/error.h"
#include "base/text.h"
#include "describe/imported.h"
#include "match/components.h"

namespace vpr {
namespace {

void append_frames(SequenceDatabase& database, const PrecomputedDistances& matrix,
                   const NamedArgument& argument) {
  const FrameRange& range = argument.sequence.range;
  const uint64_t last = range.last.value_or(matrix.references());
  if (range.first >= last || last > matrix.references())
    throw Error(ErrorKind::usage,
                "the training sequence {} has the range {}, and the matrix has {}", argument.name,
                range_text(range), counted(matrix.references(), "reference"));
  for (const TrainSequence& before : database.sequences)
    if (before.sequence.name == argument.name)
      throw Error(ErrorKind::usage, "duplicate name of training sequences: {}", argument.name);
  Sequence& sequence = database.sequences.emplace_back().sequence;
  sequence.name = argument.name;
  const std::vector<size_t>& empty = matrix.empty_references();
  for (uint64_t number = range.first; number < last; number += range.step) {
    if (std::binary_search(empty.begin(), empty.end(), number))
      sequence.unreadable.push_back(sequence.frames);
    sequence.frame_names.push_back(fmt::format("#{}", number));
    ++sequence.frames;
    append_frame_numbers(database.descriptors.owned, number, 1);
  }
}

// The variance of the distances of the first readable query frame.
double first_variance(const MatrixQuery& made) {
  const std::vector<DescribedFrames> train = descriptor_spans(made.database);
  const std::vector<FrameStretch> queries = readable_runs(made.query.span());
  const FrameDistances distances = frame_distances(train, made.query.span());
  if (queries.empty() || distances.readable_frames == 0) return 0;
  const size_t query = queries.front().first;
  const double mean = row_mean(distances, query);
  std::vector<uint16_t> row;
  compute_row(distances, query, row);
  double squares = 0;
  for (const FrameStretch& run : distances.train_runs)
    for (size_t i = run.first; i < run.first + run.count; ++i)
      squares += (row[i] - mean) * (row[i] - mean);
  return squares / static_cast<double>(distances.readable_frames);
}

}  // namespace

DescriptorSet describe_own(const SequenceSource& sequence, const SequenceQuerySettings& settings,
                           const Monitor& monitor) {
  const std::string usual(sequence.kind == SequenceKind::descriptors ? kVectorKind : "ldb");
  const std::string& name = settings.descriptor.empty() ? usual : settings.descriptor;
  SequenceDatabase described;
  described.descriptors.kind = &descriptor_kind(name);
  if (described.descriptors.kind->shape.element == ElementType::points16)
    described.descriptors.unit = coordinate_unit(name, {&sequence, 1}, monitor);
  return describe_frames(sequence, described, settings.skip_unreadable, monitor);
}

SequenceDatabase own_database(const DescriptorSet& query, const std::string& name) {
  SequenceDatabase database;
  database.descriptors.kind = query.descriptors.kind;
  database.descriptors.unit = query.descriptors.unit;
  database.descriptors.append(query.rows());
  database.sequences.push_back({query.sequence});
  database.sequences.back().sequence.name = name;
  database.overlapping_sequences.emplace();
  return database;
}

MatrixQuery matrix_query(const PrecomputedDistances& matrix,
                         const std::vector<NamedArgument>& sequences) {
  MatrixQuery made;
  made.database.descriptors.kind = &precomputed_kind();
  if (sequences.empty()) append_frames(made.database, matrix, {"references", {}});
  for (const NamedArgument& sequence : sequences) append_frames(made.database, matrix, sequence);
  made.query.descriptors.kind = &precomputed_kind();
  append_frame_numbers(made.query.descriptors.owned, 0, matrix.queries());
  Sequence& query = made.query.sequence;
  query.frames = matrix.queries();
  for (size_t i = 0; i < query.frames; ++i) query.frame_names.push_back(fmt::format("#{}", i));
  query.unreadable = matrix.empty_queries();
  made.query.precomputed = &matrix;
  const size_t frames = made.database.descriptors.rows().size();
  made.database.overlapping_sequences.emplace();
  made.database.statistics =
      TrainStatistics{{},
                      0,
                      std::vector<float>(frames, 0),
                      std::vector<float>(frames, static_cast<float>(first_variance(made))),
                      no_components(frames)};
  return made;
}

}  // namespace vpr
