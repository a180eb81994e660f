// Any bytes as a ground truth of one format: they are refused with an Error, or yield a valid
// ground truth.
#include <algorithm>

#include "fuzz.h"
#include "truth/formats.h"
#include "truth/ground_truth.h"

using namespace vpr;
using fuzz::require;

/// The format of this program; each program has its own.
extern const char* const kFuzzedFormat;

namespace {

void require_sound(const InspectedGroundTruth& found) {
  require(found.truth.pairs.size() == found.scope.query.frames);
  for (size_t query = 0; query < found.truth.pairs.size(); ++query) {
    const auto& pairs = found.truth.pairs[query];
    for (size_t i = 0; i < pairs.size(); ++i) {
      require(pairs[i].sequence < found.scope.sequences.size());
      require(pairs[i].first + size_t{pairs[i].further} <
              found.scope.sequences[pairs[i].sequence].sequence.frames);
      if (i > 0 && pairs[i].sequence == pairs[i - 1].sequence)
        require(pairs[i - 1].last() < pairs[i].first);
    }
  }
  summarize(found);
}

// Reads with the sizes of the corpus, and with sizes stated by the file.
void read(const GroundTruthArgument& argument, size_t query_frames, size_t train_frames) {
  fuzz::refuses([&] {
    const InspectedGroundTruth found =
        inspect_ground_truth(argument, {{"", query_frames}, {{{"", train_frames}}}});
    if (found.truth.pairs.size() < 1000 && found.scope.sequences[0].sequence.frames < 1000)
      require_sound(found);
  });
}

}  // namespace

void fuzz::run(std::string_view input) {
  GroundTruthArgument argument;
  argument.format = kFuzzedFormat;
  argument.path = memory_file(input);
  const auto& uses = find_format(argument.format).options;
  for (const auto& option : uses) {
    if (option == "reference") argument.options.reference = argument.path;
    if (option == "radius_m") argument.options.radius_m = 25;
    if (option == "angle_deg") argument.options.angle_deg = 40;
  }
  refuses([&] { detect_format(argument.path); });  // any format
  read(argument, 3, 4);
  read(argument, 3, 3);
  read(argument, kUnknownFrames, kUnknownFrames);
  // Other options: anchors without poses, and poses by time.
  if (argument.format == "anchors") {
    argument.options = {};
    read(argument, 3, 4);
    read(argument, kUnknownFrames, kUnknownFrames);
  }
  if (std::find(uses.begin(), uses.end(), "times") == uses.end()) return;
  argument.options.query_times = argument.options.train_times = argument.path;
  argument.options.max_difference_s = 0.5;
  read(argument, kUnknownFrames, kUnknownFrames);
  argument.options.query_pose_times = argument.options.train_pose_times = argument.path;
  read(argument, 3, 3);
}
