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

std::optional<ScoreBasis> score_basis(const SequenceDatabase& database,
                                      const SequenceQuerySettings& settings) {
  const ScoreKind& kind = score_kind(settings.score);
  if (!kind.needs_statistics) return std::nullopt;
  if (!database.statistics)
    throw Error(ErrorKind::usage,
                "the database has no training statistics, which standardized scores start from; "
                "train it again");
  return ScoreBasis{settings.standardization,
                    kind.is_offline,
                    database.statistics->typical_distance,
                    database.statistics->bias,
                    database.statistics->variance,
                    count_bits(code_spans(database))};
}

ThresholdTable closest_windows(const SequenceDatabase& database,
                               const SequenceQuerySettings& settings, const MatchSettings& match,
                               const Monitor& monitor) {
  const std::optional<ScoreBasis> basis = score_basis(database, settings);
  return {settings.window_length, settings.safety_factor.value_or(1),
          score_kind(settings.score)
              .closest(code_spans(database), basis ? &*basis : nullptr, match, monitor)};
}

void match_rows(const SequenceResult& result, const SequenceDatabase& database,
                const TrainCodes& train, const QueryCodes& query,
                std::span<const size_t> window_lengths, const MatchSettings& settings,
                const Monitor& monitor, const RawMatcher& raw, const LengthRowConsumer& consume) {
  const std::optional<ScoreBasis> all = score_basis(database, result.settings);
  if (!all) {
    raw(consume);
    return;
  }
  std::vector<uint8_t> searched;
  for (const SequenceThreshold& sequence : result.sequences) searched.push_back(sequence.searched);
  const ScoreBasis basis = basis_of(*all, code_spans(database), searched);
  match_standardized(train, query, window_lengths, basis, settings, monitor, consume);
}

}  // namespace vpr
