// A sequence of frames to a sequence of codes.
#pragma once

#include <string>
#include <vector>

#include "base/matrix_view.h"
#include "base/monitor.h"
#include "descriptors/ldb.h"
#include "images/frames.h"
#include "images/sequence.h"

namespace vpr {

struct LdbSettings {
  bool illumination_invariant = false;  ///< decode in colour and remove the light's colour first
};

template <class Visitor>
void visit_fields(LdbSettings& settings, Visitor&& visit) {
  visit("illumination_invariant", settings.illumination_invariant);
}

/// Codes of the frames of one sequence, all zero for an unreadable one.
struct SequenceCodes {
  std::vector<LdbCode> codes;
  FrameList frames;
};

/// Decodes and describes in parallel, no frame kept. Same result for any number of threads.
/// Throws what for_each_frame throws.
SequenceCodes describe_sequence(const Sequence& sequence, const LdbSettings& settings,
                                Unreadable unreadable, const Monitor& monitor);

}  // namespace vpr
