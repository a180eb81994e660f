// What every matcher produces: rows of the score matrix, piece by piece, never the whole.
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

/// What the method `filter` knows of a query frame besides its row, in units of the row's values.
struct PathReport {
  uint32_t margin = 0;   ///< of the best match to the best one elsewhere and to being nowhere; 0
                         ///< where it is not to be trusted
  uint32_t nowhere = 0;  ///< the value of being at no training frame
  std::optional<double> rate;  ///< training frames a query frame; none while little was seen
  uint32_t track = 0;          ///< number of the confirmed track, from 1 on; 0: not confirmed
};

/// Adjacent cells of one row: scores[x] = D(query_window, train_window + x), the frame distances
/// of the windows, summed; of standardized scores, biased sums that order as the scores do
/// (score_kernels.h).
/// Windows are named by their first frame, train windows within their sequence.
struct ScoreRow {
  size_t query_window = 0;
  size_t sequence = 0;
  size_t train_window = 0;
  std::span<const uint32_t> scores;
  std::span<const uint8_t> rates = {};  ///< of windows of several rates: which of them each has
  const PathReport* path = nullptr;     ///< of the filter
};

/// Cells [first, first + count) of a row.
ScoreRow part_of_row(const ScoreRow& row, size_t first, size_t count);

/// Where there is no cell; no sum is as large.
inline constexpr uint32_t kNoCell = std::numeric_limits<uint32_t>::max();

/// Takes pieces of rows: several times for a row, in any order, from several threads at once. Every
/// cell of every valid window pair arrives exactly once; of an approximate method, some.
using RowConsumer = std::function<void(const ScoreRow&)>;

/// Takes whole rows, which are not empty: their pieces by sequence and train window. Rows come in
/// the order of query windows, on the calling thread.
using WholeRowConsumer = std::function<void(std::span<const ScoreRow>)>;

/// What reads the rows of a match.
struct Sinks {
  std::vector<RowConsumer> pieces = {};
  std::vector<WholeRowConsumer> rows = {};  ///< where there is one, pieces come in order, too
};

/// What only the method `lsh` takes.
struct LshSettings {
  uint64_t tables = 8;
  uint64_t key_bits = 0;     ///< of a bucket; 0: log2 of the windows of a sequence, and three
  uint64_t probe_level = 2;  ///< keys that differ in so many bits are looked up, too
};

template <class Visitor>
void visit_fields(LshSettings& settings, Visitor&& visit) {
  visit("tables", settings.tables);
  visit("key_bits", settings.key_bits);
  visit("probe_level", settings.probe_level);
}

/// Bytes for rings and hits, where the user says nothing.
inline constexpr size_t kDefaultMemoryLimit = size_t{1} << 33;

/// So many training frames pass while the query passes so many; reduced.
struct Rate {
  uint32_t train = 1;
  uint32_t query = 1;

  bool operator==(const Rate&) const = default;
};

struct SequenceMethod;

/// What all methods take.
struct MatchSettings {
  size_t window_length = 40;  ///< c_l, at least 1, at most kMaxWindowLength
  /// Bytes for rings; beyond, work is done twice instead.
  size_t memory_limit = kDefaultMemoryLimit;
  RowKernels kernels;
  LshSettings lsh = {};
  uint64_t seed = 1;             ///< of lsh
  std::vector<Rate> rates = {};  ///< of FastABLE: windows of each (rates.h); empty: of rate 1
  FilterSettings filter = {};
  /// Of the method filter: which training sequences are walks of one place, [a][b]; empty: none.
  std::vector<std::vector<uint8_t>> shared_places = {};
  const SequenceMethod* method = nullptr;  ///< a row of sequence_methods(); null: fastable
};

/// Sums of distances stay below 2^32.
inline constexpr size_t kMaxWindowLength = 1'000'000;

/// Splits sums of windows that *end* at train frames [first, first + sums.size()) at the ends of
/// the runs, and at the end of the past, and hands the valid ones on. `query_end` is the query
/// window's last frame.
void emit_row(const FrameDistances& frames, size_t window_length, size_t query_end, size_t first,
              std::span<const uint32_t> sums, const RowConsumer& consume);

/// The same pieces of a whole row: `sums` has one entry a train frame.
std::vector<ScoreRow> whole_row(const FrameDistances& frames, size_t window_length,
                                size_t query_end, std::span<const uint32_t> sums);

/// How many frames of a query lie at least between a frame and the past that it may match: of
/// diagonals (train frame - query frame) only those up to -least_lag hold cells. Nothing where all
/// frames may be matched; as many as there are frames where none may.
std::optional<size_t> least_lag(const FrameDistances& frames);

/// Whether there is a cell at all.
bool any_window_pair(const FrameDistances& frames, size_t window_length);

/// The next frame of a query whose frames come in order.
struct QueryFrame {
  size_t row = 0;       ///< of the distances; less than `number` where earlier rows were dropped
  size_t number = 0;    ///< in the query
  size_t in_a_row = 0;  ///< readable frames up to and including this one; 0: it is unreadable
};

/// Takes the row of the windows of the length-th window length; not called where it has no cell.
using StageConsumer = std::function<void(size_t length, std::span<const ScoreRow> row)>;

/// Windows over rows that come in order: takes every query frame, one after the other, computes its
/// row of distances, and hands on the rows of all windows that end there.
using WindowStage = std::function<void(const FrameDistances& distances, const QueryFrame& frame,
                                       const StageConsumer& consume)>;

/// Whether a valid query window ends at this frame.
bool ends_window(const FrameDistances& frames, size_t window_length, size_t frame);

}  // namespace vpr
