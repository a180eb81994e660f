#include "sequence/sequence.h"

#include <limits>
#include <utility>

#include "base/json_fields.h"

namespace vpr {

namespace {

bool needs_sources(const Selection& selection) {
  return !selection.warp.empty() || selection.thinned_fps > 0;
}

// Whether the rows are valid frames of the recording. Frames of a thinned sequence increase.
bool add_sources(Selection& selection, std::span<const int32_t> rows) {
  for (const int32_t row : rows) {
    const bool does_rise = !selection.warp.empty() || selection.is_all() ||
                           int64_t{row} > int64_t{selection.sources.back()};
    if (row < 0 || static_cast<size_t>(row) >= selection.recorded_frames || !does_rise)
      return false;
    selection.sources.push_back(static_cast<uint32_t>(row));
  }
  return true;
}

}  // namespace

Sequence selected(Sequence recorded, const Selection& selection) {
  if (selection.is_all()) return recorded;
  Sequence sequence = std::move(recorded);
  sequence.frames = selection.frames();
  if (!sequence.frame_names.empty())
    sequence.frame_names = selected(std::move(sequence.frame_names), selection);
  sequence.unreadable = selected_frames(selection, std::move(sequence.unreadable));
  sequence.selection = composed(sequence.selection, selection);
  return sequence;
}

void add_selection(Json& json, const Selection& selection) {
  if (!selection.warp.empty())
    json["warp"] = {
        {"name", selection.warp}, {"seed", selection.seed}, {"frames", selection.recorded_frames}};
  if (selection.thinned_fps > 0)
    json["thinned"] = {{"fps", selection.thinned_fps}, {"frames", selection.recorded_frames}};
}

Selection read_selection(const Fields& fields,
                         const std::function<uint64_t(const Selection&)>& max_recorded) {
  Selection selection;
  if (fields.has("thinned")) {
    const Fields thinned = fields.object("thinned");
    selection.thinned_fps = read_fps(thinned);
    selection.recorded_frames = thinned.count("frames", max_recorded(selection));
  }
  if (fields.has("warp")) {
    const Fields warp = fields.object("warp");
    selection.warp = warp.text("name");
    selection.seed = warp.count("seed", std::numeric_limits<uint64_t>::max());
    selection.recorded_frames = warp.count("frames", max_recorded(selection));
  }
  return selection;
}

Json sequence_json(const Sequence& sequence, const Json& own) {
  Json json = {{"name", sequence.name}, {"frames", sequence.frames}};
  json.update(own);
  if (sequence.fps) json["fps"] = *sequence.fps;
  add_selection(json, sequence.selection);
  return json;
}

Sequence read_sequence(const Fields& fields, uint64_t most_frames) {
  Sequence sequence{fields.text("name"), fields.count("frames", most_frames)};
  if (fields.has("unreadable"))
    for (const Json& frame : fields.list("unreadable")) {
      const std::vector<size_t>& before = sequence.unreadable;
      if (!frame.is_number_unsigned() || frame.get<uint64_t>() >= sequence.frames ||
          (!before.empty() && frame.get<uint64_t>() <= before.back()))
        fields.fail("\"unreadable\" holds what is no frame, or out of order");
      sequence.unreadable.push_back(frame.get<size_t>());
    }
  if (fields.has("fps")) sequence.fps = read_fps(fields);
  sequence.selection = read_selection(fields, [&](const Selection& selection) {
    const uint64_t thinning = selection.thinned_fps > 0 ? kMostThinned : 1;
    const uint64_t warping = selection.warp.empty() ? 1 : static_cast<uint64_t>(kFastestPace);
    return thinning * warping * sequence.frames;
  });
  return sequence;
}

std::vector<int32_t> source_rows(std::span<const Sequence* const> sequences) {
  std::vector<int32_t> rows;
  for (const Sequence* sequence : sequences)
    rows.insert(rows.end(), sequence->selection.sources.begin(), sequence->selection.sources.end());
  return rows;
}

void read_sources(std::span<Sequence* const> sequences,
                  const std::function<std::vector<int32_t>()>& open_rows,
                  const std::function<void()>& fail) {
  const auto needs = [](const Sequence* sequence) { return needs_sources(sequence->selection); };
  if (std::ranges::none_of(sequences, needs)) return;
  const std::vector<int32_t> all = open_rows();
  std::span<const int32_t> rows = all;
  for (Sequence* sequence : sequences) {
    if (!needs(sequence)) continue;
    if (sequence->frames > rows.size()) fail();
    if (!add_sources(sequence->selection, rows.first(sequence->frames))) fail();
    rows = rows.subspan(sequence->frames);
  }
  if (!rows.empty()) fail();
}

}  // namespace vpr
