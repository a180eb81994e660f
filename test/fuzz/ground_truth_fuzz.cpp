// Any bytes as a ground truth of every format of a file: they are refused with an Error, or yield a
// valid ground truth.
#include <algorithm>

#include "fuzz.h"
#include "truth/formats.h"
#include "truth/ground_truth.h"

using namespace vpr;
using fuzz::require;

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

// Reads with and without the options that a format uses, and by time.
void read_as(const GroundTruthFormat& format, const std::filesystem::path& file) {
  const auto uses = [&](std::string_view option) {
    return std::ranges::find(format.options, option) != format.options.end();
  };
  GroundTruthArgument argument{std::string(format.name), file};
  read(argument, 3, 4);
  read(argument, kUnknownFrames, kUnknownFrames);
  if (uses("reference")) argument.options.reference = file;
  if (uses("radius_m")) argument.options.radius_m = 25;
  if (uses("angle_deg")) argument.options.angle_deg = 40;
  read(argument, 3, 4);
  read(argument, 3, 3);
  read(argument, kUnknownFrames, kUnknownFrames);
  if (!uses("times")) return;
  argument.options.query.times = argument.options.train.times = file;
  argument.options.max_difference_s = 0.5;
  read(argument, kUnknownFrames, kUnknownFrames);
  argument.options.query.pose_times = argument.options.train.pose_times = file;
  read(argument, 3, 3);
}

}  // namespace

void fuzz::run(std::string_view input) {
  const std::filesystem::path file = memory_file(input);
  refuses([&] { detect_format(file); });
  for (const GroundTruthFormat& format : ground_truth_formats())
    if (format.name != "aligned" && format.name != "utm")  // these two read no file
      read_as(format, file);
}
