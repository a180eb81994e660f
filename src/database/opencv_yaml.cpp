#include "database/opencv_yaml.h"

#include <cerrno>
#include <charconv>
#include <limits>
#include <memory>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <yaml.h>
#include <zlib.h>

#include "base/error.h"

namespace vpr {
namespace {

namespace fs = std::filesystem;

constexpr uint64_t kMostUnpacked = uint64_t{128} << 20;  // bytes of a compressed file
constexpr int kMostNested = 8;                           // a matrix's values are nested three deep
constexpr std::string_view kFirstLine = "%YAML:1.0";     // OpenCV's own; YAML has "%YAML 1.0"

/// The bytes of a file, unpacked, without OpenCV's first line.
class Text {
 public:
  explicit Text(const fs::path& path) : file_(::gzopen(path.c_str(), "rb"), ::gzclose) {
    if (!file_)
      throw Error(ErrorKind::input,
                  fmt::format("{}: can't be read: {}", path.string(), system_error_text(errno)));
    std::vector<char> start(kFirstLine.size());
    const int got = ::gzread(file_.get(), start.data(), static_cast<unsigned>(start.size()));
    if (got < 0 || std::string_view(start.data(), static_cast<size_t>(got)) != kFirstLine)
      wrong_ = fmt::format(
          "expected a file that begins with {}, as OpenCV writes YAML; write it "
          "anew with cv::FileStorage and a name that ends in .yml",
          kFirstLine);
  }

  /// Up to `size` bytes; fewer only at the end, or where something is wrong.
  size_t read(unsigned char* bytes, size_t size) {
    if (!wrong_.empty()) return 0;
    const int got = ::gzread(file_.get(), bytes, static_cast<unsigned>(size));
    if (got < 0) {
      wrong_ = "its compressed data are damaged";
      return 0;
    }
    size_ += static_cast<uint64_t>(got);
    if (size_ <= kMostUnpacked || ::gzdirect(file_.get()) != 0) return static_cast<size_t>(got);
    wrong_ = fmt::format(
        "holds more than {} MiB when it is unpacked; if that is meant, unpack it "
        "and name the file that gunzip makes",
        kMostUnpacked >> 20);
    return 0;
  }

  const std::string& wrong() const { return wrong_; }

 private:
  std::unique_ptr<gzFile_s, int (*)(gzFile)> file_;
  uint64_t size_ = 0;
  std::string wrong_;
};

/// What libyaml finds in a text, one event after another.
class Events {
 public:
  explicit Events(const fs::path& path) : path_(path), text_(path) {
    if (yaml_parser_initialize(&parser_) == 0) throw std::bad_alloc();
    yaml_parser_set_input(&parser_, read_text, &text_);
  }
  Events(const Events&) = delete;
  Events& operator=(const Events&) = delete;
  ~Events() {
    yaml_event_delete(&event_);
    yaml_parser_delete(&parser_);
  }

  /// The next event. Throws Error(data) at what is no YAML, or nested too deep.
  yaml_event_type_t next() {
    yaml_event_delete(&event_);
    const bool parsed = yaml_parser_parse(&parser_, &event_) != 0;
    if (!text_.wrong().empty()) fail(text_.wrong());
    if (!parsed)
      fail(fmt::format("expected OpenCV's YAML, found in line {} that libyaml says: {}",
                       parser_.problem_mark.line + 1,
                       parser_.problem != nullptr ? parser_.problem : "no text"));
    const yaml_event_type_t type = event_.type;
    if (type == YAML_MAPPING_START_EVENT || type == YAML_SEQUENCE_START_EVENT) ++nested_;
    if (type == YAML_MAPPING_END_EVENT || type == YAML_SEQUENCE_END_EVENT) --nested_;
    if (nested_ > kMostNested) fail("expected a matrix, found values that are nested deeper");
    return type;
  }

  /// Fails unless the event that was read is of this type.
  void expect_now(yaml_event_type_t type, const char* what) const {
    if (event_.type != type) fail_here(fmt::format("expected {}", what));
  }

  /// Goes past the value that begins with the event that was read.
  void skip() {
    const bool is_nested =
        event_.type == YAML_MAPPING_START_EVENT || event_.type == YAML_SEQUENCE_START_EVENT;
    for (const int outer = nested_ - (is_nested ? 1 : 0); nested_ > outer;) next();
  }

