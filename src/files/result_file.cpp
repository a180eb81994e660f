#include "files/result_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "base/checksum.h"
#include "base/json.h"
#include "base/mapped_file.h"
#include "base/npy.h"
#include "base/output.h"

namespace vpr {
namespace {

namespace fs = std::filesystem;

constexpr size_t kPieceBytes = size_t{1} << 26;  // of a large file in memory

/// Matches as two arrays: query, sequence, train and, for places, the view; and scores. A query
/// without a match has -1 for all but the query, and NaN.
struct MatchColumns {
  size_t columns;
  std::vector<int32_t> indices = {};
  std::vector<double> scores = {};

  void add(const Match& match) {
    const std::array<uint32_t, 4> row = {match.query, match.sequence, match.train, match.view};
    for (size_t c = 0; c < columns; ++c) indices.push_back(static_cast<int32_t>(row[c]));
    scores.push_back(match.score);
  }
  void add_none(size_t query) {
    indices.push_back(static_cast<int32_t>(query));
    indices.insert(indices.end(), columns - 1, -1);
    scores.push_back(std::numeric_limits<double>::quiet_NaN());
  }
};

// A row per query frame: the rate, the number of the path, and the frame that decided.
std::vector<double> path_rows(const ResultPath& path) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  std::vector<double> rows;
  for (size_t frame = 0; frame < path.rates.size(); ++frame) {
    const std::optional<uint32_t> decided = path.decided[frame];
    rows.insert(rows.end(), {path.rates[frame].value_or(kNone),
                             static_cast<double>(path.numbers[frame]), decided ? *decided : kNone});
  }
  return rows;
}

// The first frames of keyframes as rows of sequence and frame; the query is sequence -1.
std::vector<int32_t> keyframe_rows(const ResultKeyframes& keyframes) {
  std::vector<int32_t> rows;
  const auto add = [&](int32_t sequence, const std::vector<uint32_t>& starts) {
    for (const uint32_t frame : starts) {
      rows.push_back(sequence);
      rows.push_back(static_cast<int32_t>(frame));
    }
  };
  add(-1, keyframes.query);
  for (size_t t = 0; t < keyframes.train.size(); ++t)
    add(static_cast<int32_t>(t), keyframes.train[t]);
  return rows;
}

Json query_json(const Result& result) {
  Json json = sequence_json(
      result.query, {{"windows", result.query_windows}, {"unreadable", result.query.unreadable}});
  if (result.places) json["featureless"] = result.places->featureless;
  return json;
}

Json compared_json(const ComparedSequence& compared, const Result& result) {
  Json json = sequence_json(compared.sequence,
                            {{"windows", compared.windows}, {"searched", compared.searched}});
  if (!compared.searched || result.places) return json;
  json["t_r"] = compared.threshold ? Json(*compared.threshold) : Json();
  json["t_r_scale"] = enum_name(compared.scale);
  json["limit"] = compared.distance_limit - result.score().offset(result.window_length());
  if (compared.max_distance) json["max_distance"] = *compared.max_distance;
  if (compared.margin) json["margin"] = *compared.margin;
  return json;
}

Json extent_json(uint32_t window, uint32_t first, uint32_t last, size_t length) {
  return {{"window", window},     {"anchor", anchor_of(window, length)},
          {"first", first},       {"last", last},
          {"first_frame", first}, {"last_frame", anchor_of(last, length)}};
}

void add_context(Json& json, const ResultContext& context) {
  json["provenance"] = provenance_json(context.run);
  json["provenance"]["database"] = context.database_fingerprint;
  json["provenance"]["query"] = context.query_fingerprint;
  if (!context.fused_fingerprint.empty()) json["provenance"]["fused"] = context.fused_fingerprint;
  add_run(json, context.run, context.seconds);
  if (!context.files.empty()) json["files"] = context.files;
}

Json match_json(const Result& result, const Match& match) {
  const size_t length = result.window_length();
  return {{"sequence", result.sequences[match.sequence].sequence.name},
          {"frame", anchor_of(match.train, length)},
          {"score", result.score().frame_value(match.score, length)},
          {"sum", static_cast<int64_t>(match.score)}};
}

// Adds the checksums of the arrays and of the whole to the JSON of a result, and writes the arrays
// if there are outputs.
void seal(Json& json, const fs::path& path, const Result& result, Outputs* outputs) {
  visit_arrays(result, [&](const ResultArray& array) {
    std::vector<size_t> shape = {array.rows};
    if (array.columns.size() > 1) shape.push_back(array.columns.size());
    const std::string header = npy_header(array.type, shape);
    ChecksumStream sum;
    sum.add(std::as_bytes(std::span(header)));
    sum.add(array.values);
    json["files"][array.name] = {{"rows", array.rows}, {"checksum", sum.text()}};
    if (outputs == nullptr) return;
    Output& file = outputs->file(companion_path(path, array.name + ".npy"));
    file.write(header);
    file.write(array.values);
  });
  json["checksum"] = result_checksum(json);
}

}  // namespace

