#include "truth/presets.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "base/named_table.h"
#include "base/text.h"

namespace vpr {
namespace {

// docs/ground_truth.md has the sources with links.
constexpr std::array<GroundTruthPreset, 4> kPresets = {{
    {"nordland-exact", 0, 1, "the frame itself"},
    {"nordland-vpr-bench", 1, 10,
     "VPR-Bench, GSV-Cities, BoQ: one frame, every tenth frame is a query"},
    {"nordland-patch-netvlad", 2, 1, "Patch-NetVLAD, SelaVPR: two frames"},
    {"nordland-25m", 10, 1, "VPR-datasets-downloader: 25 m, which is ten frames"},
}};

constexpr std::string_view kAll = "-all";

bool is_of_data_set(const GroundTruthPreset& preset, std::string_view group) {
  return group.ends_with(kAll) && group.size() > kAll.size() &&
         preset.name.starts_with(group.substr(0, group.size() - kAll.size() + 1));
}

uint32_t step_for(const GroundTruthPreset& preset, const GroundTruthScope& scope) {
  for (const auto& sequence : scope.sequences)
    if (sequence.searched && scope.query.frames > 1 &&
        (sequence.sequence.frames + preset.reference_step - 1) / preset.reference_step ==
            scope.query.frames)
      return preset.reference_step;
  return 1;
}

}  // namespace

std::span<const GroundTruthPreset> ground_truth_presets() { return kPresets; }

const GroundTruthPreset* find_preset(std::string_view name) {
  const auto* found = std::find_if(kPresets.begin(), kPresets.end(),
                                   [&](const auto& preset) { return preset.name == name; });
  return found == kPresets.end() ? nullptr : found;
}

std::vector<const GroundTruthPreset*> find_presets(const std::string& text) {
  std::vector<const GroundTruthPreset*> found;
  for (const std::string_view name : split(text, ',')) {
    const size_t before = found.size();
    for (const GroundTruthPreset& preset : kPresets)
      if (preset.name == name || is_of_data_set(preset, name)) found.push_back(&preset);
    if (found.size() > before) continue;
    std::vector<std::string> names = names_of(kPresets);
    names.insert(names.begin(), "nordland-all");
    refuse_name("protocol", name, names);
  }
  return found;
}

GroundTruthArgument preset_argument(const GroundTruthPreset& preset,
                                    const GroundTruthArgument& given,
                                    const GroundTruthScope& scope) {
  if (given.tolerance_frames != 0 && given.tolerance_frames != preset.tolerance_frames)
    throw Error(ErrorKind::usage,
                fmt::format("{} has a tolerance of {} frames, not {}; use aligned for others",
                            preset.name, preset.tolerance_frames, given.tolerance_frames));
  GroundTruthArgument argument = given;
  argument.format = "aligned";
  argument.tolerance_frames = preset.tolerance_frames;
  if (!argument.options.reference_step) argument.options.reference_step = step_for(preset, scope);
  return argument;
}

std::string preset_protocol(const GroundTruthPreset& preset, const std::string& protocol) {
  return fmt::format("{} ({}): {}", preset.name, preset.source, protocol);
}

}  // namespace vpr
