// The flags of a matrix of scores: --scores of vpr-query and vpr-eval.
#pragma once

#include <string>

#include "command.h"
#include "decide/score_kind.h"
#include "match/given_distances.h"

namespace vpr {

struct ScoreFlags {
  std::string path;  ///< empty: none
  bool is_distance = false;
  bool is_similarity = false;
  bool references_first = false;
  std::optional<double> missing;

  bool has_order() const { return is_distance || is_similarity; }
  ScoreOrder order() const { return is_similarity ? ScoreOrder::similarity : ScoreOrder::distance; }
  ScoreFormat format() const { return {is_similarity, references_first, missing}; }
};

/// Adds the flags to a group of the help; `help`: of --scores.
void add_score_flags(const Command& command, ScoreFlags& flags, const std::string& help,
                     const std::string& group);

/// Throws Error(usage) unless --distance or --similarity is given.
void require_order(const ScoreFlags& flags);

/// Throws Error(usage) "FLAG WHY" if it is given.
void refuse(bool is_given, const std::string& flag, const std::string& why);

/// Throws like that for the first flag, other than --scores, that describes a matrix.
void refuse_format(const ScoreFlags& flags, const std::string& why);

}  // namespace vpr
