// Visual place recognition: trains a database, recognizes its places in a query sequence or frame
// by frame, and evaluates the result.
//
//   const vpr::Database database = vpr::train({"monday"});
//   const vpr::Result result = vpr::query(database, "tuesday");
//   const std::string text = vpr::evaluate(result, "pairs.csv", {{"tolerance", 3}}).summary;
//
// Functions have the defaults of the programs vpr-train, vpr-query and vpr-eval, and return their
// numbers. Frames count from 0. Functions throw Error. Databases and results are handles: copies
// are cheap and share one constant content. Calls run on all cores, or on the number of the setting
// "threads"; those of several threads run one after the other.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

namespace vpr {
inline namespace api {  // the library itself has types with the same names

enum class ErrorKind {
  usage,        ///< wrong settings, or an output that exists
  input,        ///< a file is missing or cannot be decoded
  output,       ///< a file cannot be written
  data,         ///< data are damaged or do not match
  interrupted,  ///< by Monitor::stop
  internal      ///< a defect of the library
};

/// The message says what is wrong, where, and what to do.
class Error : public std::runtime_error {
 public:
  Error(ErrorKind kind, const std::string& message) : std::runtime_error(message), kind_(kind) {}
  ErrorKind kind() const { return kind_; }

 private:
  ErrorKind kind_;
};

/// The value of a setting.
struct Value {
  std::variant<bool, std::int64_t, double, std::string, std::vector<std::int64_t>,
               std::vector<std::string>>
      value;

  Value(bool flag) : value(flag) {}
  template <class T, std::enable_if_t<std::is_integral_v<T> && !std::is_same_v<T, bool>, int> = 0>
  Value(T number) : value(static_cast<std::int64_t>(number)) {}
  Value(double number) : value(number) {}
  Value(const char* text) : value(std::string(text)) {}
  Value(std::string text) : value(std::move(text)) {}
  Value(std::vector<std::int64_t> numbers) : value(std::move(numbers)) {}
  Value(std::vector<std::string> texts) : value(std::move(texts)) {}
};
/// Settings by the names of flags, with _ for -: {{"c_l", 20}, {"score", "zscore"}}. Keys of nested
/// settings of configuration files are joined by dots: "clustering.eps". Defaults, ranges and
/// errors are those of the programs. All functions also take threads, seed, order and
/// max_megapixels.
using Settings = std::map<std::string, Value>;

/// Callbacks of long work, from any thread; each may be empty. They must neither throw nor call the
/// library.
struct Monitor {
  /// Step, units done, and units in total (0: unknown).
  std::function<void(const std::string& step, std::size_t done, std::size_t total)> progress = {};
  std::function<void(const std::string& sentence)> warn = {};
  const std::atomic<bool>* stop = nullptr;  ///< once true, the call throws Error(interrupted)
};

/// A view of descriptors, one row per frame, row after row without gaps. The caller keeps the
/// values during the call; databases have copies.
struct Descriptors {
  /// Numbers are compared by direction (setting "metric"), bits by Hamming distance. uint8 has 8
  /// bits per value, boolean (0 or 1) has one.
  enum class Type { float16, float32, float64, uint8, boolean };
  const void* values = nullptr;
  std::size_t rows = 0;
  std::size_t columns = 0;  ///< values per row
  Type type = Type::float32;
};

/// A view of the pixels of a frame.
struct Image {
  const std::uint8_t* pixels = nullptr;
  std::size_t width = 0;
  std::size_t height = 0;
  std::size_t channels = 1;  ///< 1: gray; 3: blue, green, red
  std::size_t stride = 0;    ///< bytes from a row to the next one; 0: width * channels
};

/// Frames to train or to query: a folder, list, video or .npy file as on the command line
/// ("monday@10:80"), or descriptors. Without a name, it has the name of the path.
struct Sequence {
  std::variant<std::string, Descriptors> frames;
  std::string name;

  Sequence(const char* path, std::string called = {}) : frames(path), name(std::move(called)) {}
  Sequence(const std::string& path, std::string called = {})
      : frames(path), name(std::move(called)) {}
  Sequence(const std::filesystem::path& path, std::string called = {})
      : frames(path.string()), name(std::move(called)) {}
  Sequence(const Descriptors& values, std::string called = {})
      : frames(values), name(std::move(called)) {}
};

/// A query frame and a training frame. With windows of c_l frames, each is the last one of its
/// window, where the camera is.
struct Match {
  std::size_t query = 0;
  std::string sequence;   ///< of training; for FAB-MAP the name of the place
  std::size_t frame = 0;  ///< in the training sequence; for FAB-MAP the index of the place
  double score = 0;  ///< per frame, smaller is better; for FAB-MAP the probability of the place
  /// How much worse the runner-up of the best match is, per frame; nullopt for other matches, and
  /// if it is unknown.
  std::optional<double> margin = {};
};

/// Training sequences.
struct Database {
  struct Content;
  std::shared_ptr<const Content> content = {};  ///< from train and load_database

  std::vector<std::string> sequences() const;  ///< their names
  /// Writes the folder of vpr-train. Throws Error(usage) if it exists, unless `replace` is set and
  /// it is a database.
  void save(const std::filesystem::path& folder, bool replace = false) const;
};

/// Matches of a query.
struct Result {
  struct Content;
  std::shared_ptr<const Content> content = {};  ///< from query and load_result

  /// By query frame; nullopt if no readable window ends there.
  const std::vector<std::optional<Match>>& best() const;
  /// Accepted matches, by query frame; a frame may have several.
  const std::vector<Match>& recognitions() const;
  /// Writes the result file of vpr-query and its arrays. Throws Error(usage) if it exists, unless
  /// `replace` is set, and for a result that was read from a file.
  void save(const std::filesystem::path& file, bool replace = false) const;
};

/// The headline of an evaluation. Numbers that the data do not determine are absent.
struct Evaluation {
  std::string summary;                ///< sentences of vpr-eval
  std::size_t frames = 0;             ///< of the query
  std::size_t frames_with_match = 0;  ///< in the ground truth: the denominator of shares
  // Query frames by their best accepted match.
  std::size_t recognized = 0;  ///< without regard to the ground truth
  std::size_t correct = 0;
  std::size_t incorrect = 0;  ///< frames without a match in the ground truth included
  // Shares of frames_with_match, from 0 to 1.
  std::optional<double> recall_at_1;               ///< R@1: the best match is correct
  std::optional<double> recall_at_full_precision;  ///< R@100P
  std::optional<double> average_precision;         ///< AP of best matches
  std::string report;  ///< all numbers: JSON, as the report file of vpr-eval
};

/// A pair of frames of the same place, by the frames of whole recordings.
struct Pair {
  std::size_t query = 0;
  std::size_t frame = 0;
  std::string sequence = {};  ///< of training; empty: the only one
};

/// Trains a database with the settings of vpr-train images or descriptors: descriptor, c_l, fps,
/// metric, ... With `pretrain`, frames of other places, those of vpr-train fabmap.
Database train(const std::vector<Sequence>& sequences, const Settings& settings = {},
               const Monitor& monitor = {}, const std::vector<Sequence>& pretrain = {});
/// Reads a folder of vpr-train.
Database load_database(const std::filesystem::path& folder);

/// Recognizes places, by default at any walking speed. Settings: those of vpr-query, such as c_l,
/// score, decide, margin, t_r, method, fps; for FAB-MAP: t_p, c_w, ...
Result query(const Database& database, const Sequence& sequence, const Settings& settings = {},
             const Monitor& monitor = {});
/// Reads a result file (.json) of vpr-query.
Result load_result(const std::filesystem::path& file);

/// A query whose frames arrive one by one, as in vpr-query live. Not for FAB-MAP.
class Live {
 public:
  /// The decisions at a frame.
  struct Answer {
    std::size_t frame = 0;  ///< the number of the frame
    /// Nullopt if no readable window ends at the frame. The filter may later settle another one.
    std::optional<Match> best = {};
    /// Recognitions of this frame; with the filter, also of earlier ones, without margins.
    std::vector<Match> recognized = {};
  };

  /// Settings: those of query, without a selection of frames.
  explicit Live(const Database& database, const Settings& settings = {}, Monitor monitor = {});

  /// Matches the next frame: an image file, pixels or, for a database of descriptors, one row.
  Answer add(const std::filesystem::path& file);
  Answer add(const Image& image);
  Answer add(const Descriptors& row);
  /// The next frame is missing.
  Answer add_missing();
  /// The recognitions of the filter that the end of the query settles. No frame can follow.
  std::vector<Match> finish();

 private:
  struct Content;
  std::shared_ptr<Content> content_;
};

/// Judges a result by a file or folder of any ground truth format, or "aligned". Settings:
/// tolerance (frames), format, radius_m, ... as in data set descriptions; confidence, recall_at.
Evaluation evaluate(const Result& result, const std::filesystem::path& ground_truth,
                    const Settings& settings = {}, const Monitor& monitor = {});
/// The same by pairs; all other pairs show different places.
Evaluation evaluate(const Result& result, const std::vector<Pair>& pairs,
                    const Settings& settings = {}, const Monitor& monitor = {});

}  // namespace api
}  // namespace vpr
