// The public interface: converts its types to those of the stages, and back.
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <string_view>

#include <fmt/format.h>
#include <opencv2/core.hpp>

#include "base/error.h"
#include "evaluate/metrics.h"
#include "truth/ground_truth.h"
#include "vpr/calls.h"

/// Types of the stages whose names vpr.h also has.
namespace vpr::stages {
using vpr::Error;
using vpr::ErrorKind;
using vpr::Match;
using vpr::Monitor;
using vpr::Result;
}  // namespace vpr::stages

#include "vpr/vpr.h"

namespace vpr {
inline namespace api {

struct Database::Content {
  calls::DatabasePointer database;
};

struct Result::Content {
  std::shared_ptr<const StoredResult> stored;
  std::vector<std::optional<Match>> best;
  std::vector<Match> recognitions;
};

struct Live::Content {
  calls::Keywords keywords;
  Monitor monitor;
  calls::DatabasePointer database;
  std::optional<calls::Live> live;
};

namespace {

ErrorKind kind_of(stages::ErrorKind kind) {
  switch (kind) {
    case stages::ErrorKind::usage:
      return ErrorKind::usage;
    case stages::ErrorKind::input:
      return ErrorKind::input;
    case stages::ErrorKind::output:
      return ErrorKind::output;
    case stages::ErrorKind::interrupted:
      return ErrorKind::interrupted;
    case stages::ErrorKind::internal:
      return ErrorKind::internal;
    default:
      return ErrorKind::data;
  }
}

// Runs `work(monitor)`, whose errors become public ones.
template <class Work>
auto run(const ProcessSettings& process, const Monitor& monitor, Work&& work) {
  try {
    const stages::Monitor inner{monitor.progress, monitor.warn, monitor.stop};
    const calls::ProcessTurn turn(process, inner);
    return work(inner);
  } catch (const stages::Error& error) {
    throw Error(kind_of(error.kind()), error.what());
  } catch (const std::filesystem::filesystem_error& error) {
    throw Error(ErrorKind::output, fmt::format("{}: cannot be read or written: {}",
                                               error.path1().string(), error.code().message()));
  }
}

template <class Handle>
const auto& content_of(const Handle& handle, const char* what) {
  if (!handle.content) throw Error(ErrorKind::usage, fmt::format("the {} is empty", what));
  return *handle.content;
}

// Sets the value at a key; those with a dot are in a nested object.
void set(Json& json, const std::string& key, const Value& setting) {
  const size_t dot = key.find('.');
  if (dot == std::string::npos) {
    std::visit([&](const auto& value) { json[key] = value; }, setting.value);
    return;
  }
  Json& nested = json[key.substr(0, dot)];
  if (!nested.is_object()) nested = Json::object();
  set(nested, key.substr(dot + 1), setting);
}

calls::Keywords keywords_of(const std::string& function, const Settings& settings) {
  Json json = Json::object();
  for (const auto& [key, setting] : settings) {
    const auto* number = std::get_if<double>(&setting.value);
    const auto* text = std::get_if<std::string>(&setting.value);
    if (number != nullptr && !std::isfinite(*number))
      throw Error(ErrorKind::usage, fmt::format("{}: {} is not a finite number", function, key));
    if (text != nullptr && text->empty())
      throw Error(ErrorKind::usage, fmt::format("{}: {} is empty. Omit it", function, key));
    set(json, key, setting);
  }
  try {
    return {function, std::move(json)};
  } catch (const stages::Error& error) {
    throw Error(kind_of(error.kind()), error.what());
  }
}

// With a copy, whose memory the database uses for bits.
std::shared_ptr<const NpyArray> view_of(const Descriptors& descriptors, const std::string& name,
                                        bool is_copied) {
  constexpr std::string_view kTypes[] = {"<f2", "<f4", "<f8", "|u1", "|b1"};
  const NpyHeader header{std::string(kTypes[static_cast<size_t>(descriptors.type)]),
                         {descriptors.rows, descriptors.columns}};
  size_t bytes = number_type_of(name, header).bytes;
  if (__builtin_mul_overflow(bytes, descriptors.rows, &bytes) ||
      __builtin_mul_overflow(bytes, descriptors.columns, &bytes) ||
      (bytes > 0 && descriptors.values == nullptr))
    throw stages::Error(stages::ErrorKind::usage, "{}: has no values", name);
  const std::span values(static_cast<const std::byte*>(descriptors.values), bytes);
  if (!is_copied) return std::make_shared<const NpyArray>(name, header, values);
  struct Copy {
    std::vector<std::byte> values;
    NpyArray view;
  };
  const auto copy = std::make_shared<Copy>(Copy{{values.begin(), values.end()}, {}});
  copy->view = NpyArray(name, header, copy->values);
  return {copy, &copy->view};
}

std::vector<NamedArgument> arguments_of(const std::vector<Sequence>& sequences,
                                        const std::string& array_name, bool is_copied) {
  std::vector<calls::Frames> frames;
  for (const Sequence& sequence : sequences) {
    if (const auto* path = std::get_if<std::string>(&sequence.frames)) {
      frames.push_back({sequence.name, std::filesystem::path(*path)});
      continue;
    }
    const auto& values = std::get<Descriptors>(sequence.frames);
    const bool are_bits =
        values.type == Descriptors::Type::uint8 || values.type == Descriptors::Type::boolean;
    frames.push_back({sequence.name, [=](const std::string& name) {
                        return view_of(values, name, is_copied && are_bits);
                      }});
  }
  return calls::named_arguments(frames, array_name);
}

Match match_of(const stages::Result& result, const stages::Match& match) {
  const size_t length = result.window_length();
  Match made;
  made.query = anchor_of(match.query, length);
  made.sequence = result.places ? result.places->names[match.train]
                                : result.sequences[match.sequence].sequence.name;
  made.frame = anchor_of(match.train, length);
  made.score = result.places ? match.score : result.score().frame_value(match.score, length);
  return made;
}

std::optional<Match> best_of(const stages::Result& shape, const std::optional<stages::Match>& best,
                             std::optional<double> margin) {
  if (!best) return std::nullopt;
  Match made = match_of(shape, *best);
  made.margin = margin;
  return made;
}

std::vector<Match> recognitions_of(const stages::Result& result) {
  std::vector<Match> made;
  for (const stages::Match& match : result.recognitions) {
    made.push_back(match_of(result, match));
    if (result.best[match.query] == match) made.back().margin = frame_margin(result, match.query);
  }
  return made;
}

std::vector<Match> recognitions_of(const vpr::LiveAnswer& answer, const stages::Result& shape) {
  std::vector<Match> made;
  for (const stages::Match& match : answer.recognized) {
    made.push_back(match_of(shape, match));
    if (!has_paths(shape.settings) && answer.best == match) made.back().margin = answer.margin;
  }
  return made;
}

Result result_of(std::shared_ptr<const StoredResult> stored) {
  const auto content = std::make_shared<Result::Content>();
  const stages::Result& result = stored->result;
  content->best.resize(result.query.frames);
  for (size_t window = 0; window < result.best.size(); ++window)
    content->best[anchor_of(window, result.window_length())] =
        best_of(result, result.best[window], frame_margin(result, window));
  content->recognitions = recognitions_of(result);
  content->stored = std::move(stored);
  return {content};
}

// `open`: returns the ground truth. `text`: its path or name; empty: in memory.
template <class Open>
Evaluation evaluation_of(const Result& result, Open&& open, const std::string& text,
                         const Settings& settings, const Monitor& monitor) {
  const auto& stored = content_of(result, "result").stored;
  calls::Keywords keywords = keywords_of("vpr::evaluate", settings);
  return run(keywords.process, monitor, [&](const stages::Monitor& inner) {
    const auto judged = calls::evaluate(keywords, stored, {}, open(), text, inner);
    const Localization& path = judged->evaluation.judgment.localization;
    Evaluation made;
    made.summary = judged->summary();
    made.frames = path.frames;
    made.frames_with_match = path.frames_with_match;
    made.recognized = path.recognized;
    made.correct = path.correct;
    made.incorrect = path.incorrect;
    const auto value = [&](std::string_view key) {
      return value_of(judged->report, metric_at(key, 1));
    };
    made.recall_at_1 = value("recall_at");
    made.recall_at_full_precision = value("recall_at_100_precision");
    made.average_precision = value("average_precision");
    made.report = judged->text();
    return made;
  });
}

// A view of the pixels.
std::shared_ptr<const cv::Mat> mat_of(const Image& image) {
  constexpr size_t kMost = std::numeric_limits<int>::max();
  const auto& [pixels, width, height, channels, stride] = image;
  const bool has_size = pixels != nullptr && width > 0 && height > 0 && width <= kMost / 3 &&
                        height <= kMost && (stride == 0 || stride >= width * channels);
  if (!has_size || (channels != 1 && channels != 3))
    throw Error(ErrorKind::usage,
                "an image has height rows of width gray levels, or of width times blue, green, "
                "red, and a stride of at least this length");
  return std::make_shared<const cv::Mat>(
      static_cast<int>(height), static_cast<int>(width), channels == 3 ? CV_8UC3 : CV_8UC1,
      const_cast<uint8_t*>(pixels), stride == 0 ? size_t{cv::Mat::AUTO_STEP} : stride);
}

template <class Query>
Live::Answer answer_to(Query& query, const LiveFrame& frame) {
  return run(query.keywords.process, query.monitor, [&](const stages::Monitor& monitor) {
    const std::optional<vpr::LiveAnswer> taken = query.live->take(frame, monitor);
    const LiveLines& lines = query.live->lines();
    Live::Answer answer;
    answer.frame = lines.last().number;
    if (!taken) return answer;
    answer.best = best_of(lines.shape(), taken->best, taken->margin);
    answer.recognized = recognitions_of(*taken, lines.shape());
    return answer;
  });
}

}  // namespace

std::vector<std::string> Database::sequences() const {
  return content_of(*this, "database").database->names();
}

void Database::save(const std::filesystem::path& folder, bool replace) const {
  const auto& database = content_of(*this, "database").database;
  run({}, {}, [&](const auto&) { calls::save(*database, folder, replace); });
}

const std::vector<std::optional<Match>>& Result::best() const {
  return content_of(*this, "result").best;
}

const std::vector<Match>& Result::recognitions() const {
  return content_of(*this, "result").recognitions;
}

void Result::save(const std::filesystem::path& file, bool replace) const {
  const auto& stored = content_of(*this, "result").stored;
  run({}, {}, [&](const auto&) { calls::save(*stored, file, replace); });
}

Database train(const std::vector<Sequence>& sequences, const Settings& settings,
               const Monitor& monitor, const std::vector<Sequence>& pretrain) {
  if (sequences.empty()) throw Error(ErrorKind::usage, "vpr::train: there are no sequences");
  calls::Keywords keywords = keywords_of("vpr::train", settings);
  return run(keywords.process, monitor, [&](const stages::Monitor& inner) {
    std::vector<SequenceArgument> other;
    for (const NamedArgument& one : arguments_of(pretrain, "pretrain", true))
      other.push_back(one.sequence);
    return Database{std::make_shared<Database::Content>(Database::Content{
        calls::train(keywords, arguments_of(sequences, "train", true), other, inner)})};
  });
}

Database load_database(const std::filesystem::path& folder) {
  return run({}, {}, [&](const auto&) {
    return Database{
        std::make_shared<Database::Content>(Database::Content{calls::read_database(folder)})};
  });
}

Result query(const Database& database, const Sequence& sequence, const Settings& settings,
             const Monitor& monitor) {
  const auto& trained = content_of(database, "database").database;
  calls::Keywords keywords = keywords_of("vpr::query", settings);
  return run(keywords.process, monitor, [&](const stages::Monitor& inner) {
    const NamedArgument query = arguments_of({sequence}, "query", false).front();
    return result_of(calls::query(keywords, QueryCommand::query, trained, {query}, inner));
  });
}

Result load_result(const std::filesystem::path& file) {
  return run({}, {}, [&](const stages::Monitor& inner) {
    return result_of(std::make_shared<const StoredResult>(read_result(file, inner)));
  });
}

Live::Live(const Database& database, const Settings& settings, Monitor monitor)
    : content_(std::make_shared<Content>(Content{keywords_of("vpr::Live", settings),
                                                 std::move(monitor),
                                                 content_of(database, "database").database,
                                                 {}})) {
  run(content_->keywords.process, content_->monitor, [&](const stages::Monitor& inner) {
    content_->live.emplace(content_->keywords, content_->database, inner);
  });
}

Live::Answer Live::add(const std::filesystem::path& file) {
  if (file.empty()) throw Error(ErrorKind::usage, "the path of the frame is empty");
  LiveFrame frame;
  frame.name = file.filename().string();
  frame.file = file;
  return answer_to(*content_, frame);
}

Live::Answer Live::add(const Image& image) {
  LiveFrame frame;
  frame.picture = mat_of(image);
  return answer_to(*content_, frame);
}

Live::Answer Live::add(const Descriptors& row) {
  if (row.rows != 1)
    throw Error(ErrorKind::usage,
                fmt::format("a frame has one row of descriptors, found {}", row.rows));
  LiveFrame frame;
  frame.array = run(content_->keywords.process, content_->monitor,
                    [&](const auto&) { return view_of(row, "frame", false); });
  return answer_to(*content_, frame);
}

Live::Answer Live::add_missing() { return answer_to(*content_, {}); }

std::vector<Match> Live::finish() {
  return run(content_->keywords.process, content_->monitor, [&](const auto&) {
    const std::optional<vpr::LiveAnswer> last = content_->live->finish();
    return last ? recognitions_of(*last, content_->live->lines().shape()) : std::vector<Match>{};
  });
}

Evaluation evaluate(const Result& result, const std::filesystem::path& ground_truth,
                    const Settings& settings, const Monitor& monitor) {
  const std::string text = ground_truth.string();
  if (text.empty()) throw Error(ErrorKind::usage, "vpr::evaluate: the ground truth is empty");
  return evaluation_of(
      result, [&] { return parse_ground_truth_argument(text, 0); }, text, settings, monitor);
}

Evaluation evaluate(const Result& result, const std::vector<Pair>& pairs, const Settings& settings,
                    const Monitor& monitor) {
  const auto in_memory = [&] {
    std::vector<PlacePair> converted;
    for (const Pair& pair : pairs) converted.push_back({pair.query, pair.frame, pair.sequence});
    GroundTruthArgument truth{"pairs", "pairs"};
    truth.pairs = std::make_shared<const std::vector<PlacePair>>(std::move(converted));
    return truth;
  };
  return evaluation_of(result, in_memory, "", settings, monitor);
}

}  // namespace api
}  // namespace vpr
