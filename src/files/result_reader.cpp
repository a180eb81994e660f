// Reads result files and validates all of their content.
#include <algorithm>
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
#include "base/npy.h"
#include "files/result_file.h"
#include "store/archive.h"

namespace vpr {
namespace {

namespace fs = std::filesystem;

constexpr uint64_t kMostFrames = std::numeric_limits<int32_t>::max();

/// The values of an open array, row by row.
template <class T>
struct Rows {
  NpyArray array;
  std::span<const T> values;
};

struct ResultSource {
  const fs::path& path;
  const std::string& where;
  const Fields& fields;

  bool has(const std::string& name) const { return fields.object("files").has(name); }
  [[noreturn]] void refuse(const std::string& name, const std::string& damage) const {
    fields.fail(fmt::format("{}.npy {}", name, damage));
  }
  /// The array of that name, with `columns` columns and, if set, `rows` rows. Throws Error(data) if
  /// it is not the array that the JSON was written with.
  template <class T>
  Rows<T> open(const std::string& name, size_t columns = 1, std::optional<size_t> rows = {}) const {
    const fs::path file = companion_path(path, name + ".npy");
    NpyArray array(file);
    if (checksum(array.file_bytes()) != fields.object("files").object(name).text("checksum"))
      throw Error(ErrorKind::data,
                  fmt::format("{}: belongs to another run than its .json file, or is damaged; run "
                              "vpr-query again, with --force",
                              file.string()));
    const auto values = array.values<T>(columns == 1 ? 1 : 2);
    if (columns > 1 && array.shape()[1] != columns) refuse(name, "has other columns");
    if (rows && array.shape()[0] != *rows) refuse(name, "does not fit the query");
    return {std::move(array), values};
  }
};

// The difference between a window's sum, as in rows of matchers, and its score in files.
int64_t offset_of(const Result& result) {
  const auto offset = result.score().offset;
  return offset == nullptr ? 0 : offset(result.window_length());
}

uint64_t window_count(uint64_t frames, uint64_t window_length) {
  return frames < window_length ? 0 : frames - window_length + 1;
}

// Reads a score and returns its sum, which is larger by `offset`.
uint32_t read_sum(const Fields& item, const std::string& key, int64_t offset) {
  constexpr int64_t kMost = int64_t{1} << 33;  // above any sum; adding the offset cannot overflow
  const Json& value = item[key];
  const auto number = value.is_number_integer() ? value.get<int64_t>() : kMost;
  if (number <= -kMost || number >= kMost || !std::in_range<uint32_t>(number + offset))
    item.fail(fmt::format("\"{}\" is not a number in range", key));
  return static_cast<uint32_t>(number + offset);
}

void read_settings(const ResultSource& source, Result& result) {
  result.settings = read_query_settings(source.fields);
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

void read_threshold(const Fields& item, const Result& result, ComparedSequence& compared) {
  item.read("t_r", compared.threshold);
  item.read("t_r_scale", compared.scale);
  compared.distance_limit = read_sum(item, "limit", offset_of(result));
  item.read_if_set("margin", compared.margin);
  if (item.has("max_distance")) compared.max_distance = read_sum(item, "max_distance", 0);
}

void read_targets(const ResultSource& source, Result& result) {
  for (const Json& json : source.fields.list("sequences")) {
    const Fields item(json, source.where);
    ComparedSequence& compared = result.sequences.emplace_back();
    compared.sequence = read_sequence(item, kMostFrames);
    compared.windows =
        item.count("windows", window_count(compared.sequence.frames, result.window_length()));
    item.read("searched", compared.searched);
    if (compared.searched && !result.places) read_threshold(item, result, compared);
  }
}

void read_places(const ResultSource& source, Result& result) {
  const Fields places = source.fields.object("places");
  result.places.emplace();
  result.places->views = places.count("views", kMostFrames);
  places.read("names", result.places->names);
  const Fields query = source.fields.object("query");
  if (query.has("featureless"))
    result.places->featureless = query.count("featureless", result.query.frames);
}

void read_selected(const ResultSource& source, const std::vector<Sequence*>& sequences,
                   const std::string& name) {
  read_sources(
      sequences,
      [&] {
        const Rows<int32_t> rows = source.open<int32_t>(name);
        return std::vector<int32_t>(rows.values.begin(), rows.values.end());
      },
      [&] { source.refuse(name, "does not fit its sequences"); });
}

constexpr double kMostSum = 4294967295.0;  // over a window

bool is_score(double score, const Result& result) {
  if (!std::isfinite(score)) return false;
  if (result.places) return true;
  const double sum = score + static_cast<double>(offset_of(result));
  return sum >= 0 && sum <= kMostSum && std::floor(score) == score;
}

bool is_inside(const Match& match, const Result& result) {
  if (match.query >= result.query_windows || match.sequence >= result.sequences.size())
    return false;
  const uint64_t windows =
      window_count(result.sequences[match.sequence].sequence.frames, result.window_length());
  return match.train < windows && (!result.places || match.view < result.places->views) &&
         is_score(match.score, result);
}

/// The rows of recognitions.npy or best.npy with their scores; nullopt for a window without a
/// match.
std::vector<std::optional<Match>> read_rows(const ResultSource& source, const std::string& name,
                                            const std::string& scores_name, const Result& result) {
  const size_t columns = result.places ? 4 : 3;  // query, target, train, and the view of a place
  const Rows<int32_t> rows = source.open<int32_t>(name, columns);
  const Rows<double> scores = source.open<double>(scores_name, 1, rows.array.shape()[0]);
  std::vector<std::optional<Match>> matches;
  for (size_t i = 0; i < scores.values.size(); ++i) {
    const int32_t* row = rows.values.data() + i * columns;
    if (row[2] == -1) {
      matches.emplace_back();
      continue;
    }
    // A negative index is converted to one out of range.
    const auto at = [&](size_t column) { return static_cast<uint32_t>(row[column]); };
    const Match match{at(0), at(1), at(2), result.places ? at(3) : 0, scores.values[i]};
    if (!is_inside(match, result))
      throw Error(ErrorKind::data,
                  fmt::format("{}: an index or a score is out of range; run vpr-query again",
                              companion_path(source.path, name + ".npy").string()));
    matches.emplace_back(match);
  }
  return matches;
}

// The first frames of one sequence's keyframes, from `row` on.
std::vector<uint32_t> consume_keyframes(std::span<const int32_t> rows, size_t& row,
                                        int32_t sequence, uint64_t frames,
                                        const ResultSource& source) {
  std::vector<uint32_t> starts;
  for (; 2 * row < rows.size() && rows[2 * row] == sequence; ++row) {
    const int32_t frame = rows[2 * row + 1];
    const bool follows =
        starts.empty() ? frame == 0 : frame > 0 && static_cast<uint32_t>(frame) > starts.back();
    if (!follows || static_cast<uint64_t>(frame) >= frames)
      source.refuse("keyframes", "has a frame that is out of range or order");
    starts.push_back(static_cast<uint32_t>(frame));
  }
  if (starts.empty() != (frames == 0)) source.refuse("keyframes", "does not fit the sequences");
  return starts;
}

void read_matches(const ResultSource& source, Result& result) {
  for (const auto& recognition : read_rows(source, "recognitions", "recognition_scores", result)) {
    if (!recognition) source.refuse("recognitions", "has a recognition without a match");
    result.recognitions.push_back(*recognition);
  }
  const auto position = [](const Match& recognition) {
    return std::tie(recognition.query, recognition.sequence, recognition.train);
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
  const auto file = source.open<double>("best_rates", 1, result.query_windows);
  for (size_t window = 0; window < file.values.size(); ++window)
    if (std::isnan(file.values[window]) == result.best[window].has_value() ||
        file.values[window] <= 0)
      source.refuse("best_rates", "has an invalid rate");
  result.best_rates.assign(file.values.begin(), file.values.end());
}

void read_margins(const ResultSource& source, Result& result) {
  if (!source.has("margins")) return;
  const auto file = source.open<double>("margins", 1, result.best.size());
  for (size_t window = 0; window < file.values.size(); ++window) {
    auto& margin = result.margins.emplace_back();
    if (std::isnan(file.values[window])) continue;
    margin = file.values[window];
    if (!result.best[window] || result.places || !(*margin >= 0 && *margin <= kMostSum) ||
        std::floor(*margin) != *margin)
      source.refuse("margins", "has a number out of range");
  }
}

void read_path(const ResultSource& source, Result& result) {
  if (!source.has("path")) return;
  const size_t frames = result.query.frames;
  const auto file = source.open<double>("path", 3, frames);
  ResultPath& path = result.path.emplace(frames);
  const auto is_whole = [](double value, double least, size_t most) {
    return value >= least && value <= static_cast<double>(most) && value == std::floor(value);
  };
  for (size_t frame = 0; frame < frames; ++frame) {
    const double* row = file.values.data() + 3 * frame;
    const bool is_valid =
        (std::isnan(row[0]) || (row[0] >= 0 && row[0] <= kMostSum)) &&
        is_whole(row[1], 0, frames) &&
        (std::isnan(row[2]) || is_whole(row[2], static_cast<double>(frame), frames - 1));
    if (!is_valid) source.refuse("path", "has a number out of range");
    if (!std::isnan(row[0])) path.rates[frame] = row[0];
    path.numbers[frame] = static_cast<uint32_t>(row[1]);
    if (!std::isnan(row[2])) path.decided[frame] = static_cast<uint32_t>(row[2]);
  }
  const Fields totals = source.fields.object("totals");
  if (totals.has("reversed_frames")) path.reversed_frames = totals.count("reversed_frames", frames);
  for (const Match& recognition : result.recognitions)
    if (!path.decided[anchor_of(recognition.query, result.window_length())])
      source.refuse("path", "does not say when a recognized frame was decided");
}

void read_keyframes(const ResultSource& source, Result& result) {
  if (!source.has("keyframes")) return;
  const auto file = source.open<int32_t>("keyframes", 2);
  size_t row = 0;
  ResultKeyframes& keyframes = result.keyframes.emplace();
  keyframes.query = consume_keyframes(file.values, row, -1, result.query.frames, source);
  for (size_t t = 0; t < result.sequences.size(); ++t)
    keyframes.train.push_back(consume_keyframes(file.values, row, static_cast<int32_t>(t),
                                                result.sequences[t].sequence.frames, source));
  if (2 * row != file.values.size()) source.refuse("keyframes", "does not fit the sequences");
}

void read_new_place(const ResultSource& source, Result& result) {
  const auto file = source.open<double>("new_place", 1, result.query.frames);
  result.places->new_place.assign(file.values.begin(), file.values.end());
}

// Compares the clusters of the file with those of its recognitions.
void read_clusters(const ResultSource& source, Result& result, const Monitor& monitor) {
  const int64_t eps = std::get<SequenceQuerySettings>(result.settings).clustering.eps;
  if (eps < 0 || eps > kMaxEps) source.fields.fail("its clustering.eps is out of range");
  cluster(result, monitor);
  if (source.fields.list("clusters") != clusters_json(*result.clusters, result.window_length()))
    source.fields.fail("its clusters are not those of its recognitions");
}

// Other files of the run in the folder of the result. They may be missing.
void check_companions(const ResultSource& source, const Json& companions, const Monitor& monitor) {
  if (!companions.is_object()) source.fields.fail("\"companions\" is not an object");
  for (const auto& [name, sum] : companions.items()) {
    if (fs::path(name).filename() != name || !sum.is_string())
      source.fields.fail("\"companions\" is not a list of file names with checksums");
    const fs::path path = source.path.parent_path() / name;
    std::error_code error;
    if (fs::is_regular_file(path, error) && file_checksum(path, monitor) != sum.get<std::string>())
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
                fmt::format("{}: is a {}. Pass a result of vpr-query (.json).", where,
                            fs::exists(path / kManifestName, ignored) ? "database" : "folder"));
  Json json = read_json(path, ErrorKind::data);
  require_schema(json, "result", where, ErrorKind::data);
  const Fields fields(json, where);
  if (fields.text("checksum") != result_checksum(json)) fields.fail("its checksum does not fit");
  return json;
}

QuerySettings read_query_settings(const Fields& file) {
  QuerySettings settings;
  if (file.text("method") == FabmapQuerySettings{}.method) settings = FabmapQuerySettings{};
  std::visit([&](auto& kind) { file.read_settings("settings", kind); }, settings);
  const auto* sequences = std::get_if<SequenceQuerySettings>(&settings);
  if (sequences != nullptr &&
      std::ranges::count(sequence_methods(), sequences->method, &SequenceMethod::name) == 0)
    file.fail(fmt::format("the method \"{}\" is unknown", sequences->method));
  return settings;
}

StoredResult read_result(const fs::path& path, const Monitor& monitor) {
  const std::string where = path.string();
  const Json json = read_result_json(path);
  const Fields fields(json, where);
  const ResultSource source{path, where, fields};
  StoredResult stored;
  stored.fingerprint = fields.text("checksum");
  Result& result = stored.result;
  read_settings(source, result);
  read_query(source, result);
  const bool has_places = std::holds_alternative<FabmapQuerySettings>(result.settings);
  if (has_places) read_places(source, result);
  read_targets(source, result);
  std::vector<Sequence*> train;
  for (ComparedSequence& compared : result.sequences) train.push_back(&compared.sequence);
  read_selected(source, {&result.query}, "source_frames");
  read_selected(source, train, "train_source_frames");
  if (has_places && (result.sequences.size() != 1 ||
                     result.sequences[0].sequence.frames != result.places->names.size()))
    fields.fail("its places and its sequences do not fit");
  read_matches(source, result);
  read_rates(source, result);
  read_path(source, result);
  if (has_places)
    read_new_place(source, result);
  else
    read_clusters(source, result, monitor);
  read_margins(source, result);
  read_keyframes(source, result);
  if (fields.has("companions")) check_companions(source, json["companions"], monitor);
  if (json["files"].contains("matrix"))
    stored.matrix_checksum = fields.object("files").object("matrix").text("checksum");
  const Json machine = json.value("machine", Json());
  const auto read_texts = [&](const char* key, std::map<std::string, std::string>& texts) {
    if (machine.contains(key))
      for (const auto& [role, text] : machine[key].items())
        if (text.is_string()) texts[role] = text.get<std::string>();
  };
  read_texts("paths", stored.run.paths);
  read_texts("frame_names", stored.run.frame_names);
  if (const Json made = json.value("provenance", Json()); made.contains("database"))
    if (made["database"].is_string()) stored.run.database_fingerprint = made["database"];
  return stored;
}

}  // namespace vpr
