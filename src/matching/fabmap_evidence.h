// Why FAB-MAP takes a frame for a view: what each word says.
#pragma once

#include <span>
#include <vector>

#include "matching/fabmap_model.h"

namespace vpr {

/// What one word says for or against a view.
struct WordEvidence {
  uint32_t word = 0;
  bool in_frame = false;
  bool in_view = false;
  /// log P(z_q | z_parent, view) - log P(z_q | z_parent, new place by mean field): above 0 speaks
  /// for the view. Over all words they add up to the log-odds of the view against that new place.
  double log_odds = 0;
};

/// Every word of the model, those that speak for the view first; ties to the lower word. `frame`
/// and `view`: word ids, rising, each once.
std::vector<WordEvidence> word_evidence(const FabmapModel& model, std::span<const uint32_t> frame,
                                        std::span<const uint32_t> view);

}  // namespace vpr
