#include "report/fabmap_result_file.h"

#include <limits>

#include "base/json.h"
#include "report/json_fields.h"

namespace vpr {
namespace {

namespace fs = std::filesystem;

constexpr size_t kColumns = 3;  // frame, place, view
constexpr uint64_t kMost = std::numeric_limits<int32_t>::max();

/// Matches as they stand in two arrays: indices, -1 for none, and probabilities.
struct MatchColumns {
  std::vector<int32_t> indices;
  std::vector<double> scores;

  void add(const PlaceMatch& match) {
    for (const uint32_t index : {match.frame, match.place, match.view})
      indices.push_back(static_cast<int32_t>(index));
    scores.push_back(match.probability);
  }
  void add_none(size_t frame) {
    indices.insert(indices.end(), {static_cast<int32_t>(frame), -1, -1});
    scores.push_back(0);
  }
};

MatchColumns hit_columns(const FabmapResult& result) {
  MatchColumns columns;
  for (const PlaceMatch& hit : result.hits) columns.add(hit);
  return columns;
}

MatchColumns best_columns(const FabmapResult& result) {
  MatchColumns columns;
  for (size_t frame = 0; frame < result.best.size(); ++frame)
    result.best[frame] ? columns.add(*result.best[frame]) : columns.add_none(frame);
  return columns;
}

std::vector<std::optional<PlaceMatch>> read_matches(const fs::path& path, const std::string& name,
                                                    const Fields& files,
                                                    const FabmapResult& result) {
  const NpyArray indices = read_companion(companion_path(path, name + ".npy"), files.object(name));
  const std::string scores_name = name == "hits" ? "hit_scores" : "best_scores";
  const NpyArray scores =
      read_companion(companion_path(path, scores_name + ".npy"), files.object(scores_name));
  const auto values = indices.values<int32_t>(2);
  const auto probabilities = scores.values<double>(1);
  if (indices.shape()[1] != kColumns || probabilities.size() != indices.shape()[0])
    files.fail(name + ".npy and its scores do not fit");
  std::vector<std::optional<PlaceMatch>> matches;
  for (size_t i = 0; i < probabilities.size(); ++i) {
    const int32_t* row = values.data() + i * kColumns;
    const auto inside = [](int32_t value, size_t count) {
      return value >= 0 && static_cast<size_t>(value) < count;
    };
    if (inside(row[0], result.query_frames) && row[1] == -1) {
      matches.emplace_back();
    } else if (inside(row[0], result.query_frames) && inside(row[1], result.places.size()) &&
               inside(row[2], result.views)) {
      matches.emplace_back(PlaceMatch{static_cast<uint32_t>(row[0]), static_cast<uint32_t>(row[1]),
                                      static_cast<uint32_t>(row[2]), probabilities[i]});
    } else {
      files.fail(name + ".npy holds an index that is out of range");
    }
  }
  return matches;
}

}  // namespace

void claim_fabmap_result(const fs::path& path, OutputTransaction& outputs) {
  outputs.claim_file(path);
  for (const char* kind :
       {"hits.npy", "hit_scores.npy", "best.npy", "best_scores.npy", "new_place.npy"})
    outputs.claim_file(companion_path(path, kind));
}

Json fabmap_result_json(const FabmapResult& result, const ResultContext& context) {
  Json json = {{"schema", "vpr.result/1"}, {"method", result.settings.method}};
  json["settings"] = value_to_json(result.settings);
  json["query"] = {{"name", result.query_name},
                   {"frames", result.query_frames},
                   {"unreadable", result.query_unreadable},
                   {"featureless", result.query_featureless}};
  json["places"] = result.places;
  json["views"] = result.views;
  json["totals"] = {{"hits", result.hits.size()}};
  if (context.explanation) json["explanation"] = *context.explanation;
  add_context(json, context);
  return json;
}

Json write_fabmap_result(const fs::path& path, const FabmapResult& result,
                         const ResultContext& context, OutputTransaction& outputs) {
  Json json = fabmap_result_json(result, context);
  const MatchColumns hits = hit_columns(result);
  const MatchColumns best = best_columns(result);
  Json& files = json["files"];
  const auto add = [&]<class T>(const std::string& name, const std::vector<T>& values,
                                const std::vector<size_t>& shape) {
    files[name] = write_companion(outputs.file(companion_path(path, name + ".npy")),
                                  std::span<const T>(values), shape);
  };
  add("hits", hits.indices, {hits.scores.size(), kColumns});
  add("hit_scores", hits.scores, {hits.scores.size()});
  add("best", best.indices, {best.scores.size(), kColumns});
  add("best_scores", best.scores, {best.scores.size()});
  add("new_place", result.new_place, {result.new_place.size()});
  add_result_checksum(json);
  outputs.file(path).write(to_text(json));
  return json;
}

StoredFabmapResult read_fabmap_result(const fs::path& path) {
  const std::string where = path.string();
  const Json json = read_result_json(path);
  const Fields fields(json, where);
  StoredFabmapResult stored;
  stored.fingerprint = fields.text("checksum");
  FabmapResult& result = stored.result;
  stored_settings_from_json(json, result.settings, where);
  const Fields query = fields.object("query");
  result.query_name = query.text("name");
  result.query_frames = query.count("frames", kMost);
  result.query_unreadable = read_frame_list(query, "unreadable", result.query_frames);
  result.views = fields.count("views", kMost);
  for (const Json& name : fields.list("places")) {
    if (!name.is_string()) fields.fail("the name of a place is no text");
    result.places.push_back(name.get<std::string>());
  }
  const Fields files = fields.object("files");
  for (const auto& hit : read_matches(path, "hits", files, result)) {
    if (!hit) files.fail("hits.npy holds a hit without a place");
    result.hits.push_back(*hit);
  }
  result.best = read_matches(path, "best", files, result);
  if (result.best.size() != result.query_frames) files.fail("best.npy does not fit the query");
  const NpyArray new_place =
      read_companion(companion_path(path, "new_place.npy"), files.object("new_place"));
  const auto probabilities = new_place.values<double>(1);
  result.new_place.assign(probabilities.begin(), probabilities.end());
  if (result.new_place.size() != result.query_frames)
    files.fail("new_place.npy does not fit the query");
  return stored;
}

}  // namespace vpr
