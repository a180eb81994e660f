#include "run/given_query.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/error.h"
#include "base/text.h"
#include "match/components.h"

namespace vpr {
namespace {

void append_frames(SequenceDatabase& database, const GivenDistances& given,
                   const NamedArgument& argument) {
  const FrameRange& range = argument.sequence.range;
  const uint64_t last = range.last.value_or(given.references());
  if (range.first >= last || last > given.references())
    throw Error(
        ErrorKind::usage,
        fmt::format("the training sequence {} has the range {}, and the matrix has {}",
                    argument.name, range_text(range), counted(given.references(), "reference")));
  for (const TrainSequence& before : database.sequences)
    if (before.sequence.name == argument.name)
      throw Error(ErrorKind::usage,
                  fmt::format("two training sequences are called {}", argument.name));
  Sequence& sequence = database.sequences.emplace_back().sequence;
  sequence.name = argument.name;
  const std::vector<size_t>& empty = given.empty_references();
  for (uint64_t number = range.first; number < last; number += range.step) {
    if (std::binary_search(empty.begin(), empty.end(), number))
      sequence.unreadable.push_back(sequence.frames);
    sequence.frame_names.push_back(fmt::format("#{}", number));
    ++sequence.frames;
    append_frame_numbers(database.descriptors.owned, number, 1);
  }
}

// How far the distances of the first readable query frame are from their mean.
double first_variance(const GivenQuery& made) {
  const std::vector<DescriptorSpan> train = descriptor_spans(made.database);
  const std::vector<FrameRun> queries = readable_runs(made.query.span());
  const FrameDistances distances = frame_distances(train, made.query.span());
  if (queries.empty() || distances.readable_frames == 0) return 0;
  const size_t query = queries.front().first;
  const double mean = row_mean(distances, query);
  std::vector<uint16_t> row;
  compute_row(distances, query, row);
  double squares = 0;
  for (const FrameRun& run : distances.train_runs)
    for (size_t i = run.first; i < run.first + run.count; ++i)
      squares += (row[i] - mean) * (row[i] - mean);
  return squares / static_cast<double>(distances.readable_frames);
}

}  // namespace

GivenQuery given_query(const GivenDistances& given, const std::vector<NamedArgument>& sequences) {
  GivenQuery made;
  made.database.descriptors.kind = &given_kind();
  if (sequences.empty()) append_frames(made.database, given, {"references", {}});
  for (const NamedArgument& sequence : sequences) append_frames(made.database, given, sequence);
  made.query.descriptors.kind = &given_kind();
  append_frame_numbers(made.query.descriptors.owned, 0, given.queries());
  Sequence& query = made.query.sequence;
  query.frames = given.queries();
  for (size_t i = 0; i < query.frames; ++i) query.frame_names.push_back(fmt::format("#{}", i));
  query.unreadable = given.empty_queries();
  made.query.given = &given;
  const size_t frames = made.database.descriptors.rows().size();
  made.database.shared_places.emplace();
  made.database.statistics =
      TrainStatistics{{},
                      0,
                      std::vector<float>(frames, 0),
                      std::vector<float>(frames, static_cast<float>(first_variance(made))),
                      no_components(frames)};
  return made;
}

}  // namespace vpr
