#include "present/recorded_frames.h"

#include <algorithm>
#include <memory>

#include "base/error.h"
#include "sequence/sequence_source.h"

namespace vpr {
namespace {

// The frames at a path of the run, if they are still the same.
template <class IsSame>
std::optional<SequenceSource> recorded_source(const std::string& path, const IsSame& is_same) {
  if (path.empty()) return std::nullopt;
  try {
    SequenceSource source = open_sequence(parse_sequence_argument(path));
    if (source.kind != SequenceKind::descriptors && is_same(source)) return source;
  } catch (const Error&) {  // they have moved
  }
  return std::nullopt;
}

bool has_names(const SequenceSource& source, const Sequence& expected) {
  std::vector<std::string> names = file_names(source);
  if (source.kind == SequenceKind::video) return true;
  if (names.size() != expected.recorded_frames()) return false;
  if (!expected.selection.is_all()) names = selected(std::move(names), expected.selection);
  return names == expected.frame_names;
}

// The training sequences of the run's database; none if it has moved or changed.
std::vector<TrainSequence> recorded_training(const RecordedRun& run) {
  if (run.train) return *run.train;
  if (run.path("database").empty()) return {};
  try {
    SequenceDatabase database = read_sequence_database(run.path("database"));
    if (database.fingerprint == run.database_fingerprint) return std::move(database.sequences);
  } catch (const Error&) {  // it has moved
  }
  return {};
}

}  // namespace

void add_recorded_names(EvaluationSettings& by, const RecordedRun& run, size_t sequences) {
  if (const std::string query = run.path("query"); !by.query_names && !query.empty())
    by.query_names = [query] { return frame_names(parse_sequence_argument(query)); };
  const std::string database = run.path("database");
  if (!by.train_names.empty() || (database.empty() && !run.train)) return;
  const auto trained =  // read at most once
      std::make_shared<std::vector<TrainSequence>>(run.train ? *run.train
                                                             : std::vector<TrainSequence>());
  for (size_t s = 0; s < sequences; ++s)
    by.train_names.emplace_back([database, trained, s] {
      if (trained->empty()) *trained = read_sequence_database(database).sequences;
      return trained->at(s).sequence.frame_names;
    });
}

Evaluation evaluate_stored(const std::shared_ptr<const StoredResult>& stored,
                           std::optional<ScoreMatrix> matrix, EvaluationSettings by,
                           const Monitor& monitor) {
  const std::shared_ptr<const Result> result(stored, &stored->result);
  if (!result->places) add_recorded_names(by, stored->run, result->sequences.size());
  Evaluation evaluation = evaluate_result(result, std::move(matrix), by, monitor);
  evaluation.fingerprint = stored->fingerprint;
  return evaluation;
}

FrameSources recorded_frames(const GroundTruthScope& scope, const RecordedRun& run,
                             bool has_places) {
  FrameSources sources{{}, std::vector<std::optional<SequenceSource>>(scope.sequences.size())};
  sources.query = recorded_source(run.path("query"), [&](const SequenceSource& source) {
    const auto names = run.frame_names.find("query");
    return names_checksum(source) == (names == run.frame_names.end() ? "" : names->second);
  });
  if (has_places) return sources;
  const std::vector<TrainSequence> trained = recorded_training(run);
  for (size_t s = 0; s < std::min(scope.sequences.size(), trained.size()); ++s)
    sources.references[s] = recorded_source(trained[s].path, [&](const SequenceSource& source) {
      return has_names(source, trained[s].sequence);
    });
  return sources;
}

}  // namespace vpr
