// The table of choices: the facets of a run that features and values of settings need, and those
// that they exclude. Rows of settings add their own. Settings that passed these checks are
// ResolvedSettings.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "settings/query_settings.h"
#include "settings/setting_rows.h"

namespace vpr {

/// An entry of the table. Two choices cannot be combined if one excludes a facet of the run that
/// the other needs.
struct Choice {
  std::optional<Feature> feature = {};
  std::string_view flag = {};  ///< without a feature: the flag, or a description of its absence
  uint32_t needs = 0;          ///< facets, as bits
  uint32_t excludes = 0;       ///< facets, as bits
  std::string_view instead{};  ///< of a missing facet: advice, an imperative sentence
  /// Whether settings and features imply the choice. Null: only Features contain it.
  bool (*is_implied)(const SequenceQuerySettings& settings, const Features& run) = nullptr;

  std::string_view name() const { return feature ? enum_name(*feature) : flag; }
};

/// All choices. Errors name the first pair in this order, with settings after all choices.
std::span<const Choice> choices();

/// Throws Error(usage) for two choices that cannot be combined: both flags, the missing facet, and
/// what to do instead.
void check_choices(const SequenceQuerySettings& settings, const Features& run);

/// The method of a sequence query if its settings do not name one: the filter, or fastable for
/// loops, or if a setting of windows is given, such as c_l. `given`: keys of settings.
std::string_view default_method(Feature command, std::span<const std::string> given);

/// Adds the features of settings that the method would replace and that are given with another
/// value. `given`: keys of settings.
void add_given_features(Features& run, const SequenceQuerySettings& settings,
                        std::span<const std::string> given);

/// Settings of a sequence method whose combination and ranges were checked and whose implied values
/// are filled in. The filter has windows of one frame, z-scores, and a decision by margin with a
/// default margin. The default exclusion radius of a loop query is its gap in frames. A decision by
/// threshold has a scale.
class ResolvedSettings {
 public:
  /// Throws Error(usage) for settings that are out of range or cannot be combined with each other
  /// or with `run`.
  ResolvedSettings(SequenceQuerySettings settings = {}, Features run = {Feature::database});

  const SequenceQuerySettings& operator*() const { return settings_; }
  const SequenceQuerySettings* operator->() const { return &settings_; }
  /// Whether `run` had this feature.
  bool has(Feature feature) const;

 private:
  SequenceQuerySettings settings_;
  Features run_;
};

}  // namespace vpr
