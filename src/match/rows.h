// The output of matchers: rows of the score matrix, without ever storing the whole matrix.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "base/monitor.h"
#include "match/filter_settings.h"
#include "match/frame_distances.h"
#include "match/row_kernels.h"

namespace vpr {

/// The filter's state at a query frame in addition to its row, in units of the row's values.
struct PathReport {
  /// The margin of the best match over the runner-up and the off-map state; 0: not confirmed.
  uint32_t margin = 0;
  uint32_t nowhere = 0;  ///< the value of the off-map state
  /// recent training frames per query frame; unset after too few frames
  std::optional<double> rate;
  uint32_t track = 0;  ///< number of the confirmed track, from 1 on; 0: not confirmed
};

/// Adjacent cells of one row: scores[x] = D(query_window, train_window + x), the sum of the frame
/// distances of the windows; for z-scores, biased sums with the order of the scores
/// (score_kernels.h). Windows are identified by their first frame, training windows within their
/// sequence.
struct ScoreRow {
  size_t query_window = 0;
  size_t sequence = 0;
  size_t train_window = 0;
  std::span<const uint32_t> scores;
  /// for windows of several rates: the index of each cell's rate
  std::span<const uint8_t> rates = {};
  const PathReport* path = nullptr;  ///< of the filter
};

/// Cells [first, first + count) of a row.
ScoreRow part_of_row(const ScoreRow& row, size_t first, size_t count);

/// Marks missing cells; larger than any sum.
inline constexpr uint32_t kNoCell = std::numeric_limits<uint32_t>::max();

/// Receives pieces of rows: several per row, in any order, from several threads. Every cell of
/// every valid window pair arrives exactly once; for an approximate method, only some do.
using RowConsumer = std::function<void(const ScoreRow&)>;

/// Receives whole rows, which are not empty: their pieces by sequence and training window. Rows
/// arrive in the order of query windows, on the calling thread.
using WholeRowConsumer = std::function<void(std::span<const ScoreRow>)>;

/// The receivers of the rows of a match.
struct Sinks {
  std::vector<RowConsumer> pieces = {};
  std::vector<WholeRowConsumer> rows = {};  ///< if there is one, pieces arrive in order as well
};

/// Settings of the method `lsh`.
struct LshSettings {
  uint64_t tables = 8;
  uint64_t key_bits = 0;     ///< of a bucket; 0: log2 of the windows of a sequence, plus three
  uint64_t probe_level = 2;  ///< number of differing bits up to which keys are probed as well
};

template <class Visitor>
void visit_fields(LshSettings& settings, Visitor&& visit) {
  visit("tables", settings.tables);
  visit("key_bits", settings.key_bits);
  visit("probe_level", settings.probe_level);
}

/// The default memory limit for rings and recognitions in bytes.
inline constexpr size_t kDefaultMemoryLimit = size_t{1} << 33;

/// The number of training frames per number of query frames; reduced.
struct Rate {
  uint32_t train = 1;
  uint32_t query = 1;

  bool operator==(const Rate&) const = default;
};

struct SequenceMethod;

/// Settings of all methods.
struct MatchSettings {
  size_t window_length = 40;  ///< c_l, at least 1, at most kMaxWindowLength
  /// Bytes for rings; above the limit, distances are computed twice instead.
  size_t memory_limit = kDefaultMemoryLimit;
  RowKernels kernels;
  LshSettings lsh = {};
  uint64_t seed = 1;             ///< of lsh
  std::vector<Rate> rates = {};  ///< windows of each rate for FastABLE (rates.h); empty: rate 1
  FilterSettings filter = {};
  /// For the method filter: which training sequences overlap, [a][b]; empty: none.
  std::vector<std::vector<uint8_t>> shared_places = {};
  const SequenceMethod* method = nullptr;  ///< an entry of sequence_methods(); null: fastable
};

/// Sums of distances stay below 2^32.
inline constexpr size_t kMaxWindowLength = 1'000'000;

/// Splits sums of windows that *end* at train frames [first, first + sums.size()) at the ends of
/// the runs and at the end of the past, and passes on the valid ones. `query_end` is the query
/// window's last frame.
void emit_row(const FrameDistances& frames, size_t window_length, size_t query_end, size_t first,
              std::span<const uint32_t> sums, const RowConsumer& consume);

/// The same pieces for a whole row: `sums` has one entry per train frame.
std::vector<ScoreRow> whole_row(const FrameDistances& frames, size_t window_length,
                                size_t query_end, std::span<const uint32_t> sums);

/// The minimum distance between a query frame and the past that it may match: only diagonals (train
/// frame - query frame) up to -least_lag contain cells. Nullopt if all frames may be matched; the
/// number of frames if none may.
std::optional<size_t> least_lag(const FrameDistances& frames);

/// Whether there is any cell.
bool any_window_pair(const FrameDistances& frames, size_t window_length);

/// The next frame of a query with frames in order.
struct QueryFrame {
  size_t row = 0;     ///< of the distances; less than `number` if earlier rows were dropped
  size_t number = 0;  ///< in the query
  /// consecutive readable frames up to and including this one; 0: it is unreadable
  size_t in_a_row = 0;
};

/// Receives the row of windows of the length-th window length; not called for rows without cells.
using StageConsumer = std::function<void(size_t length, std::span<const ScoreRow> row)>;

/// Windows over rows in order: processes every query frame in order, computes its row of distances,
/// and passes on the rows of all windows that end there.
using WindowStage = std::function<void(const FrameDistances& distances, const QueryFrame& frame,
                                       const StageConsumer& consume)>;

/// Whether a valid query window ends at this frame.
bool ends_window(const FrameDistances& frames, size_t window_length, size_t frame);

}  // namespace vpr
