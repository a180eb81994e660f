// The table of scores: what the score of a match is, and all that follows from it.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "matching/standardization.h"
#include "recognition/score_order.h"
#include "recognition/threshold.h"

namespace vpr {

struct SequenceQuerySettings;

/// One row of the table. That of a window's score has the place of its value of Score, whose name
/// is its name; the last row is FAB-MAP's, which has no windows: what is about them is empty there,
/// and no function.
///
/// Rows of matchers hold sums of whole numbers that are never negative: a score with a sign is
/// biased, and `offset` is what is taken from a sum for files and reports.
struct ScoreKind {
  ScoreOrder order = {};                ///< which of two is better
  std::string_view measure = {};        ///< in sentences: "distance"
  std::string_view title = {};          ///< of a chart's axis, with the unit of sums over a window
  std::string_view window_symbol = {};  ///< of the setting that says how many frames: c_l, c_w
  std::string_view threshold_symbol = {};  ///< t_r, t_p
  std::string_view frame_unit = {};        ///< of frame_value, as the head of a column
  int frame_digits = {};                   ///< behind the point, where frame_value is printed
  ThresholdScale number_scale = {};  ///< of a t_r that is a number, where the user names no scale
  ThresholdScale frame_scale = {};   ///< of frame_value: of t_r of a sequence against its own past
  size_t longest_window = {};        ///< in frames: sums of longer ones may not fit into 32 bits
  int32_t missing = {};              ///< in a saved matrix, where there is no score
  bool needs_statistics = {};        ///< of the training frames: it is standardized
  bool is_offline = {};              ///< it depends on later frames of the query
  std::span<const std::string_view> settings =
      {};  ///< keys that only some scores have, of this one
  int64_t (*offset)(size_t window_length) = nullptr;
  /// Of the score of a window, as files hold it.
  double (*frame_value)(double score, size_t window_length) = nullptr;

  /// Throws Error(usage) where t_r, its scale, the method, c_l or the settings of another score do
  /// not fit this one.
  void (*check)(const SequenceQuerySettings& settings) = nullptr;

  std::string_view margin_unit = {};  ///< of a margin a frame, in sentences: "bits a frame"
  double most_margin = {};            ///< no margin a frame is larger
  /// What no automatic margin a frame is below, where training frames differ by typical_distance.
  double (*least_margin)(double typical_distance, size_t window_length) = nullptr;
};

/// All rows, that of FAB-MAP last.
std::span<const ScoreKind> score_kinds();
/// The row of a score of windows.
const ScoreKind& score_kind(Score score);
/// The row of FAB-MAP: how likely a frame shows a place.
const ScoreKind& probability_kind();

/// Whether score a is better than b; not if they are equal.
inline bool is_better(double a, double b, ScoreOrder order) {
  return order == ScoreOrder::distance ? a < b : a > b;
}

/// Checks the settings of the score that is set (ScoreKind::check).
void check_score(const SequenceQuerySettings& settings);

/// Keys of settings that only some scores have, and that stand in files only of those.
std::span<const std::string_view> score_settings();

}  // namespace vpr
