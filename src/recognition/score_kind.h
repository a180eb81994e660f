// The table of scores: what the score of a window is, and all that follows from it.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "database/sequence_database.h"
#include "matching/standardization.h"
#include "recognition/automatic_threshold.h"

namespace vpr {

struct SequenceQuerySettings;

/// One row of the table. Its place is that of its value of Score, whose name is its name.
///
/// Rows of matchers hold sums of whole numbers that are never negative: a score with a sign is
/// biased, and `offset` is what is taken from a sum for files and reports.
struct ScoreKind {
  std::string_view measure;        ///< in sentences: "distance"
  std::string_view title;          ///< of a chart's axis, with the unit of sums over a window
  std::string_view frame_unit;     ///< of frame_value, as the head of a column
  int frame_digits;                ///< behind the point, where frame_value is printed
  ThresholdScale number_scale;     ///< of a t_r that is a number, where the user names no scale
  ThresholdScale automatic_scale;  ///< of automatic t_r
  ThresholdScale single_scale;     ///< the same where the database has a single sequence
  size_t longest_window;           ///< in frames: sums of longer ones may not fit into 32 bits
  int32_t missing;                 ///< in a saved matrix, where there is no score
  bool needs_statistics;           ///< of the training frames: it is standardized
  bool is_offline;                 ///< it depends on later frames of the query
  bool is_stored;                  ///< databases hold its closest windows
  std::span<const std::string_view> settings;  ///< keys that only some scores have, of this one
  int64_t (*offset)(size_t window_length);
  double (*frame_value)(uint32_t sum, size_t window_length);

  /// Throws Error(usage) where t_r, its scale, the method, c_l or the settings of another score do
  /// not fit this one.
  void (*check)(const SequenceQuerySettings& settings);

  /// How close training sequences come to each other, by this score. `basis` is there where
  /// needs_statistics is true. ClosestWindows::distance is a sum as rows hold it.
  ClosestTable (*closest)(std::span<const DescriptorSpan> sequences, const ScoreBasis* basis,
                          const MatchSettings& match, const Monitor& monitor);

  /// The automatic t_r of a sequence that has a window, from the closest windows of all. settings:
  /// safety_factor (none: 1) and safety_margin. typical_distance gives the sequence's, in bits.
  AutomaticThreshold (*automatic)(const ClosestTable& closest, size_t sequence,
                                  const std::function<double()>& typical_distance,
                                  const SequenceQuerySettings& settings);

  /// What the automatic t_r was made with, for titles: "t_r, safety factor 1".
  std::string (*automatic_title)(const SequenceQuerySettings& settings);
};

/// The rows, in the order of Score.
std::span<const ScoreKind> score_kinds();
const ScoreKind& score_kind(Score score);

/// As ScoreKind::check, of the score that is set.
void check_score(const SequenceQuerySettings& settings);

/// Keys of settings that only some scores have, and that stand in files only of those.
std::span<const std::string_view> score_settings();

}  // namespace vpr
