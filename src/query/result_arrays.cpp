#include "query/result_arrays.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <tuple>
#include <variant>

#include <fmt/format.h>

#include "base/checksum.h"
#include "base/error.h"
#include "base/mapped_file.h"
#include "base/npy.h"
#include "base/zip_file.h"
#include "query/score_layout.h"

namespace vpr {
namespace {

namespace fs = std::filesystem;

constexpr size_t kPieceBytes = size_t{1} << 26;  // of a large file in memory
constexpr size_t kReadBytes = size_t{1} << 20;   // of an array whose length is not known yet
constexpr size_t kMostRows = size_t{1} << 48;
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr double kMostSum = 4294967295.0;  // over a window
constexpr uint32_t kNoIndex = std::numeric_limits<uint32_t>::max();

/// Throws an error with the damage of an array.
using Refuse = std::function<void(std::string_view damage)>;

/// An array as a function of a result, and the reverse.
template <class T>
struct ArrayFormat {
  const char* name;
  std::vector<std::string_view> columns;  ///< as in ResultArray; empty: those of matches
  /// Nullopt: it is not written. A reader needs the array if the content before it implies values.
  std::optional<std::vector<T>> (*values)(const Result& result);
  void (*read)(Result& result, std::span<const T> values, const Refuse& refuse);
};
using Integers = ArrayFormat<int32_t>;
using Doubles = ArrayFormat<double>;

using Values = std::optional<std::vector<double>>;
using Rows = std::optional<std::vector<int32_t>>;

size_t match_columns(const Result& result) { return result.places ? 4 : 3; }

template <class T>
std::vector<std::string_view> columns_of(const ArrayFormat<T>& array, const Result& result) {
  if (!array.columns.empty()) return array.columns;
  if (result.places) return {"query", "sequence", "train", "view"};
  return {"query", "sequence", "train"};
}

// A row per match, or optional match; -1 except for the query window without one.
Rows match_rows(const Result& result, const auto& matches) {
  const size_t columns = match_columns(result);
  std::vector<int32_t> rows;
  rows.reserve(columns * matches.size());
  for (uint32_t i = 0; i < matches.size(); ++i) {
    const Match match =
        std::optional<Match>(matches[i]).value_or(Match{i, kNoIndex, kNoIndex, kNoIndex, 0});
    const std::array<uint32_t, 4> row = {match.query, match.sequence, match.train, match.view};
    for (size_t c = 0; c < columns; ++c) rows.push_back(static_cast<int32_t>(row[c]));
  }
  return rows;
}

Values match_scores(const auto& matches) {
  std::vector<double> scores;
  for (const std::optional<Match> match : matches) scores.push_back(match ? match->score : kNone);
  return scores;
}

// The match of a row without its score; nullopt for a row of -1.
std::optional<Match> match_of(std::span<const int32_t> row) {
  if (row[2] == -1) return std::nullopt;
  const auto at = [&](size_t column) { return static_cast<uint32_t>(row[column]); };
  return Match{at(0), at(1), at(2), row.size() > 3 ? at(3) : 0, 0};
}

void require_rows(size_t found, size_t expected, const Refuse& refuse) {
  if (found != expected) refuse("does not fit the query");
}

void check_match(const Match& match, const Result& result, const Refuse& refuse) {
  const double sum =
      match.score + static_cast<double>(result.score().offset(result.window_length()));
  const bool is_score = result.places
                            ? std::isfinite(match.score)
                            : sum >= 0 && sum <= kMostSum && std::floor(match.score) == match.score;
  if (!is_score || match.query >= result.query_windows ||
      match.sequence >= result.sequences.size() || !result.sequences[match.sequence].searched ||
      match.train >=
          window_count(result.sequences[match.sequence].sequence.frames, result.window_length()) ||
      (result.places && match.view >= result.places->views))
    refuse("has an index or a score that is out of range");
}

Values with_nan(const std::vector<std::optional<double>>& values) {
  if (values.empty()) return std::nullopt;
  std::vector<double> found;
  for (const std::optional<double> value : values) found.push_back(value.value_or(kNone));
  return found;
}

std::vector<std::optional<double>> without_nan(std::span<const double> values) {
  std::vector<std::optional<double>> found;
  for (const double value : values)
    found.push_back(std::isnan(value) ? std::nullopt : std::optional(value));
  return found;
}

void read_recognitions(Result& result, std::span<const int32_t> values, const Refuse& refuse) {
  const size_t columns = match_columns(result);
  for (size_t i = 0; i < values.size(); i += columns) {
    const auto match = match_of(values.subspan(i, columns));
    if (!match) refuse("has a recognition without a match");
    result.recognitions.push_back(*match);
  }
}

void read_recognition_scores(Result& result, std::span<const double> values, const Refuse& refuse) {
  std::vector<Match>& all = result.recognitions;
  require_rows(values.size(), all.size(), refuse);
  const auto position = [](const Match& one) {
    return std::tie(one.query, one.sequence, one.train);
  };
  for (size_t i = 0; i < all.size(); ++i) {
    all[i].score = values[i];
    check_match(all[i], result, refuse);
    if (i > 0 && position(all[i - 1]) >= position(all[i])) refuse("is not in order");
  }
}

void read_best(Result& result, std::span<const int32_t> values, const Refuse& refuse) {
  const size_t columns = match_columns(result);
  require_rows(values.size() / columns, result.query_windows, refuse);
  for (size_t i = 0; i < values.size(); i += columns)
    result.best.push_back(match_of(values.subspan(i, columns)));
}

void read_best_scores(Result& result, std::span<const double> values, const Refuse& refuse) {
  require_rows(values.size(), result.query_windows, refuse);
  for (size_t window = 0; window < values.size(); ++window) {
    if (!result.best[window]) continue;
    result.best[window]->score = values[window];
    check_match(*result.best[window], result, refuse);
  }
}

void read_margins(Result& result, std::span<const double> values, const Refuse& refuse) {
  require_rows(values.size(), result.query_windows, refuse);
  result.margins = without_nan(values);
  for (size_t window = 0; window < values.size(); ++window)
    if (const auto margin = result.margins[window];
        margin && (!result.best[window] || result.places ||
                   !(*margin >= 0 && *margin <= kMostSum) || std::floor(*margin) != *margin))
      refuse("has a number out of range");
}

// A row per query frame: the rate, the number of the path, and the frame that decided.
Values path_rows(const Result& result) {
  if (!result.path) return std::nullopt;
  const ResultPath& path = *result.path;
  std::vector<double> rows;
  for (size_t frame = 0; frame < path.rates.size(); ++frame) {
    const std::optional<uint32_t> decided = path.decided[frame];
    rows.insert(rows.end(), {path.rates[frame].value_or(kNone),
                             static_cast<double>(path.numbers[frame]), decided ? *decided : kNone});
  }
  return rows;
}

void read_path(Result& result, std::span<const double> values, const Refuse& refuse) {
  const size_t frames = result.query.frames;
  require_rows(values.size(), 3 * frames, refuse);
  const ResultPath counts = std::move(result.path).value_or(ResultPath{});
  if (counts.reversed_frames.value_or(0) > frames)
    refuse("has more reversed frames than the query");
  if (counts.keyframes.value_or(0) > frames) refuse("has more keyframes than query frames");
  ResultPath& path = result.path.emplace(frames);
  path.reversed_frames = counts.reversed_frames;
  path.keyframes = counts.keyframes;
  const auto is_whole = [](double value, size_t least, size_t most) {
    return value >= static_cast<double>(least) && value <= static_cast<double>(most) &&
           value == std::floor(value);
  };
  for (size_t frame = 0; frame < frames; ++frame) {
    const double* row = values.data() + 3 * frame;
    const bool is_valid = (std::isnan(row[0]) || (row[0] >= 0 && row[0] <= kMostSum)) &&
                          is_whole(row[1], 0, frames) &&
                          (std::isnan(row[2]) || is_whole(row[2], frame, frames - 1));
    if (!is_valid) refuse("has a number out of range");
    if (!std::isnan(row[0])) path.rates[frame] = row[0];
    path.numbers[frame] = static_cast<uint32_t>(row[1]);
    if (!std::isnan(row[2])) path.decided[frame] = static_cast<uint32_t>(row[2]);
  }
  for (const Match& recognition : result.recognitions)
    if (!path.decided[anchor_of(recognition.query, result.window_length())])
      refuse("does not say when a recognized frame was decided");
}

// A row per query frame: the margin of the path alone and the contrast of features that decided it.
Values witness_rows(const Result& result) {
  if (!result.path || result.path->witnessed.empty()) return std::nullopt;
  std::vector<double> rows;
  for (const auto& decided : result.path->witnessed)
    rows.insert(rows.end(), {decided ? decided->margin : kNone,
                             decided ? decided->contrast.value_or(kNone) : kNone});
  return rows;
}

void read_witness(Result& result, std::span<const double> values, const Refuse& refuse) {
  constexpr double kMost = 100;  // above any logarithm of counts
  require_rows(values.size(), 2 * result.query.frames, refuse);
  if (!result.path) refuse("does not fit the method");
  for (size_t i = 0; i < values.size(); i += 2) {
    auto& decided = result.path->witnessed.emplace_back();
    if (std::isnan(values[i])) continue;
    if (!(values[i] >= 0 && values[i] <= kMostSum) || std::abs(values[i + 1]) > kMost)
      refuse("has a number out of range");
    decided = {values[i], {}};
    if (!std::isnan(values[i + 1])) decided->contrast = values[i + 1];
  }
}

// The first frames of keyframes as rows of sequence and frame; the query is sequence -1.
Rows keyframe_rows(const Result& result) {
  if (!result.keyframes) return std::nullopt;
  std::vector<int32_t> rows;
  const auto add = [&](int32_t sequence, const std::vector<uint32_t>& starts) {
    for (const uint32_t frame : starts)
      rows.insert(rows.end(), {sequence, static_cast<int32_t>(frame)});
  };
  add(-1, result.keyframes->query);
  for (size_t t = 0; t < result.keyframes->train.size(); ++t)
    add(static_cast<int32_t>(t), result.keyframes->train[t]);
  return rows;
}

void read_keyframes(Result& result, std::span<const int32_t> values, const Refuse& refuse) {
  size_t row = 0;
  const auto consume = [&](int32_t sequence, uint64_t frames) {
    std::vector<uint32_t> starts;
    for (; 2 * row < values.size() && values[2 * row] == sequence; ++row) {
      const int32_t frame = values[2 * row + 1];
      const bool follows =
          starts.empty() ? frame == 0 : frame > 0 && static_cast<uint32_t>(frame) > starts.back();
      if (!follows || static_cast<uint64_t>(frame) >= frames)
        refuse("has a frame that is out of range or order");
      starts.push_back(static_cast<uint32_t>(frame));
    }
    if (starts.empty() != (frames == 0)) refuse("does not fit the sequences");
    return starts;
  };
  ResultKeyframes& keyframes = result.keyframes.emplace();
  keyframes.query = consume(-1, result.query.frames);
  for (int32_t t = 0; t < std::ssize(result.sequences); ++t)
    keyframes.train.push_back(consume(t, result.sequences[t].sequence.frames));
  if (2 * row != values.size()) refuse("does not fit the sequences");
}

Values new_place(const Result& result) {
  return result.places ? Values(result.places->new_place) : std::nullopt;
}

void read_new_place(Result& result, std::span<const double> values, const Refuse& refuse) {
  require_rows(values.size(), result.query.frames, refuse);
  result.places->new_place.assign(values.begin(), values.end());
}

Rows past_rows(const Result& result) {
  if (!is_loop(result.settings)) return std::nullopt;
  return std::vector<int32_t>(result.past.begin(), result.past.end());
}

void read_past(Result& result, std::span<const int32_t> values, const Refuse& refuse) {
  require_rows(values.size(), result.query.frames, refuse);
  const auto first = static_cast<int64_t>(first_own_place(result));
  for (int64_t frame = 0; frame < std::ssize(values); ++frame) {
    if (values[frame] < first || values[frame] > first + frame) refuse("has a number out of range");
    result.past.push_back(static_cast<uint32_t>(values[frame]));
  }
}

template <class ResultOrConst>
auto selected_sequences(ResultOrConst& result, bool is_query) {
  std::vector<decltype(&result.query)> found;
  if (is_query) found.push_back(&result.query);
  if (!is_query)
    for (auto& compared : result.sequences) found.push_back(&compared.sequence);
  return found;
}

template <bool is_query>
Rows selected_frames(const Result& result) {
  const auto sequences = selected_sequences(result, is_query);
  const auto is_selected = [](const Sequence* one) { return one->selection.is_selected(); };
  if (std::ranges::none_of(sequences, is_selected)) return std::nullopt;
  return source_rows(sequences);
}

template <bool is_query>
void read_selected(Result& result, std::span<const int32_t> values, const Refuse& refuse) {
  read_sources(
      selected_sequences(result, is_query),
      [&] { return std::vector<int32_t>(values.begin(), values.end()); },
      [&] { refuse("does not fit its sequences"); });
}

/// In the order of files. A reader may use what precedes its array.
const std::array<std::variant<Integers, Doubles>, 12> kArrays = {
    Integers{"recognitions",
             {},
             [](const Result& r) { return match_rows(r, r.recognitions); },
             read_recognitions},
    Doubles{"recognition_scores",
            {""},
            [](const Result& r) { return match_scores(r.recognitions); },
            read_recognition_scores},
    Integers{"best", {}, [](const Result& r) { return match_rows(r, r.best); }, read_best},
    Doubles{"best_scores",
            {""},
            [](const Result& r) { return match_scores(r.best); },
            read_best_scores},
    Doubles{"margins", {""}, [](const Result& r) { return with_nan(r.margins); }, read_margins},
    Doubles{"path", {"rate", "path", "decided"}, path_rows, read_path},
    Doubles{"witness", {"margin", "contrast"}, witness_rows, read_witness},
    Integers{"keyframes", {"sequence", "frame"}, keyframe_rows, read_keyframes},
    Doubles{"new_place", {""}, new_place, read_new_place},
    Integers{"past", {""}, past_rows, read_past},
    Integers{"source_frames", {""}, selected_frames<true>, read_selected<true>},
    Integers{"train_source_frames", {""}, selected_frames<false>, read_selected<false>}};

void for_each_array(const auto& body) {
  for (const auto& array : kArrays) std::visit(body, array);
}

std::string header_of(std::string_view type, size_t rows, size_t columns) {
  std::vector<size_t> shape = {rows};
  if (columns > 1) shape.push_back(columns);
  return npy_header(type, shape);
}

// At most `most` bytes of a file in an archive; empty if there is no such file.
std::vector<std::byte> read_content(ZipFile& archive, const std::string& name, size_t most) {
  std::vector<std::byte> bytes;
  const auto found = std::ranges::find(archive.names(), name);
  if (found == archive.names().end()) return bytes;
  ZipFile::Entry entry(archive, static_cast<size_t>(found - archive.names().begin()));
  size_t end = 0;
  for (size_t count = 1; count > 0 && end < most; end += count) {
    bytes.resize(std::min(most, end + kReadBytes));
    count = entry.read(std::span(bytes).subspan(end));
  }
  bytes.resize(end);
  return bytes;
}

}  // namespace

fs::path array_path(const fs::path& result) {
  fs::path path = result;
  if (path.extension() == ".json") path.replace_extension();
  return path += ".npz";
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

void visit_arrays(const Result& result, const std::function<void(const ResultArray&)>& visit) {
  for_each_array([&]<class T>(const ArrayFormat<T>& array) {
    const auto values = array.values(result);
    if (!values) return;
    std::vector<std::string_view> columns = columns_of(array, result);
    const size_t rows = values->size() / columns.size();
    visit({array.name, npy_type<T>(), rows, std::move(columns), std::as_bytes(std::span(*values))});
  });
}

void write_arrays(const Result& result, FileEntries& entries, Output* file) {
  std::optional<ZipWriter> archive;
  if (file != nullptr) archive.emplace(*file);
  visit_arrays(result, [&](const ResultArray& array) {
    const std::string header = header_of(array.type, array.rows, array.columns.size());
    const auto start = std::as_bytes(std::span(header));
    ChecksumStream sum;
    sum.add(start);
    sum.add(array.values);
    entries[array.name] = {array.rows, sum.text()};
    if (archive) archive->add(array.name + ".npy", {start, array.values});
  });
  if (archive) archive->finish();
}

void read_arrays(const fs::path& path, const FileEntries& entries, const JsonSource& source,
                 Result& result) {
  const fs::path file = array_path(path);
  std::error_code unknown;
  if (!fs::exists(file, unknown))
    throw Error(ErrorKind::input, "{} needs {} next to it", path.string(),
                file.filename().string());
  ZipFile archive(file);
  for_each_array([&]<class T>(const ArrayFormat<T>& array) {
    const std::string name = array.name + std::string(".npy");
    const auto entry = entries.find(array.name);
    if (entry == entries.end()) {
      if (array.values(result)) source.fail(fmt::format("it has no {}", name));
      return;
    }
    const Refuse refuse = [&](std::string_view damage) {
      source.fail(fmt::format("{} {}", name, damage));
    };
    const size_t columns = columns_of(array, result).size();
    const size_t rows = entry->second.rows;
    if (rows > kMostRows) refuse("has too many rows");
    const std::string header = header_of(npy_type<T>(), rows, columns);
    const size_t size = header.size() + sizeof(T) * columns * rows;
    const std::vector<std::byte> bytes = read_content(archive, name, size + 1);
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    if (checksum(text) != entry->second.checksum)
      throw Error(ErrorKind::data,
                  "{}, {}: belongs to another run than {}, or is damaged; run vpr-query again, "
                  "with --force",
                  file.string(), name, path.filename().string());
    if (text.size() != size || !text.starts_with(header))
      refuse("has another type or other rows or columns");
    array.read(result, {reinterpret_cast<const T*>(bytes.data() + header.size()), columns * rows},
               refuse);
  });
}

}  // namespace vpr
