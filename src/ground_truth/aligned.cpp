#include "ground_truth/aligned.h"

#include <cmath>

#include <fmt/format.h>

#include "base/error.h"
#include "base/text.h"
#include "ground_truth/builder.h"

namespace vpr {

std::string read_aligned(GroundTruthBuilder& builder) {
  const size_t sequence = builder.only_searched("the ground truth \"aligned\"");
  const double step = builder.argument().options.reference_step.value_or(1);
  if (!(step > 0 && step <= 1e6))
    throw Error(ErrorKind::usage, "the reference step must be above 0, and at most a million");
  if (builder.query().grows || builder.train(sequence).grows)
    throw Error(ErrorKind::usage,
                "the ground truth \"aligned\" has no numbers of frames of its own; give them");
  const int tolerance = builder.argument().tolerance_frames;
  const double end = static_cast<double>(builder.train(sequence).frames) + tolerance;
  for (size_t frame = 0; frame < builder.query().frames; ++frame) {
    const double reference = std::floor(step * static_cast<double>(frame) + 0.5);
    if (!(reference < end)) break;
    builder.add_beyond_end(frame, sequence, static_cast<size_t>(reference));
  }
  const std::string of_query = step == 1 ? "i" : fmt::format("{} i", step);
  return fmt::format("aligned: query frame i is training frame {}, within {}", of_query,
                     counted(static_cast<uint64_t>(tolerance), "frame"));
}

}  // namespace vpr
