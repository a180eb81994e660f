// Reads result files: nothing that they contain is trusted.
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "base/checksum.h"
#include "base/error.h"
#include "base/json.h"
#include "base/json_fields.h"
#include "base/npy.h"
#include "present/result_file.h"
#include "store/archive.h"

namespace vpr {
namespace {

namespace fs = std::filesystem;

constexpr int kVersion = 2;
constexpr uint64_t kMostFrames = std::numeric_limits<int32_t>::max();

/// A result file that is being read.
struct ResultSource {
  const fs::path& path;
  const std::string& where;
  const Fields& fields;

  bool has(const std::string& name) const { return fields.object("files").has(name); }
  /// The array of that name next to the result. Throws Error(data) if it is not the one that the
  /// JSON was written with.
  NpyArray open(const std::string& name) const {
    const fs::path file = companion_path(path, name + ".npy");
    NpyArray array(file);
    if (checksum(array.file_bytes()) != fields.object("files").object(name).text("checksum"))
      throw Error(ErrorKind::data,
                  fmt::format("{}: belongs to another run than its .json file, or is damaged; run "
                              "vpr-query again, with --force",
                              file.string()));
    return array;
  }
};

// The difference between a sum over a window, as rows of matchers hold it, and the score in files;
// 0 where scores are not sums.
int64_t offset_of(const Result& result) {
  const auto offset = result.score().offset;
  return offset == nullptr ? 0 : offset(result.window_length());
}

uint64_t window_count(uint64_t frames, uint64_t window_length) {
  return frames < window_length ? 0 : frames - window_length + 1;
}

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
  result.query = read_sequence(query, kMostFrames);
  result.query_windows = query.count("windows", result.query.frames);
  if (result.query_windows != window_count(result.query.frames, result.window_length()))
    source.fields.fail("its numbers of windows and frames do not fit");
}

void read_threshold(const Fields& item, const Result& result, Target& target) {
  if (item["t_r"].is_number()) target.threshold = item["t_r"].get<double>();
  const auto scale = enum_value<ThresholdScale>(item.text("t_r_scale"));
  if (!scale) item.fail("\"t_r_scale\" is no scale");
  target.scale = *scale;
  target.distance_limit = read_sum(item, "limit", offset_of(result));
  if (item.has("margin")) {
    if (!item["margin"].is_number()) item.fail("\"margin\" is no number");
    target.margin = item["margin"].get<double>();
  }
  if (item.has("max_distance")) target.max_distance = read_sum(item, "max_distance", 0);
}

void read_targets(const ResultSource& source, Result& result) {
  for (const Json& json : source.fields.list("targets")) {
    const Fields item(json, source.where);
    Target& target = result.targets.emplace_back();
    target.sequence = read_sequence(item, kMostFrames);
    target.windows =
        item.count("windows", window_count(target.sequence.frames, result.window_length()));
    if (!item["searched"].is_boolean()) item.fail("\"searched\" is neither true nor false");
    target.searched = item["searched"].get<bool>();
    if (target.searched && !result.places) read_threshold(item, result, target);
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
    result.places->featureless = query.count("featureless", result.query.frames);
}

// The array of that name next to the result.
void read_selected(const ResultSource& source, const std::vector<Sequence*>& sequences,
                   const std::string& name) {
  read_sources(
      sequences,
      [&] {
        const NpyArray array = source.open(name);
        const auto rows = array.values<int32_t>(1);
        return std::vector<int32_t>(rows.begin(), rows.end());
      },
      [&] { source.fields.fail(name + ".npy does not fit its sequences"); });
}

void read_selections(const ResultSource& source, Result& result) {
  read_selected(source, {&result.query}, "source_frames");
  std::vector<Sequence*> train;
  for (Target& target : result.targets) train.push_back(&target.sequence);
  read_selected(source, train, "train_source_frames");
}

constexpr double kMostSum = 4294967295.0;  // over a window

// Whether a window, or a place, may have such a score.
bool is_score(double score, const Result& result) {
  if (!std::isfinite(score)) return false;
  if (result.places) return true;
  const double sum = score + static_cast<double>(offset_of(result));
  return sum >= 0 && sum <= kMostSum && std::floor(score) == score;
}

bool is_inside(const Match& match, const Result& result) {
  if (match.query >= result.query_windows || match.target >= result.targets.size()) return false;
  const uint64_t windows =
      window_count(result.targets[match.target].sequence.frames, result.window_length());
  return match.train < windows && (!result.places || match.view < result.places->views) &&
         is_score(match.score, result);
}

/// Rows of recognitions.npy or best.npy with their scores; none where a query has no best match.
std::vector<std::optional<Match>> read_rows(const ResultSource& source, const std::string& name,
                                            const std::string& scores_name, const Result& result) {
  const NpyArray array = source.open(name);
  const auto values = array.values<int32_t>(2);
  const size_t columns = result.places ? 4 : 3;  // query, target, train, and the view of a place
  const fs::path path = companion_path(source.path, name + ".npy");
  if (array.shape()[1] != columns)
    source.fields.fail(path.filename().string() + " has other columns");
  const NpyArray score_array = source.open(scores_name);
  const auto scores = score_array.values<double>(1);
  if (scores.size() != array.shape()[0])
    source.fields.fail(name + ".npy and its scores do not fit");
  std::vector<std::optional<Match>> matches;
  for (size_t i = 0; i < array.shape()[0]; ++i) {
    const int32_t* row = values.data() + i * columns;
    if (row[2] == -1) {
      matches.emplace_back();
      continue;
    }
    // A negative index becomes one that is out of range.
    const auto at = [&](size_t column) { return static_cast<uint32_t>(row[column]); };
    const Match match{at(0), at(1), at(2), result.places ? at(3) : 0, scores[i]};
    if (!is_inside(match, result))
      throw Error(ErrorKind::data,
                  fmt::format("{}: an index or a score is out of range; run vpr-query again",
                              path.string()));
    matches.emplace_back(match);
  }
  return matches;
}

// The first frames of one sequence's views: rows from `row` on.
std::vector<uint32_t> take_views(std::span<const int32_t> rows, size_t& row, int32_t sequence,
                                 uint64_t frames, const Fields& fields) {
  std::vector<uint32_t> starts;
  for (; 2 * row < rows.size() && rows[2 * row] == sequence; ++row) {
    const int32_t frame = rows[2 * row + 1];
    const bool follows =
        starts.empty() ? frame == 0 : frame > 0 && static_cast<uint32_t>(frame) > starts.back();
    if (!follows || static_cast<uint64_t>(frame) >= frames)
      fields.fail("views.npy holds a frame that is out of range or order");
    starts.push_back(static_cast<uint32_t>(frame));
  }
  if (starts.empty() != (frames == 0)) fields.fail("views.npy does not fit the sequences");
  return starts;
}

void read_matches(const ResultSource& source, Result& result) {
  for (const auto& recognition : read_rows(source, "recognitions", "recognition_scores", result)) {
    if (!recognition) source.fields.fail("recognitions.npy holds a recognition of nothing");
    result.recognitions.push_back(*recognition);
  }
  const auto position = [](const Match& recognition) {
    return std::tie(recognition.query, recognition.target, recognition.train);
  };
  for (size_t h = 1; h < result.recognitions.size(); ++h)
    if (position(result.recognitions[h - 1]) >= position(result.recognitions[h]))
      source.fields.fail("its recognitions are not in order");
  result.best = read_rows(source, "best", "best_scores", result);
  if (result.best.size() != result.query_windows)
    source.fields.fail("best matches do not fit the query");
}

void read_rates(const ResultSource& source, Result& result) {
  if (!source.has("best_rates")) return;
  const NpyArray array = source.open("best_rates");
  const auto rates = array.values<double>(1);
  if (rates.size() != result.query_windows)
    source.fields.fail("best_rates.npy does not fit the query");
  for (size_t window = 0; window < rates.size(); ++window)
    if (std::isnan(rates[window]) == result.best[window].has_value() || rates[window] <= 0)
      source.fields.fail("best_rates.npy holds what is no rate");
  result.best_rates.assign(rates.begin(), rates.end());
}

void read_margins(const ResultSource& source, Result& result) {
  if (!source.has("margins")) return;
  const NpyArray array = source.open("margins");
  const auto values = array.values<double>(1);
  if (values.size() != result.best.size()) source.fields.fail("margins.npy does not fit the query");
  for (size_t window = 0; window < values.size(); ++window) {
    auto& margin = result.margins.emplace_back();
    if (std::isnan(values[window])) continue;
    margin = values[window];
    if (!result.best[window] || result.places || !(*margin >= 0 && *margin <= kMostSum) ||
        std::floor(*margin) != *margin)
      source.fields.fail("margins.npy holds a number out of range");
  }
}

void read_path(const ResultSource& source, Result& result) {
  if (!source.has("path")) return;
  const NpyArray array = source.open("path");
  const auto rows = array.values<double>(2);
  if (array.shape()[1] != 3 || array.shape()[0] != result.query.frames)
    source.fields.fail("path.npy does not fit the query");
  ResultPath& path = result.path.emplace(result.query.frames);
  for (size_t frame = 0; frame < result.query.frames; ++frame) {
    const double nowhere = rows[3 * frame];
    const double rate = rows[3 * frame + 1];
    const double track = rows[3 * frame + 2];
    const bool is_fine = (std::isnan(nowhere) || is_score(nowhere, result)) &&
                         (std::isnan(rate) || (rate >= 0 && rate <= kMostSum)) && track >= 0 &&
                         track <= static_cast<double>(result.query.frames) &&
                         track == std::floor(track);
    if (!is_fine) source.fields.fail("path.npy holds a number out of range");
    path.nowhere[frame] = nowhere;
    path.rates[frame] = rate;
    path.tracks[frame] = static_cast<uint32_t>(track);
  }
}

void read_views(const ResultSource& source, Result& result) {
  if (!source.has("views")) return;
  const NpyArray array = source.open("views");
  const auto rows = array.values<int32_t>(2);
  if (array.shape()[1] != 2) source.fields.fail("views.npy has other columns");
  size_t row = 0;
  ResultViews& views = result.views.emplace();
  views.query = take_views(rows, row, -1, result.query.frames, source.fields);
  for (size_t t = 0; t < result.targets.size(); ++t)
    views.train.push_back(take_views(rows, row, static_cast<int32_t>(t),
                                     result.targets[t].sequence.frames, source.fields));
  if (2 * row != rows.size()) source.fields.fail("views.npy does not fit the sequences");
}

void read_new_place(const ResultSource& source, Result& result) {
  const NpyArray array = source.open("new_place");
  const auto values = array.values<double>(1);
  result.places->new_place.assign(values.begin(), values.end());
  if (values.size() != result.query.frames)
    source.fields.fail("new_place.npy does not fit the query");
}

// The clusters that the file claims are those of its recognitions.
void read_clusters(const ResultSource& source, Result& result, const Monitor& monitor) {
  const int64_t eps = std::get<SequenceQuerySettings>(result.settings).clustering.eps;
  if (eps < 0 || eps > kMaxEps) source.fields.fail("its clustering.eps is out of range");
  cluster(result, monitor);
  if (source.fields.list("clusters") != clusters_json(*result.clusters, result.window_length()))
    source.fields.fail("its clusters are not those of its recognitions");
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
  const bool has_places = std::holds_alternative<FabmapQuerySettings>(result.settings);
  if (has_places) read_places(source, result);
  read_targets(source, result);
  read_selections(source, result);
  if (has_places && (result.targets.size() != 1 ||
                     result.targets[0].sequence.frames != result.places->names.size()))
    fields.fail("its places and its target do not fit");
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
