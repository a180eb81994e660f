// The result of a query by any method: the content of a result file.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "query/clustering.h"
#include "query/query_settings.h"
#include "recordings/sequence.h"

namespace vpr {

/// A training sequence of a result, with its threshold or margin. For FAB-MAP the only one, which
/// has places instead of frames.
struct ComparedSequence {
  Sequence sequence;
  size_t windows = 0;               ///< without an unreadable frame
  bool searched = true;             ///< false: not in only_sequences
  std::optional<double> threshold;  ///< t_r on its scale; nullopt: unknown, or t_p
  ThresholdScale scale = ThresholdScale::bits;
  uint32_t distance_limit = 0;           ///< strict upper bound of D, or of the biased sum
  std::optional<uint32_t> max_distance;  ///< max(D), for the relative scale
  std::optional<double> margin = {};     ///< X, for a decision by margin
};

/// The initial training statistics of z-scores.
struct UsedStatistics {
  StatisticsSettings settings;
  double typical_distance = 0;
};

/// The recall of an approximate method.
struct SearchRecall {
  size_t windows = 0;       ///< query windows with a best match
  size_t found_best = 0;    ///< query windows whose smallest distance was found
  size_t recognitions = 0;  ///< of an exact search
  size_t found_recognitions = 0;
};

/// The first frames of keyframes, increasing, from 0 on.
struct ResultKeyframes {
  std::vector<uint32_t> query;
  std::vector<std::vector<uint32_t>> train;  ///< by training sequence
};

/// The places of FAB-MAP, each of one view or more.
struct ResultPlaces {
  std::vector<std::string> names;  ///< by index
  size_t views = 0;                ///< of all places
  size_t featureless = 0;          ///< readable query frames without words
  std::vector<double> new_place;   ///< probability, by query frame; 0 for an unreadable frame
};

/// The reports of the filter, by query frame.
struct ResultPath {
  /// Training frames per query frame; nullopt: not yet known.
  std::vector<std::optional<double>> rates;
  std::vector<uint32_t> numbers;  ///< of the path, from 1 on; 0: an unreadable frame
  /// The query frame at which each was recognized, itself or a later one; nullopt: it was not.
  std::vector<std::optional<uint32_t>> decided;
  /// Query frames that would be recognized if the training sequences were in reverse order.
  /// Nullopt: not counted.
  std::optional<size_t> reversed_frames = {};
  std::optional<size_t> keyframes = {};  ///< query keyframes of the filter; nullopt: not counted

  /// The decision at each recognized frame: the margin of the path alone, and the contrast of its
  /// features, nullopt without evidence. Empty: without a witness.
  struct Decided {
    double margin = 0;
    std::optional<double> contrast;
  };
  std::vector<std::optional<Decided>> witnessed = {};

  /// Unknown values for this number of query frames.
  explicit ResultPath(size_t frames = 0) : rates(frames), numbers(frames, 0), decided(frames) {}
};

struct Result {
  QuerySettings settings;
  Sequence query;
  size_t query_windows = 0;  ///< frames - window_length() + 1, also with unreadable frames
  std::vector<ComparedSequence> sequences;
  std::vector<Match> recognitions;         ///< by query, sequence, train; each once
  std::vector<std::optional<Match>> best;  ///< by query window; ties to the first. Nullopt: has an
                                           ///< unreadable frame, or a frame without words
  /// By query window: the score of the runner-up minus the best score, which the filter reduces for
  /// far paths; nullopt without a runner-up. Empty: unknown, as for approximate methods and
  /// FAB-MAP.
  std::vector<std::optional<double>> margins;
  std::optional<Clusters> clusters;    ///< of the recognitions: by sequence, first recognition;
                                       ///< paths by first recognition
  std::optional<SearchRecall> recall;  ///< of an approximate method
  std::optional<UsedStatistics> statistics;  ///< of z-scores
  std::optional<ResultPath> path;            ///< of the filter
  std::optional<ResultKeyframes> keyframes;  ///< nullopt without a typical distance
  std::optional<ResultPlaces> places;        ///< of FAB-MAP
  /// Loops: by query frame, the number of frames (places) of the last sequence, from the first
  /// on, that it was compared with.
  std::vector<uint32_t> past;

  const ScoreKind& score() const { return score_of(settings); }
  size_t window_length() const { return window_length_of(settings); }
};

/// The margin of a query window, in score per frame.
std::optional<double> frame_margin(const Result& result, size_t query_window);

/// Clusters the recognitions of a sequence method by distance, or by path for the filter.
void cluster(Result& result, const Monitor& monitor = {});

/// The anchor of a window: its last frame, where the user is.
inline size_t anchor_of(size_t window, size_t window_length) { return window + window_length - 1; }

/// The place of the first query frame in loops by FAB-MAP, after the places of the database, if
/// any; 0 for windows.
inline size_t first_own_place(const Result& result) {
  return result.places ? result.sequences.front().sequence.frames - result.query.frames : 0;
}

/// Query windows with at least one recognition.
size_t recognized_windows(const Result& result);

}  // namespace vpr
