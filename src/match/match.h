// The driver of matching: passes a query through a window stage, and its rows of scores to sinks.
// The whole score matrix is never stored.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "base/json_fwd.h"
#include "base/monitor.h"
#include "match/frame_distances.h"

namespace vpr {

/// One cell. Windows are identified by their first frame, train windows within their sequence.
struct Cell {
  uint32_t query_window = 0;
  uint32_t sequence = 0;
  uint32_t train_window = 0;
  uint32_t score = 0;  ///< D, or the biased sum of scores, over the window

  bool operator==(const Cell&) const = default;
};

/// The path of the filter at a query frame, in units of the row's values.
struct PathReport {
  uint32_t path = 0;    ///< number of the path in one pass, from 1 on
  uint32_t margin = 0;  ///< of the path over any other; 0: it has too few keyframes
  /// The margin recognizes the query frames of the path, in all its passes, in [first, settled):
  /// their matches are final.
  size_t first = 0;
  size_t settled = 0;
  /// recent training frames per query frame; unset after few frames
  std::optional<double> rate = {};
  /// Matches of the last frames of the path, up to this one; they replace those of earlier reports.
  std::span<const Cell> matches = {};
  bool is_keyframe = false;  ///< the filter advanced at this frame
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
  const PathReport* path = nullptr;      ///< of the filter
  const PathReport* reversed = nullptr;  ///< against the direction; without rate and matches
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
  uint64_t key_bits = 0;
  uint64_t probe_level = 2;
};

VPR_FIELDS(LshSettings, (tables, "Number of hash tables."),
           (key_bits, "Bits of a hash key; 0: 3 more than log2 of the windows of a sequence."),
           (probe_level, "Keys that differ in up to this many bits are searched."))

/// Settings of the method `filter`.
struct FilterSettings {
  double start_weight = 2;
  double keyframe_change = 0.15;
  uint64_t near_keyframes = 10;
  uint64_t path_keyframes = 16;
};

VPR_FIELDS(FilterSettings,
           (start_weight, "Weight of the training data in z-scores, in keyframes; 20 for windows.",
            at_least(0)),
           (keyframe_change,
            "A frame that differs from the last keyframe by this share of the typical distance is "
            "a keyframe; up to a third more at high frame rates."),
           (near_keyframes,
            "Keyframes around the best match that are not compared with it; up to half more at "
            "high frame rates."),
           (path_keyframes,
            "Keyframes of a recognized path. It recognizes frames that are half to one and a half "
            "times as many keyframes old, and at its beginning up to four times."))

/// Throws Error(usage) for settings out of range.
void check_filter(const FilterSettings& settings);

/// The default memory limit for rings and recognitions in bytes.
inline constexpr size_t kDefaultMemoryLimit = size_t{1} << 33;

struct SequenceMethod;

/// All methods, in the order of the help text: the exact ones first, FastABLE as the first.
std::span<const SequenceMethod> sequence_methods();

/// Settings of all methods.
struct MatchSettings {
  size_t window_length = 40;                  ///< c_l, at least 1, at most kMaxWindowLength
  size_t memory_limit = kDefaultMemoryLimit;  ///< for rings, in bytes
  LshSettings lsh = {};
  uint64_t seed = 1;  ///< of lsh
  FilterSettings filter = {};
  /// For the method filter: which training sequences overlap, [a][b]; empty: none.
  std::vector<std::vector<uint8_t>> overlapping_sequences = {};
  std::vector<RepeatedPlace> passes = {};                    ///< for the method filter, increasing
  const SequenceMethod* method = sequence_methods().data();  ///< never null
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

/// Whether a valid query window ends at this frame.
bool ends_window(const FrameDistances& frames, size_t window_length, size_t frame);

/// The minimum distance between a query frame and the past that it may match: only diagonals (train
/// frame - query frame) up to -least_lag contain cells. Nullopt if all frames may be matched; the
/// number of frames if none may.
std::optional<size_t> least_lag(const FrameDistances& frames);

/// The next frame of a query with frames in order.
struct QueryFrame {
  size_t row = 0;     ///< of the distances; less than `number` if earlier rows were dropped
  size_t number = 0;  ///< in the query
  /// consecutive readable frames up to and including this one; 0: it is unreadable
  size_t consecutive_readable = 0;
};

/// Receives the row of windows of the length-th window length; not called for rows without cells.
using StageConsumer = std::function<void(size_t length, std::span<const ScoreRow> row)>;

/// Windows over rows in order: computes the row of distances of every query frame, and passes on
/// the rows of all windows that end there.
using WindowStage = std::function<void(const FrameDistances& distances, const QueryFrame& frame,
                                       const StageConsumer& consume)>;

/// Receives pieces of rows of windows of the length-th window length, like RowConsumer.
using LengthRowConsumer = std::function<void(size_t length, const ScoreRow&)>;

/// An entry of the table of window stages (used by help texts, --method and the contract tests).
struct SequenceMethod {
  std::string_view name;
  std::string_view summary;
  /// supports only distances in order; windows have one frame, and cells are the filter's values
  bool has_paths;
  /// Passes on the pieces of a whole query at once; null: can only go row by row.
  void (*match_whole)(const FrameDistances&, std::span<const size_t> window_lengths,
                      const MatchSettings&, const Monitor&, const LengthRowConsumer&);
  /// Null for an approximate method, which has no whole rows (lsh.h).
  WindowStage (*stage)(const FrameDistances&, std::span<const size_t> window_lengths,
                       const MatchSettings&);

  bool is_approximate() const { return stage == nullptr; }
};

/// The methods that yield the same cells: the scores of all pairs of windows of c_l frames.
std::span<const SequenceMethod> exact_methods();

/// Throws Error(usage), which lists the names, for an unknown name.
const SequenceMethod& find_sequence_method(std::string_view name);

/// Windows of one length, and the sinks of their rows.
struct Pass {
  size_t window_length = 0;
  Sinks sinks;
};

/// The stage of settings.method, which is not approximate, for windows of these lengths;
/// settings.window_length is not used. Throws Error(usage) if its memory exceeds the limit.
WindowStage window_stage(const FrameDistances& distances, std::span<const size_t> window_lengths,
                         const MatchSettings& settings);

/// Computes the rows of all passes, with the distances of each frame computed once. There are no
/// rows if a sequence is shorter than a window. Throws as window_stage does.
void match(const FrameDistances& distances, const MatchSettings& settings,
           std::span<const Pass> passes, const Monitor& monitor);

/// Computes the rows of windows of settings.window_length.
void match(const FrameDistances& distances, const MatchSettings& settings, const Sinks& sinks,
           const Monitor& monitor);

}  // namespace vpr
