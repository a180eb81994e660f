// The explanation of a recognition by FAB-MAP, as stored in a result.
#pragma once

#include <string>
#include <vector>

#include "decide/clustering.h"
#include "words/model.h"

namespace vpr {

/// A likely place of a frame, with the words for and against it.
struct PlaceExplanation {
  Match match;
  std::string place;
  std::string view;     ///< "<group>: <name of the frame>"
  double log_odds = 0;  ///< of the view against a new place by mean field
  // Words in the frame or in the view, strongest first.
  std::vector<WordEvidence> for_it;
  std::vector<WordEvidence> against;
};

struct Explanation {
  size_t frame = 0;
  double new_place = 0;  ///< its posterior
  std::vector<PlaceExplanation> places;
};

VPR_FIELDS(WordEvidence, word, in_frame, in_view, log_odds)

template <class Visitor>
void visit_fields(PlaceExplanation& explained, Visitor&& visit) {
  visit("place", explained.place);
  visit("view", explained.view);
  visit("probability", explained.match.score);
  visit("log_odds", explained.log_odds);
  visit("for", explained.for_it);
  visit("against", explained.against);
}

VPR_FIELDS(Explanation, frame, new_place, places)

}  // namespace vpr