  /// The text of the event that was read, which must be a scalar.
  std::string_view scalar() const {
    expect_now(YAML_SCALAR_EVENT, "a single value");
    return {reinterpret_cast<const char*>(event_.data.scalar.value), event_.data.scalar.length};
  }

  [[noreturn]] void fail_here(const std::string& what) const {
    fail(fmt::format("line {}: {}", event_.start_mark.line + 1, what));
  }
  [[noreturn]] void fail(const std::string& what) const {
    throw Error(ErrorKind::data, fmt::format("{}: {}", path_.string(), what));
  }

 private:
  static int read_text(void* text, unsigned char* bytes, size_t size, size_t* got) {
    *got = static_cast<Text*>(text)->read(bytes, size);
    return 1;
  }

  fs::path path_;
  Text text_;
  yaml_parser_t parser_{};
  yaml_event_t event_{};
  int nested_ = 0;
};

int whole_number(const Events& events) {
  const std::string_view text = events.scalar();
  int number = 0;
  const auto [end, error] = std::from_chars(text.begin(), text.end(), number);
  if (error != std::errc() || end != text.end() || number < 0)
    events.fail_here(fmt::format("expected a size, found \"{}\"", text));
  return number;
}

double real_number(const Events& events) {
  const std::string_view text = events.scalar();
  if (text == ".Nan") return std::numeric_limits<double>::quiet_NaN();
  if (text == ".Inf") return std::numeric_limits<double>::infinity();
  if (text == "-.Inf") return -std::numeric_limits<double>::infinity();
  double number = 0;
  const auto [end, error] = std::from_chars(text.begin(), text.end(), number);
  if (error != std::errc() || end != text.end())
    events.fail_here(fmt::format("expected a number, found \"{}\"", text));
  return number;
}

/// What is written of a matrix.
struct Written {
  int rows = 0;
  int columns = 0;
  std::string type;
  std::vector<double> values;
};

void read_values(Events& events, std::vector<double>& values) {
  events.expect_now(YAML_SEQUENCE_START_EVENT, "a list of values");
  while (events.next() == YAML_SCALAR_EVENT) values.push_back(real_number(events));
  events.expect_now(YAML_SEQUENCE_END_EVENT, "a number");
}

Written read_written(Events& events) {
  Written matrix;
  events.expect_now(YAML_MAPPING_START_EVENT, "a matrix");
  while (events.next() == YAML_SCALAR_EVENT) {
    const std::string key(events.scalar());
    events.next();
    if (key == "rows") {
      matrix.rows = whole_number(events);
    } else if (key == "cols") {
      matrix.columns = whole_number(events);
    } else if (key == "dt") {
      matrix.type = events.scalar();
    } else if (key == "data") {
      read_values(events, matrix.values);
    } else {
      events.skip();
    }
  }
  events.expect_now(YAML_MAPPING_END_EVENT, "a name");
  return matrix;
}

Written find_written(Events& events, const std::string& name) {
  for (const yaml_event_type_t type :
       {YAML_STREAM_START_EVENT, YAML_DOCUMENT_START_EVENT, YAML_MAPPING_START_EVENT}) {
    events.next();
    events.expect_now(type, "named matrices");
  }
  while (events.next() == YAML_SCALAR_EVENT) {
    const bool is_wanted = events.scalar() == name;
    events.next();
    if (is_wanted) return read_written(events);
    events.skip();
  }
  events.fail_here(fmt::format("expected the matrix \"{}\"", name));
}

}  // namespace

cv::Mat read_opencv_matrix(const fs::path& path, const std::string& name, int type) {
  std::error_code error;
  if (!fs::is_regular_file(path, error))
    throw Error(ErrorKind::input, fmt::format("{}: no such file", path.string()));
  Events events(path);
  const Written matrix = find_written(events, name);
  const std::string wanted = type == CV_32F ? "f" : "d";
  if (matrix.type != wanted)
    events.fail(fmt::format("the matrix \"{}\" has values of type \"{}\", expected \"{}\"", name,
                            matrix.type, wanted));
  if (matrix.values.empty() ||
      uint64_t(matrix.rows) * uint64_t(matrix.columns) != matrix.values.size())
    events.fail(fmt::format("the matrix \"{}\" says it has {} x {} values, but has {}", name,
                            matrix.rows, matrix.columns, matrix.values.size()));
  cv::Mat mat;
  cv::Mat(matrix.rows, matrix.columns, CV_64F, const_cast<double*>(matrix.values.data()))
      .convertTo(mat, type);
  return mat;
}

}  // namespace vpr
