#include "selection_flags.h"

#include <algorithm>

#include "base/named_table.h"
#include "sequence/selection.h"
#include "truth/formats.h"
#include "truth/sequence_rate.h"

namespace vpr {

void add_rate_flags(const Command& command, SelectionFlags& flags, const std::string& sequences) {
  command
      .add_option("--fps", flags.fps,
                  "thin " + sequences +
                      " to so many frames a second, by the times of frames; a ground truth stays "
                      "that of all frames")
      .type_name("NUMBER");
  command
      .add_option("--recorded-fps", flags.recorded_fps,
                  "frames a second as they were recorded, where neither times, a video nor a data "
                  "set says it")
      .type_name("NUMBER");
}

void check_rates(const SelectionFlags& flags) {
  if (flags.fps) check_fps(*flags.fps, "--fps");
  if (flags.recorded_fps) check_fps(*flags.recorded_fps, "--recorded-fps");
}

void leave_times_to_rate(GroundTruthArgument& truth, const SelectionFlags& flags) {
  if (!flags.fps || truth.options.query_times.empty()) return;
  const auto formats = ground_truth_formats();
  const auto named = std::ranges::find(formats, truth.format, &GroundTruthFormat::name);
  const GroundTruthFormat* format = truth.format.empty()     ? &detect_format(truth.path)
                                    : named != formats.end() ? &*named
                                                             : nullptr;
  if (format == nullptr || std::ranges::find(format->options, "times") == format->options.end())
    truth.options.query_times.clear();
}

SequenceArgument selected(SequenceArgument argument, const SelectionFlags& flags,
                          const std::filesystem::path& times, const Dataset* dataset,
                          const Session& session) {
  check_rates(flags);
  RateSource source{times, flags.recorded_fps};
  if (!source.recorded_fps && dataset != nullptr && dataset->frames_per_second > 0)
    source.recorded_fps = dataset->frames_per_second;
  if (!source.recorded_fps) source.recorded_fps = flags.otherwise;
  argument.warp = flags.warp;
  argument.seed = session.options.seed;
  return with_rate(std::move(argument), source, flags.fps, session.monitor);
}

Flag add_warp_flag(const Command& command, std::string& warp, const std::string& about) {
  std::vector<std::string> names = names_of(warp_rules());
  names.emplace_back("NUMBER");
  command.add_footer("Warps:\n" + warp_summaries());
  return command.add_option("--warp", warp, about).choices("WARP", names);
}

}  // namespace vpr
