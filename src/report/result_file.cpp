#include "report/result_file.h"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "base/json.h"
#include "base/mapped_file.h"

namespace vpr {
namespace {

namespace fs = std::filesystem;

constexpr size_t kColumns = 4;                   // query window, sequence, train window, distance
constexpr size_t kPieceBytes = size_t{1} << 26;  // of a large file that are in memory at once
using CellRow = std::array<int32_t, kColumns>;

CellRow cell_row(const Cell& cell, int64_t offset) {
  return {static_cast<int32_t>(cell.query_window), static_cast<int32_t>(cell.sequence),
          static_cast<int32_t>(cell.train_window), static_cast<int32_t>(cell.distance - offset)};
}

std::vector<CellRow> hit_rows(const SequenceResult& result) {
  std::vector<CellRow> rows;
  rows.reserve(result.hits.size());
  for (const Cell& hit : result.hits) rows.push_back(cell_row(hit, result.score_offset()));
  return rows;
}

// A window without any cell has -1 for sequence, train window and distance.
std::vector<CellRow> best_rows(const SequenceResult& result) {
  std::vector<CellRow> rows;
  for (size_t window = 0; window < result.best.size(); ++window)
    rows.push_back(result.best[window] ? cell_row(*result.best[window], result.score_offset())
                                       : CellRow{static_cast<int32_t>(window), -1, -1, -1});
  return rows;
}

Json sequence_json(const SequenceThreshold& sequence, int64_t offset) {
  Json json = {{"name", sequence.name},
               {"frames", sequence.frames},
               {"windows", sequence.windows},
               {"searched", sequence.searched}};
  if (!sequence.searched) return json;
  json["t_r"] = sequence.threshold ? Json(*sequence.threshold) : Json();
  json["t_r_scale"] = enum_name(sequence.scale);
  json["distance_limit"] = sequence.distance_limit - offset;
  if (sequence.max_distance) json["max_distance"] = *sequence.max_distance;
  return json;
}

Json recognition_json(const SequenceResult& result, const Recognition& place) {
  return {{"sequence", place.sequence},
          {"query",
           {{"window", place.query_window},
            {"anchor", result.anchor(place.query_window)},
            {"first", place.query_first},
            {"last", place.query_last},
            {"first_frame", place.query_first},
            {"last_frame", result.anchor(place.query_last)}}},
          {"train",
           {{"window", place.train_window},
            {"anchor", result.anchor(place.train_window)},
            {"first", place.train_first},
            {"last", place.train_last},
            {"first_frame", place.train_first},
            {"last_frame", result.anchor(place.train_last)}}},
          {"hits", place.hits},
          {"best_distance", place.best_distance - result.score_offset()}};
}

// First frames of views: the query's with -1 for the sequence, then those of each sequence.
std::vector<std::array<int32_t, 2>> view_rows(const ResultViews& views) {
  std::vector<std::array<int32_t, 2>> rows;
  const auto add = [&](int32_t sequence, const std::vector<uint32_t>& starts) {
    for (const uint32_t frame : starts) rows.push_back({sequence, static_cast<int32_t>(frame)});
  };
  add(-1, views.query);
  for (size_t s = 0; s < views.train.size(); ++s) add(static_cast<int32_t>(s), views.train[s]);
  return rows;
}

template <size_t kRowColumns>
Json write_rows(OutputFile& file, const std::vector<std::array<int32_t, kRowColumns>>& rows) {
  const std::span<const int32_t> values(rows.empty() ? nullptr : rows.front().data(),
                                        rows.size() * kRowColumns);
  return write_companion(file, values, {rows.size(), kRowColumns});
}

}  // namespace

fs::path companion_path(const fs::path& result, const std::string& kind) {
  fs::path path = result;
  if (path.extension() == ".json") path.replace_extension();
  return path += "." + kind;
}

void claim_result(const fs::path& path, OutputTransaction& outputs) {
  outputs.claim_file(path);
  for (const char* kind : {"hits.npy", "best.npy", "views.npy"})
    outputs.claim_file(companion_path(path, kind));
}

Json file_entry(const fs::path& path, size_t rows, const Monitor& monitor) {
  const MappedFile file(path);
  ChecksumStream sum;
  for (size_t at = 0; at < file.bytes().size(); at += kPieceBytes) {
    check_stop(monitor);
    const size_t size = std::min(kPieceBytes, file.bytes().size() - at);
    sum.add(file.bytes().subspan(at, size));
    file.forget(at, size);
  }
  return {{"rows", rows}, {"checksum", sum.text()}};
}

void add_result_checksum(Json& json) { json["checksum"] = result_checksum(json); }

std::string result_checksum(Json json) {
  for (const char* key : {"machine", "timing", "checksum"}) json.erase(key);
  return checksum(to_text(json));
}

void add_context(Json& json, const ResultContext& context) {
  json["provenance"] = provenance_json(context.run);
  json["provenance"]["database"] = context.database_fingerprint;
  json["provenance"]["query"] = context.query_fingerprint;
  json["machine"] = machine_json(context.run);
  json["timing"] = timing_json(context.seconds);
  if (!context.files.empty()) json["files"] = context.files;
}

Json result_json(const SequenceResult& result, const ResultContext& context) {
  Json json = {{"schema", "vpr.result/1"}, {"method", result.settings.method}};
  json["settings"] = settings_in_force(result.settings);
  if (result.statistics) {
    json["statistics"] = value_to_json(result.statistics->settings);
    json["statistics"]["typical_distance"] = result.statistics->typical_distance;
  }
  json["query"] = {{"name", result.query_name},
                   {"frames", result.query_frames},
                   {"windows", result.query_windows},
                   {"unreadable", result.query_unreadable}};
  json["sequences"] = Json::array();
  for (const SequenceThreshold& sequence : result.sequences)
    json["sequences"].push_back(sequence_json(sequence, result.score_offset()));
  json["totals"] = {{"hits", result.hits.size()}, {"places", result.places.size()}};
  if (result.recall)
    json["recall"] = {{"windows", result.recall->windows},
                      {"found_best", result.recall->found_best},
                      {"hits", result.recall->hits},
                      {"found_hits", result.hits.size()}};
  json["recognitions"] = Json::array();
  for (const Recognition& place : result.places)
    json["recognitions"].push_back(recognition_json(result, place));
  if (context.verified_cells)
    json["verification"] = {{"cells", *context.verified_cells}, {"differences", 0}};
  if (context.matrix) json["matrix"] = *context.matrix;
  add_context(json, context);
  return json;
}

Json write_result(const fs::path& path, const SequenceResult& result, const ResultContext& context,
                  OutputTransaction& outputs) {
  Json json = result_json(result, context);
  Json& files = json["files"];
  files["hits"] = write_rows(outputs.file(companion_path(path, "hits.npy")), hit_rows(result));
  files["best"] = write_rows(outputs.file(companion_path(path, "best.npy")), best_rows(result));
  if (result.views)
    files["views"] =
        write_rows(outputs.file(companion_path(path, "views.npy")), view_rows(*result.views));
  add_result_checksum(json);
  outputs.file(path).write(to_text(json));
  return json;
}

}  // namespace vpr
