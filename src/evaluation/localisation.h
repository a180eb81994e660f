// How well somebody who walks the query knows where they are.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "evaluation/outcomes.h"

namespace vpr {

/// A frame of the path: a correct recognition, an incorrect one, one that is not judged (a pair
/// labelled ignore, which counts as none), or none.
enum class Fix { none, right, wrong, unjudged };

/// Metres are none where positions are not known.
struct Localisation {
  size_t frames = 0;  ///< of the whole path, frames before the first whole window included
  size_t right = 0;
  size_t wrong = 0;
  size_t longest_gap_frames = 0;           ///< frames in a row without a right fix
  std::optional<double> longest_gap_m;     ///< walked from a right fix to the next (the path's ends
                                           ///< stand for fixes that are not there)
  std::optional<size_t> first_fix_frames;  ///< frames before the first right fix; none: no fix
  std::optional<double> first_fix_m;       ///< walked before it

  /// right / frames; none for an empty path.
  std::optional<double> share() const;
};

/// `travelled_m`: way from the start to each frame, or empty. As long as `fixes` otherwise.
Localisation localise(std::span<const Fix> fixes, std::span<const double> travelled_m);

/// The hit that fixes each query frame, or none: of the window that ends there, of several the one
/// with the best score, ties to the first. They live as long as the result.
std::vector<const Match*> fixing_hits(const Result& result);
/// One fix a frame: the hit of the window that ends there; of several the one with the best score,
/// ties to the first.
std::vector<Fix> fixes_of(const Result& result, const GroundTruth& truth);
/// Best matches whose key is at most `accepted`; none: no fix.
std::vector<Fix> fixes_of(const Outcomes& outcomes, std::optional<uint64_t> accepted);

}  // namespace vpr
