// The table of decisions: which window pairs are hits.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "base/enum_names.h"
#include "decide/score_kind.h"
#include "match/standardization.h"

namespace vpr {

struct Result;
struct SequenceQuerySettings;

/// threshold: every pair with a score below t_r. margin: the best match of a query window, if it is
/// by at least X better than the best one elsewhere.
enum class Decision { threshold, margin };
template <>
inline constexpr std::array<std::string_view, 2> kEnumNames<Decision> = {"threshold", "margin"};

/// One row of the table, at the place of its value of Decision, whose name is its name.
struct DecisionKind {
  std::string_view summary = {};  ///< what it asks, for help texts
  std::string_view hits = {};     ///< definition of its hits, for reports; {} is the score
  std::string_view symbol = {};   ///< of its setting: t_r, margin
  ScoreOrder order = {};          ///< distance: more is accepted where its setting is larger
  /// Its setting; none: automatic.
  std::optional<double> SequenceQuerySettings::*setting = nullptr;
  std::span<const std::string_view> settings = {};  ///< keys of settings that only it has

  /// Throws Error(usage) for settings out of range, and those of another decision.
  void (*check)(const SequenceQuerySettings& settings) = nullptr;

  /// Whether the best match of a query window, which has one, is a hit. Null where hits are pairs
  /// below a limit, whether they are best matches or not.
  bool (*accepts)(const Result& result, size_t query_window) = nullptr;
};

std::span<const DecisionKind> decision_kinds();
const DecisionKind& decision_kind(Decision decision);

/// As DecisionKind::check, of the decision that is set.
void check_decision(const SequenceQuerySettings& settings);

}  // namespace vpr