fs::path companion_path(const fs::path& result, const std::string& kind) {
  fs::path path = result;
  if (path.extension() == ".json") path.replace_extension();
  return path += "." + kind;
}

void claim_result(const fs::path& path, Outputs& outputs) {
  outputs.claim_file(path);
  for (const char* kind : kResultArrays) outputs.claim_file(companion_path(path, kind));
}

std::string file_checksum(const fs::path& path, const Monitor& monitor) {
  const MappedFile file(path);
  ChecksumStream sum;
  for (size_t at = 0; at < file.bytes().size(); at += kPieceBytes) {
    check_stop(monitor);
    const size_t size = std::min(kPieceBytes, file.bytes().size() - at);
    sum.add(file.bytes().subspan(at, size));
    file.forget(at, size);
  }
  return sum.text();
}

Json file_entry(const fs::path& path, size_t rows, const Monitor& monitor) {
  return {{"rows", rows}, {"checksum", file_checksum(path, monitor)}};
}

std::string result_checksum(Json json) {
  for (const char* key : {"machine", "timing", "checksum"}) json.erase(key);
  return checksum(to_text(json));
}

Json clusters_json(const Clusters& clusters, size_t length) {
  Json json = Json::array();
  for (const Cluster& one : clusters.all)
    json.push_back(
        {{"sequence", one.sequence},
         {"query", extent_json(one.query_window, one.query_first, one.query_last, length)},
         {"train", extent_json(one.train_window, one.train_first, one.train_last, length)},
         {"recognitions", one.recognitions},
         {"best_score", static_cast<int64_t>(one.best_score)}});
  return json;
}

Json result_json(const Result& result, const ResultContext& context) {
  Json json = {{"schema", "vpr.result/3"}, {"method", method_of(result.settings)}};
  json["settings"] = settings_in_force(result.settings);
  if (result.statistics) {
    json["statistics"] = value_to_json(result.statistics->settings);
    json["statistics"]["typical_distance"] = result.statistics->typical_distance;
  }
  json["query"] = query_json(result);
  json["sequences"] = Json::array();
  for (const ComparedSequence& compared : result.sequences)
    json["sequences"].push_back(compared_json(compared, result));
  if (result.places)
    json["places"] = {{"names", result.places->names}, {"views", result.places->views}};
  json["totals"] = {{"recognitions", result.recognitions.size()}};
  if (result.path && result.path->reversed_frames)
    json["totals"]["reversed_frames"] = *result.path->reversed_frames;
  if (result.recall)
    json["recall"] = {{"windows", result.recall->windows},
                      {"found_best", result.recall->found_best},
                      {"recognitions", result.recall->recognitions},
                      {"found_recognitions", result.recognitions.size()}};
  if (result.clusters) {
    json["totals"]["clusters"] = result.clusters->all.size();
    json["clusters"] = clusters_json(*result.clusters, result.window_length());
  }
  if (context.verified_cells)
    json["verification"] = {{"cells", *context.verified_cells}, {"differences", 0}};
  if (context.matrix) json["matrix"] = *context.matrix;
  if (context.scores) json["scores"] = *context.scores;
  if (context.explanation) json["explanation"] = *context.explanation;
  add_context(json, context);
  return json;
}

