#include "report/result_arrays.h"

#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <tuple>
#include <vector>

#include <fmt/format.h>

#include "base/error.h"
#include "base/npy.h"
#include "report/result_file.h"

namespace vpr {
namespace {

namespace fs = std::filesystem;

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
      window_count(result.targets[match.target].frames, result.window_length());
  return match.train < windows && (!result.places || match.view < result.places->views) &&
         is_score(match.score, result);
}

/// Rows of hits.npy or best.npy with their scores; none where a query has no best match.
std::vector<std::optional<Match>> read_rows(const ResultSource& source, const std::string& name,
                                            const std::string& scores_name, const Result& result) {
  const Fields files = source.fields.object("files");
  const fs::path path = companion_path(source.path, name + ".npy");
  const NpyArray array = read_companion(path, files.object(name));
  const auto values = array.values<int32_t>(2);
  const size_t columns = result.places ? 4 : 3;  // query, target, train, and the view of a place
  if (array.shape()[1] != columns) files.fail(path.filename().string() + " has other columns");
  const NpyArray score_array =
      read_companion(companion_path(source.path, scores_name + ".npy"), files.object(scores_name));
  const auto scores = score_array.values<double>(1);
  if (scores.size() != array.shape()[0]) files.fail(name + ".npy and its scores do not fit");
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

}  // namespace

int64_t offset_of(const Result& result) {
  const auto offset = result.score().offset;
  return offset == nullptr ? 0 : offset(result.window_length());
}

uint64_t window_count(uint64_t frames, uint64_t window_length) {
  return frames < window_length ? 0 : frames - window_length + 1;
}

void read_matches(const ResultSource& source, Result& result) {
  for (const auto& hit : read_rows(source, "hits", "hit_scores", result)) {
    if (!hit) source.fields.fail("hits.npy holds a hit of nothing");
    result.hits.push_back(*hit);
  }
  const auto position = [](const Match& hit) { return std::tie(hit.query, hit.target, hit.train); };
  for (size_t h = 1; h < result.hits.size(); ++h)
    if (position(result.hits[h - 1]) >= position(result.hits[h]))
      source.fields.fail("its hits are not in order");
  result.best = read_rows(source, "best", "best_scores", result);
  if (result.best.size() != result.query_windows)
    source.fields.fail("best matches do not fit the query");
}

void read_rates(const ResultSource& source, Result& result) {
  const Fields files = source.fields.object("files");
  if (!files.has("best_rates")) return;
  const NpyArray array =
      read_companion(companion_path(source.path, "best_rates.npy"), files.object("best_rates"));
  const auto rates = array.values<double>(1);
  if (rates.size() != result.query_windows) files.fail("best_rates.npy does not fit the query");
  for (size_t window = 0; window < rates.size(); ++window)
    if (std::isnan(rates[window]) == result.best[window].has_value() || rates[window] <= 0)
      files.fail("best_rates.npy holds what is no rate");
  result.best_rates.assign(rates.begin(), rates.end());
}

void read_margins(const ResultSource& source, Result& result) {
  const Fields files = source.fields.object("files");
  if (!files.has("margins")) return;
  const NpyArray array =
      read_companion(companion_path(source.path, "margins.npy"), files.object("margins"));
  const auto values = array.values<double>(1);
  if (values.size() != result.best.size()) files.fail("margins.npy does not fit the query");
  for (size_t window = 0; window < values.size(); ++window) {
    auto& margin = result.margins.emplace_back();
    if (std::isnan(values[window])) continue;
    margin = values[window];
    if (!result.best[window] || result.places || !(*margin >= 0 && *margin <= kMostSum) ||
        std::floor(*margin) != *margin)
      files.fail("margins.npy holds a number out of range");
  }
}

void read_path(const ResultSource& source, Result& result) {
  const Fields files = source.fields.object("files");
  if (!files.has("path")) return;
  const NpyArray array =
      read_companion(companion_path(source.path, "path.npy"), files.object("path"));
  const auto rows = array.values<double>(2);
  if (array.shape()[1] != 3 || array.shape()[0] != result.query_frames)
    files.fail("path.npy does not fit the query");
  ResultPath& path = result.path.emplace(result.query_frames);
  for (size_t frame = 0; frame < result.query_frames; ++frame) {
    const double nowhere = rows[3 * frame];
    const double rate = rows[3 * frame + 1];
    const double track = rows[3 * frame + 2];
    const bool is_fine = (std::isnan(nowhere) || is_score(nowhere, result)) &&
                         (std::isnan(rate) || (rate >= 0 && rate <= kMostSum)) && track >= 0 &&
                         track <= static_cast<double>(result.query_frames) &&
                         track == std::floor(track);
    if (!is_fine) files.fail("path.npy holds a number out of range");
    path.nowhere[frame] = nowhere;
    path.rates[frame] = rate;
    path.tracks[frame] = static_cast<uint32_t>(track);
  }
}

void read_views(const ResultSource& source, Result& result) {
  const Fields files = source.fields.object("files");
  if (!files.has("views")) return;
  const NpyArray array =
      read_companion(companion_path(source.path, "views.npy"), files.object("views"));
  const auto rows = array.values<int32_t>(2);
  if (array.shape()[1] != 2) files.fail("views.npy has other columns");
  size_t row = 0;
  ResultViews& views = result.views.emplace();
  views.query = take_views(rows, row, -1, result.query_frames, files);
  for (size_t t = 0; t < result.targets.size(); ++t)
    views.train.push_back(
        take_views(rows, row, static_cast<int32_t>(t), result.targets[t].frames, files));
  if (2 * row != rows.size()) files.fail("views.npy does not fit the sequences");
}

void read_new_place(const ResultSource& source, Result& result) {
  const NpyArray array = read_companion(companion_path(source.path, "new_place.npy"),
                                        source.fields.object("files").object("new_place"));
  const auto values = array.values<double>(1);
  result.places->new_place.assign(values.begin(), values.end());
  if (values.size() != result.query_frames)
    source.fields.fail("new_place.npy does not fit the query");
}

}  // namespace vpr
