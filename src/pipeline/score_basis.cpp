#include "pipeline/score_basis.h"

#include "base/error.h"
#include "matching/distance_statistics.h"
#include "matching/fastable_standardized.h"
#include "pipeline/train.h"
#include "recognition/automatic_score.h"

namespace vpr {

void ensure_statistics(SequenceDatabase& database, const HammingKernels& kernels,
                       const Monitor& monitor) {
  if (database.statistics) return;
  warn(monitor,
       "the database has no training statistics, which standardized scores start from: computing "
       "them; a database that is trained again holds them");
  database.statistics =
      compute_statistics(make_train_codes(code_spans(database)), {}, kernels, monitor);
}

ScoreBasis make_score_basis(const SequenceDatabase& database,
                            const SequenceQuerySettings& settings) {
  if (!database.statistics)
    throw Error(ErrorKind::usage,
                "the database has no training statistics, which standardized scores start from; "
                "train it again");
  return {settings.standardization,
          settings.score == Score::standardized_offline,
          database.statistics->typical_distance,
          database.statistics->bias,
          database.statistics->variance,
          count_bits(code_spans(database))};
}

void match_rows(const SequenceResult& result, const SequenceDatabase& database,
                const TrainCodes& train, const QueryCodes& query,
                std::span<const size_t> window_lengths, const MatchSettings& settings,
                const Monitor& monitor, const RawMatcher& raw, const LengthRowConsumer& consume) {
  if (result.settings.score == Score::raw) {
    raw(consume);
    return;
  }
  std::vector<uint8_t> searched;
  for (const SequenceThreshold& sequence : result.sequences) searched.push_back(sequence.searched);
  const ScoreBasis basis =
      basis_of(make_score_basis(database, result.settings), code_spans(database), searched);
  match_standardized(train, query, window_lengths, basis, settings, monitor, consume);
}

}  // namespace vpr