void visit_arrays(const Result& result, const std::function<void(const ResultArray&)>& visit) {
  const auto add = [&]<class T>(const std::string& name, const std::vector<T>& values,
                                std::vector<std::string_view> columns = {""}) {
    const size_t rows = values.size() / columns.size();
    visit({name, npy_type<T>(), rows, std::move(columns), std::as_bytes(std::span(values))});
  };
  std::vector<std::string_view> columns = {"query", "sequence", "train"};
  if (result.places) columns.emplace_back("view");
  MatchColumns recognitions{columns.size()};
  recognitions.indices.reserve(columns.size() * result.recognitions.size());
  for (const Match& recognition : result.recognitions) recognitions.add(recognition);
  add("recognitions", recognitions.indices, columns);
  add("recognition_scores", recognitions.scores);
  MatchColumns best{columns.size()};
  for (size_t window = 0; window < result.best.size(); ++window)
    result.best[window] ? best.add(*result.best[window]) : best.add_none(window);
  add("best", best.indices, columns);
  add("best_scores", best.scores);
  if (!result.best_rates.empty()) add("best_rates", result.best_rates);
  if (!result.margins.empty()) {
    std::vector<double> margins;
    for (const auto& margin : result.margins)
      margins.push_back(margin.value_or(std::numeric_limits<double>::quiet_NaN()));
    add("margins", margins);
  }
  if (result.path) add("path", path_rows(*result.path), {"rate", "path", "decided"});
  if (result.keyframes) add("keyframes", keyframe_rows(*result.keyframes), {"sequence", "frame"});
  if (result.places) add("new_place", result.places->new_place);
  const Sequence* query = &result.query;
  if (!query->selection.is_all()) add("source_frames", source_rows({&query, 1}));
  std::vector<const Sequence*> train;
  for (const ComparedSequence& compared : result.sequences) train.push_back(&compared.sequence);
  if (const std::vector<int32_t> rows = source_rows(train); !rows.empty())
    add("train_source_frames", rows);
}

Json write_result(const fs::path& path, const Result& result, const ResultContext& context,
                  Outputs& outputs) {
  Json json = result_json(result, context);
  for (const Output* file : outputs.files_next_to(path)) {
    const auto known = context.checksums.find(file->path());
    json["companions"][file->path().filename().string()] =
        known != context.checksums.end() ? known->second : file_checksum(file->temporary());
  }
  seal(json, path, result, &outputs);
  outputs.file(path).write(to_text(json));
  return json;
}

Json sealed_result_json(const Result& result, const ResultContext& context) {
  Json json = result_json(result, context);
  seal(json, "", result, nullptr);
  return json;
}

std::string RecordedRun::path(const std::string& role) const {
  const auto found = paths.find(role);
  return found == paths.end() ? std::string() : found->second;
}

Json live_line(const LineFrame& frame, const Result* result, size_t window) {
  Json line = {{"schema", "vpr.live/3"}, {"frame", frame.number},
               {"name", frame.name},     {"readable", frame.is_readable},
               {"match", nullptr},       {"margin", nullptr},
               {"rate", nullptr},        {"recognized", Json::array()}};
  if (result == nullptr) return line;
  if (result->best[window]) line["match"] = match_json(*result, *result->best[window]);
  if (const auto margin = frame_margin(*result, window)) line["margin"] = *margin;
  if (result->path) line["rate"] = or_null(result->path->rates[window]);
  for (const Match& match : result->recognitions) {
    if (!result->path && match.query != window) continue;
    Json recognized = match_json(*result, match);
    recognized["query"] = result->path ? match.query : frame.number;
    line["recognized"].push_back(std::move(recognized));
  }
  return line;
}

}  // namespace vpr
