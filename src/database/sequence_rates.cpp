#include "database/sequence_rates.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "base/json.h"
#include "images/selection.h"

namespace vpr {
namespace {

constexpr const char* kKeptFile = "kept.npy";

double read_fps(const Archive& archive, const Json& json) {
  const auto found = json.find("fps");
  if (found == json.end() || !found->is_number()) archive.fail("\"fps\" is no number");
  const auto fps = found->get<double>();
  if (!(fps > 0 && std::isfinite(fps))) archive.fail("\"fps\" is out of range");
  return fps;
}

void read_kept(const Archive& archive, std::vector<TrainSequence>& sequences) {
  const Json& list = archive.manifest()["sequences"];
  const auto is_thinned = [](const Json& json) { return json.contains("thinned"); };
  if (std::none_of(list.begin(), list.end(), is_thinned)) return;
  const NpyArray array = archive.array(kKeptFile);
  const auto rows = array.values<int32_t>(1);
  size_t next = 0;
  for (size_t s = 0; s < sequences.size(); ++s) {
    if (!is_thinned(list[s])) continue;
    const Json& json = list[s]["thinned"];
    if (!json.is_object()) archive.fail("\"thinned\" is no object");
    const size_t frames = sequences[s].frame_count();
    if (frames > rows.size() - next) archive.fail("kept.npy does not fit its sequences");
    auto kept = kept_frames(rows.subspan(next, frames), manifest_count(archive, json, "frames"),
                            read_fps(archive, json));
    if (!kept) archive.fail("kept.npy holds frames out of range or order");
    sequences[s].kept = std::move(kept);
    next += frames;
  }
  if (next != rows.size()) archive.fail("kept.npy does not fit its sequences");
}

}  // namespace

void add_rate(Json& json, const TrainSequence& sequence) {
  if (sequence.fps) json["fps"] = *sequence.fps;
  if (sequence.kept)
    json["thinned"] = {{"fps", sequence.kept->fps}, {"frames", sequence.kept->recorded_frames}};
}

void write_kept(ArchiveWriter& writer, const std::vector<TrainSequence>& sequences) {
  std::vector<int32_t> rows;
  for (const TrainSequence& sequence : sequences)
    if (sequence.kept)
      rows.insert(rows.end(), sequence.kept->sources.begin(), sequence.kept->sources.end());
  if (!rows.empty()) writer.add_array(kKeptFile, std::span<const int32_t>(rows), {rows.size()});
}

void read_rates(const Archive& archive, std::vector<TrainSequence>& sequences) {
  const Json& list = archive.manifest()["sequences"];
  for (size_t s = 0; s < sequences.size(); ++s)
    if (list[s].contains("fps")) sequences[s].fps = read_fps(archive, list[s]);
  read_kept(archive, sequences);
}

}  // namespace vpr
