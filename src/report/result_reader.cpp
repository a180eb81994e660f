// Reading of result files: nothing that they say is trusted.
#include <limits>
#include <tuple>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "base/checksum.h"
#include "base/error.h"
#include "base/json.h"
#include "base/npy.h"
#include "database/archive.h"
#include "report/json_fields.h"
#include "report/result_arrays.h"
#include "report/result_file.h"

namespace vpr {
namespace {

namespace fs = std::filesystem;

constexpr int kVersion = 2;
constexpr uint64_t kMostFrames = std::numeric_limits<int32_t>::max();

// The sum of a row that a score is: `offset` above it.
uint32_t read_sum(const Fields& item, const std::string& key, int64_t offset) {
  constexpr int64_t kMost = int64_t{1} << 33;  // more than any sum: adding the offset is safe
  const Json& value = item[key];
  const auto number = value.is_number_integer() ? value.get<int64_t>() : kMost;
  if (number <= -kMost || number >= kMost || !std::in_range<uint32_t>(number + offset))
    item.fail(fmt::format("\"{}\" is no number in range", key));
  return static_cast<uint32_t>(number + offset);
}

void read_settings(const Json& json, const ResultSource& source, Result& result) {
  const auto read = [&](auto settings) {
    stored_settings_from_json(json, settings, source.where);
    result.settings = std::move(settings);
  };
  if (source.fields.text("method") == FabmapQuerySettings{}.method)
    read(FabmapQuerySettings{});
  else
    read(SequenceQuerySettings{});
  const size_t length = result.window_length();
  const size_t longest = result.score().longest_window;
  if (length == 0 || (longest > 0 && length > longest))
    source.fields.fail("its c_l is out of range");
}

void read_query(const ResultSource& source, Result& result) {
  const Fields query = source.fields.object("query");
  result.query_name = query.text("name");
  result.query_frames = query.count("frames", kMostFrames);
  result.query_windows = query.count("windows", result.query_frames);
  if (result.query_windows != window_count(result.query_frames, result.window_length()))
    source.fields.fail("its numbers of windows and frames do not fit");
  if (query.has("fps")) result.query_fps = read_fps(query);
  result.query_unreadable = read_frame_list(query, "unreadable", result.query_frames);
}

void read_threshold(const Fields& item, const Json& json, const Result& result, Target& target) {
  if (item["t_r"].is_number()) target.threshold = item["t_r"].get<double>();
  const auto scale = enum_value<ThresholdScale>(item.text("t_r_scale"));
  if (!scale) item.fail("\"t_r_scale\" is no scale");
  target.scale = *scale;
  target.distance_limit = read_sum(item, "limit", offset_of(result));
  if (json.contains("margin")) {
    if (!item["margin"].is_number()) item.fail("\"margin\" is no number");
    target.margin = item["margin"].get<double>();
  }
  if (json.contains("max_distance")) target.max_distance = read_sum(item, "max_distance", 0);
}

void read_targets(const ResultSource& source, Result& result) {
  for (const Json& json : source.fields.list("targets")) {
    const Fields item(json, source.where);
    Target& target = result.targets.emplace_back();
    target.name = item.text("name");
    target.frames = item.count("frames", kMostFrames);
    target.windows = item.count("windows", window_count(target.frames, result.window_length()));
    if (!item["searched"].is_boolean()) item.fail("\"searched\" is neither true nor false");
    target.searched = item["searched"].get<bool>();
    if (item.has("fps")) target.fps = read_fps(item);
    if (target.searched && !result.places) read_threshold(item, json, result, target);
  }
}

void read_places(const ResultSource& source, Result& result) {
  const Fields places = source.fields.object("places");
  result.places.emplace();
  result.places->views = places.count("views", kMostFrames);
  for (const Json& name : places.list("names")) {
    if (!name.is_string()) places.fail("the name of a place is no text");
    result.places->names.push_back(name.get<std::string>());
  }
  const Fields query = source.fields.object("query");
  if (query.has("featureless"))
    result.places->featureless = query.count("featureless", result.query_frames);
}

void check_places(const ResultSource& source, const Result& result) {
  if (result.targets.size() != 1 || result.targets[0].frames != result.places->names.size())
    source.fields.fail("its places and its target do not fit");
}

uint32_t read_window(const Fields& extent, const std::string& key, uint64_t windows) {
  if (windows == 0) extent.fail("a cluster lies in a sequence without windows");
  return static_cast<uint32_t>(extent.count(key, windows - 1));
}

Cluster read_cluster(const Fields& item, const Result& result) {
  Cluster cluster;
  cluster.target = static_cast<uint32_t>(item.count("target", kMostFrames));
  if (cluster.target >= result.targets.size()) item.fail("a cluster's target is out of range");
  const Fields query = item.object("query");
  const Fields train = item.object("train");
  const uint64_t windows =
      window_count(result.targets[cluster.target].frames, result.window_length());
  cluster.query_window = read_window(query, "window", result.query_windows);
  cluster.query_first = read_window(query, "first", result.query_windows);
  cluster.query_last = read_window(query, "last", result.query_windows);
  cluster.train_window = read_window(train, "window", windows);
  cluster.train_first = read_window(train, "first", windows);
  cluster.train_last = read_window(train, "last", windows);
  cluster.hits = item.count("hits", std::numeric_limits<uint64_t>::max());
  const int64_t offset = offset_of(result);
  cluster.best_score = static_cast<double>(read_sum(item, "best_score", offset) - offset);
  return cluster;
}

// The clusters that the file claims are those of its hits.
void read_clusters(const ResultSource& source, Result& result, const Monitor& monitor) {
  const int64_t eps = std::get<SequenceQuerySettings>(result.settings).clustering.eps;
  if (eps < 0 || eps > kMaxEps) source.fields.fail("its clustering.eps is out of range");
  std::vector<Cluster> claimed;
  for (const Json& item : source.fields.list("clusters"))
    claimed.push_back(read_cluster(Fields(item, source.where), result));
  cluster(result, monitor);
  if (result.clusters->all != claimed) source.fields.fail("its clusters are not those of its hits");
}

// Files beside the result, of names that its user chose. They may be gone, but not of another run.
void check_companions(const ResultSource& source, const Json& companions, const Monitor& monitor) {
  if (!companions.is_object()) source.fields.fail("\"companions\" is not an object");
  for (const auto& [name, sum] : companions.items()) {
    if (fs::path(name).filename() != name || !sum.is_string())
      source.fields.fail("\"companions\" holds what is not a file name with a checksum");
    const fs::path path = source.path.parent_path() / name;
    std::error_code error;
    if (fs::is_regular_file(path, error) && file_checksum(path, monitor) != sum)
      throw Error(ErrorKind::data,
                  fmt::format("{}: belongs to another run than {}; run vpr-query again, with "
                              "--force, or remove this file",
                              path.string(), source.where));
  }
}

}  // namespace

Json read_result_json(const fs::path& path) {
  const std::string where = path.string();
  std::error_code ignored;
  if (fs::is_directory(path, ignored))
    throw Error(ErrorKind::data,
                fmt::format("{}: is a {}; give a result of vpr-query (.json)", where,
                            fs::exists(path / kManifestName, ignored) ? "database" : "folder"));
  Json json = read_json(path, ErrorKind::data);
  require_schema(json, "result", where, ErrorKind::data, kVersion);
  const Fields fields(json, where);
  if (fields.text("checksum") != result_checksum(json)) fields.fail("its checksum does not fit");
  return json;
}

StoredResult read_result(const fs::path& path, const Monitor& monitor) {
  const std::string where = path.string();
  const Json json = read_result_json(path);
  const Fields fields(json, where);
  const ResultSource source{path, where, fields};
  StoredResult stored;
  stored.fingerprint = fields.text("checksum");
  Result& result = stored.result;
  read_settings(json, source, result);
  read_query(source, result);
  read_replay(source, result);
  const bool has_places = std::holds_alternative<FabmapQuerySettings>(result.settings);
  if (has_places) read_places(source, result);
  read_targets(source, result);
  read_kept(source, result);
  if (has_places) check_places(source, result);
  read_matches(source, result);
  read_rates(source, result);
  read_path(source, result);
  if (has_places)
    read_new_place(source, result);
  else
    read_clusters(source, result, monitor);
  read_margins(source, result);
  read_views(source, result);
  if (fields.has("companions")) check_companions(source, json["companions"], monitor);
  if (json["files"].contains("matrix"))
    stored.matrix_checksum = fields.object("files").object("matrix").text("checksum");
  if (const Json paths = json.value("machine", Json()); paths.contains("paths"))
    for (const auto& [role, named] : paths["paths"].items())
      if (named.is_string()) stored.paths[role] = named.get<std::string>();
  return stored;
}

}  // namespace vpr
