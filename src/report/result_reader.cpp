// Reading of result files: nothing that they say is trusted.
#include <array>
#include <limits>
#include <tuple>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "base/checksum.h"
#include "base/error.h"
#include "base/json.h"
#include "base/npy.h"
#include "report/json_fields.h"
#include "report/result_file.h"

namespace vpr {
namespace {

namespace fs = std::filesystem;

constexpr size_t kColumns = 4;  // query window, sequence, train window, distance
using CellRow = std::array<int32_t, kColumns>;

constexpr uint64_t kMostFrames = std::numeric_limits<int32_t>::max();

// A distance, or the score that is `offset` below the biased sum of a window.
uint32_t read_distance(const Fields& item, const std::string& key, int64_t offset) {
  constexpr int64_t kMost = int64_t{1} << 33;  // more than any sum: adding the offset is safe
  const Json& value = item[key];
  const auto number = value.is_number_integer() ? value.get<int64_t>() : kMost;
  if (number <= -kMost || number >= kMost || !std::in_range<uint32_t>(number + offset))
    item.fail(fmt::format("\"{}\" is no number in range", key));
  return static_cast<uint32_t>(number + offset);
}

// Windows that fit in `frames` frames.
uint64_t window_count(uint64_t frames, uint64_t window_length) {
  return frames < window_length ? 0 : frames - window_length + 1;
}

std::vector<SequenceThreshold> read_sequences(const Fields& fields, const std::string& where,
                                              const SequenceResult& result) {
  std::vector<SequenceThreshold> sequences;
  for (const Json& json : fields.list("sequences")) {
    const Fields item(json, where);
    SequenceThreshold& sequence = sequences.emplace_back();
    sequence.name = item.text("name");
    sequence.frames = item.count("frames", kMostFrames);
    sequence.windows =
        item.count("windows", window_count(sequence.frames, result.settings.window_length));
    if (!item["searched"].is_boolean()) item.fail("\"searched\" is neither true nor false");
    sequence.searched = item["searched"].get<bool>();
    if (!sequence.searched) continue;
    if (item["t_r"].is_number()) sequence.threshold = item["t_r"].get<double>();
    const auto scale = enum_value<ThresholdScale>(item.text("t_r_scale"));
    if (!scale) item.fail("\"t_r_scale\" is no scale");
    sequence.scale = *scale;
    sequence.distance_limit = read_distance(item, "distance_limit", result.score_offset());
    if (json.contains("max_distance"))
      sequence.max_distance = read_distance(item, "max_distance", 0);
  }
  return sequences;
}

uint32_t read_window(const Fields& extent, const std::string& key, uint64_t windows) {
  if (windows == 0) extent.fail("a recognition lies in a sequence without windows");
  return static_cast<uint32_t>(extent.count(key, windows - 1));
}

Recognition read_recognition(const Fields& item, const SequenceResult& result) {
  Recognition place;
  place.sequence = static_cast<uint32_t>(item.count("sequence", kMostFrames));
  if (place.sequence >= result.sequences.size())
    item.fail("a recognition's sequence is out of range");
  const Fields query = item.object("query");
  const Fields train = item.object("train");
  const uint64_t train_windows =
      window_count(result.sequences[place.sequence].frames, result.settings.window_length);
  place.query_window = read_window(query, "window", result.query_windows);
  place.query_first = read_window(query, "first", result.query_windows);
  place.query_last = read_window(query, "last", result.query_windows);
  place.train_window = read_window(train, "window", train_windows);
  place.train_first = read_window(train, "first", train_windows);
  place.train_last = read_window(train, "last", train_windows);
  place.hits = item.count("hits", std::numeric_limits<uint64_t>::max());
  place.best_distance = read_distance(item, "best_distance", result.score_offset());
  return place;
}

std::vector<CellRow> read_rows(const fs::path& path, const Fields& entry) {
  const NpyArray array = read_companion(path, entry);
  const auto values = array.values<int32_t>(2);
  if (array.shape()[1] != kColumns) entry.fail(path.filename().string() + " has other columns");
  std::vector<CellRow> rows(array.shape()[0]);
  for (size_t i = 0; i < rows.size(); ++i)
    std::copy_n(values.begin() + static_cast<ptrdiff_t>(i * kColumns), kColumns, rows[i].begin());
  return rows;
}

Cell checked_cell(const CellRow& row, const SequenceResult& result, const fs::path& path) {
  const auto inside = [](int32_t value, uint64_t count) {
    return value >= 0 && static_cast<uint64_t>(value) < count;
  };
  const bool fits =
      inside(row[0], result.query_windows) && inside(row[1], result.sequences.size()) &&
      inside(row[2], window_count(result.sequences[static_cast<size_t>(row[1])].frames,
                                  result.settings.window_length)) &&
      std::in_range<uint32_t>(int64_t{row[3]} + result.score_offset());
  if (!fits)
    throw Error(ErrorKind::data,
                fmt::format("{}: an index or a distance is out of range; run vpr-query again",
                            path.string()));
  return {static_cast<uint32_t>(row[0]), static_cast<uint32_t>(row[1]),
          static_cast<uint32_t>(row[2]), static_cast<uint32_t>(row[3] + result.score_offset())};
}

void read_cells(const fs::path& path, const Fields& fields, SequenceResult& result) {
  const Fields files = fields.object("files");
  const fs::path hits_path = companion_path(path, "hits.npy");
  for (const CellRow& row : read_rows(hits_path, files.object("hits")))
    result.hits.push_back(checked_cell(row, result, hits_path));
  const fs::path best_path = companion_path(path, "best.npy");
  for (const CellRow& row : read_rows(best_path, files.object("best"))) {
    if (row[1] == -1)
      result.best.emplace_back();
    else
      result.best.emplace_back(checked_cell(row, result, best_path));
  }
  if (result.best.size() != result.query_windows) fields.fail("best matches do not fit the query");
}

// Clustering asks for settings in range, and hits in order.
void check_clusterable(const Fields& fields, const SequenceResult& result) {
  const int64_t eps = result.settings.clustering.eps;
  if (eps < 0 || eps > kMaxEps) fields.fail("its clustering.eps is out of range");
  const auto position = [](const Cell& hit) {
    return std::tie(hit.query_window, hit.sequence, hit.train_window);
  };
  for (size_t h = 1; h < result.hits.size(); ++h)
    if (position(result.hits[h - 1]) >= position(result.hits[h]))
      fields.fail("its hits are not in order");
}

// The first frames of one sequence's views: rows from `row` on.
std::vector<uint32_t> take_views(std::span<const int32_t> rows, size_t& row, int32_t sequence,
                                 uint64_t frames, const Fields& files) {
  std::vector<uint32_t> starts;
  for (; 2 * row < rows.size() && rows[2 * row] == sequence; ++row) {
    const int32_t frame = rows[2 * row + 1];
    const bool follows =
        starts.empty() ? frame == 0 : frame > 0 && static_cast<uint32_t>(frame) > starts.back();
    if (!follows || static_cast<uint64_t>(frame) >= frames)
      files.fail("views.npy holds a frame that is out of range or order");
    starts.push_back(static_cast<uint32_t>(frame));
  }
  if (starts.empty() != (frames == 0)) files.fail("views.npy does not fit the sequences");
  return starts;
}

// Results of older versions have none.
void read_views(const fs::path& path, const Fields& fields, SequenceResult& result) {
  const Fields files = fields.object("files");
  if (!files.has("views")) return;
  const NpyArray array = read_companion(companion_path(path, "views.npy"), files.object("views"));
  const auto rows = array.values<int32_t>(2);
  if (array.shape()[1] != 2) files.fail("views.npy has other columns");
  size_t row = 0;
  ResultViews& views = result.views.emplace();
  views.query = take_views(rows, row, -1, result.query_frames, files);
  for (size_t s = 0; s < result.sequences.size(); ++s)
    views.train.push_back(
        take_views(rows, row, static_cast<int32_t>(s), result.sequences[s].frames, files));
  if (2 * row != rows.size()) files.fail("views.npy does not fit the sequences");
}

}  // namespace

Json read_result_json(const fs::path& path) {
  const std::string where = path.string();
  Json json = read_json(path, ErrorKind::data);
  require_schema(json, "result", where, ErrorKind::data);
  const Fields fields(json, where);
  if (!fields.has("checksum"))
    throw Error(ErrorKind::data,
                fmt::format("{}: has no checksum, as results of the first layout, so that nobody "
                            "can tell whether it is whole; run vpr-query again",
                            where));
  if (fields.text("checksum") != result_checksum(json)) fields.fail("its checksum does not fit");
  return json;
}

std::string result_method(const fs::path& path) {
  const std::string where = path.string();
  const Json json = read_result_json(path);
  return Fields(json, where).text("method");
}

StoredResult read_result(const fs::path& path, const Monitor& monitor) {
  const std::string where = path.string();
  const Json json = read_result_json(path);
  const Fields fields(json, where);
  StoredResult stored;
  stored.fingerprint = fields.text("checksum");
  SequenceResult& result = stored.result;
  stored_settings_from_json(json, result.settings, where);
  if (result.settings.window_length > score_kind(result.settings.score).longest_window)
    fields.fail("its c_l is out of range");
  const Fields query = fields.object("query");
  result.query_name = query.text("name");
  result.query_frames = query.count("frames", kMostFrames);
  result.query_windows = query.count("windows", result.query_frames);
  if (result.settings.window_length == 0 ||
      result.query_windows != window_count(result.query_frames, result.settings.window_length))
    fields.fail("its numbers of windows and frames do not fit");
  result.query_unreadable = read_frame_list(query, "unreadable", result.query_frames);
  result.sequences = read_sequences(fields, where, result);
  std::vector<Recognition> places;
  for (const Json& item : fields.list("recognitions"))
    places.push_back(read_recognition(Fields(item, where), result));
  read_cells(path, fields, result);
  check_clusterable(fields, result);
  cluster(result, monitor);
  if (result.places != places) fields.fail("its recognitions are not the clusters of its hits");
  read_views(path, fields, result);
  if (json["files"].contains("matrix"))
    stored.matrix_checksum = fields.object("files").object("matrix").text("checksum");
  return stored;
}

}  // namespace vpr
