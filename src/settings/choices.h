// The table of choices: the facets of a run that each setting or flag needs, and those that it
// excludes. Settings that passed its checks are ResolvedSettings.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "settings/query_settings.h"

namespace vpr {

/// Choices of a run that are not settings, by their flags or commands: "--fuse", "vpr-query live".
using RunChoices = std::vector<std::string_view>;

/// Frames that are matched as they arrive.
inline constexpr std::string_view kLiveChoice = "vpr-query live";
/// A query given as a matrix of scores.
inline constexpr std::string_view kMatrixChoice = "vpr-query matrix";

/// A query against a database of sequences.
inline constexpr std::string_view kDatabaseChoice = "DB";
/// The commands of vpr-tune, as choices.
inline constexpr std::string_view kSweepChoice = "vpr-tune fastable";
inline constexpr std::string_view kCalibrateChoice = "vpr-tune calibrate";
/// A query against a FAB-MAP database; the table covers its inputs and outputs only.
inline constexpr std::string_view kFabmapChoice = "a FAB-MAP database";

/// An entry of the table. Two choices cannot be combined if one excludes a facet of the run that
/// the other needs.
struct Choice {
  std::string_view flag;       ///< a description for an absent flag
  uint32_t needs = 0;          ///< facets, as bits
  uint32_t excludes = 0;       ///< facets, as bits
  std::string_view instead{};  ///< of a missing facet: advice, an imperative sentence
  /// Whether settings and other choices imply the choice. Null: only RunChoices contain it.
  bool (*is_implied)(const SequenceQuerySettings& settings, const RunChoices& run) = nullptr;
};

/// All choices. Errors name the first pair in this order.
std::span<const Choice> choices();

/// Throws Error(usage) for two choices that cannot be combined: both flags, the missing facet, and
/// what to do instead.
void check_choices(const SequenceQuerySettings& settings, const RunChoices& run);

/// The method of a query against a database of sequences if its settings do not name one: fastable
/// if a setting of windows is given, such as c_l, otherwise the filter. `given`: keys of settings.
std::string_view default_method(std::span<const std::string> given);

/// Settings of a sequence method whose combination and ranges were checked and whose implied values
/// are filled in. The filter has windows of one frame, z-scores, and a decision by margin with a
/// default margin. Fused scores are z-scores and have a weight. The default exclusion radius of a
/// loop query is its gap in frames. A decision by threshold has a scale.
class ResolvedSettings {
 public:
  /// Throws Error(usage) for settings that are out of range or cannot be combined with each other
  /// or with `run`.
  ResolvedSettings(SequenceQuerySettings settings = {}, RunChoices run = {kDatabaseChoice});

  const SequenceQuerySettings& operator*() const { return settings_; }
  const SequenceQuerySettings* operator->() const { return &settings_; }
  /// Whether `run` had this choice.
  bool has(std::string_view flag) const;

 private:
  SequenceQuerySettings settings_;
  RunChoices run_;
};

}  // namespace vpr
