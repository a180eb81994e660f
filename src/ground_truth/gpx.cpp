#include "ground_truth/gpx.h"

#include <algorithm>
#include <exception>
#include <memory>
#include <new>
#include <optional>
#include <utility>

#include <expat.h>
#include <fmt/format.h>

#include "base/mapped_file.h"
#include "base/utf8.h"
#include "ground_truth/calendar_time.h"
#include "ground_truth/geodesy.h"
#include "ground_truth/gps_columns.h"
#include "images/sequence_argument.h"

namespace vpr {
namespace {

/// A tenth of a gigabyte of text, and more than a month of fixes.
constexpr size_t kMostPoints = 4'000'000;
/// What the parser is given at once.
constexpr size_t kPiece = size_t{1} << 20;
/// A time is shorter.
constexpr size_t kMostTimeText = 64;

std::string_view without_prefix(std::string_view name) {
  const size_t colon = name.rfind(':');
  return colon == std::string_view::npos ? name : name.substr(colon + 1);
}

std::string_view without_blanks(std::string_view text) {
  const size_t first = std::min(text.find_first_not_of(" \t\r\n"), text.size());
  const size_t end = text.find_last_not_of(" \t\r\n") + 1;
  return text.substr(first, end - std::min(first, end));
}

std::string_view attribute(const char** attributes, std::string_view name) {
  for (const char** a = attributes; *a != nullptr; a += 2)
    if (name == *a) return a[1];
  return {};
}

/// What is known of the file so far; its functions are called by the parser.
struct GpxReader {
  XML_Parser parser = nullptr;
  FileLocation location;
  FrameRange range;
  Trajectory found;
  size_t points = 0;
  size_t depth = 0;
  size_t point_depth = 0;  ///< 0: not in a track point
  bool is_in_time = false;
  std::string time_text;
  std::optional<int64_t> time_ns;  ///< of the present point
  std::optional<bool> have_times;  ///< whether the points so far have
  std::exception_ptr error;

  /// Runs `work`, which may throw: not through the parser, which is C.
  template <class Work>
  void guard(Work&& work) {
    if (error) return;
    try {
      location.at("line", XML_GetCurrentLineNumber(parser));
      work();
    } catch (...) {
      error = std::current_exception();
      XML_StopParser(parser, XML_FALSE);
    }
  }

  void start(std::string_view name, const char** attributes) {
    ++depth;
    if (depth == 1 && name != "gpx") location.fail(fmt::format("is no GPX, but <{}>", name));
    if (name == "trkpt" && point_depth == 0) {
      point_depth = depth;
      time_ns.reset();
      if (++points > kMostPoints)
        location.fail(fmt::format("has more than {} track points", kMostPoints));
      const Geographic place =
          parse_place(location, attribute(attributes, "lat"), attribute(attributes, "lon"));
      if (!frame_in_range(range, points - 1)) return;
      found.poses.emplace_back(Pose{earth_position(place), {}, {}});
      found.lines.push_back(location.number);
    } else if (name == "time" && point_depth != 0 && depth == point_depth + 1) {
      is_in_time = true;
      time_text.clear();
    }
  }

  void end() {
    if (is_in_time && depth == point_depth + 1) {
      is_in_time = false;
      const auto time = parse_calendar_time(without_blanks(time_text));
      if (!time)
        location.fail(
            fmt::format("\"{}\" is no time; expected one as 2024-05-01T12:34:56Z", time_text));
      time_ns = time->ns;
    } else if (depth == point_depth) {
      end_point();
    }
    --depth;
  }

  void end_point() {
    point_depth = 0;
    if (have_times && *have_times != time_ns.has_value())
      location.fail(time_ns ? "the track points before have no time, and this one has"
                            : "the track point has no time, and those before have");
    have_times = time_ns.has_value();
    if (time_ns && frame_in_range(range, points - 1)) found.times_ns.push_back(*time_ns);
  }

  void text(std::string_view part) {
    if (!is_in_time) return;
    time_text += part;
    if (time_text.size() > kMostTimeText) location.fail("its time is no time");
  }
};

void XMLCALL on_start(void* reader, const XML_Char* name, const XML_Char** attributes) {
  auto& gpx = *static_cast<GpxReader*>(reader);
  gpx.guard([&] { gpx.start(without_prefix(name), attributes); });
}

void XMLCALL on_end(void* reader, const XML_Char*) {
  auto& gpx = *static_cast<GpxReader*>(reader);
  gpx.guard([&] { gpx.end(); });
}

void XMLCALL on_text(void* reader, const XML_Char* text, int length) {
  auto& gpx = *static_cast<GpxReader*>(reader);
  gpx.guard([&] { gpx.text({text, static_cast<size_t>(length)}); });
}

// Entities are declared in a document type alone, and GPX has none.
void XMLCALL on_document_type(void* reader, const XML_Char*, const XML_Char*, const XML_Char*,
                              int) {
  auto& gpx = *static_cast<GpxReader*>(reader);
  gpx.guard([&] { gpx.location.fail("has a document type (<!DOCTYPE>), which GPX has not"); });
}

void parse(GpxReader& reader, std::string_view text) {
  const std::unique_ptr<std::remove_pointer_t<XML_Parser>, decltype(&XML_ParserFree)> parser(
      XML_ParserCreate(nullptr), XML_ParserFree);
  if (!parser) throw std::bad_alloc();
  reader.parser = parser.get();
  XML_SetUserData(parser.get(), &reader);
  XML_SetElementHandler(parser.get(), on_start, on_end);
  XML_SetCharacterDataHandler(parser.get(), on_text);
  XML_SetStartDoctypeDeclHandler(parser.get(), on_document_type);
  for (size_t first = 0; first < text.size() || first == 0; first += kPiece) {
    const std::string_view piece = text.substr(first, kPiece);
    const bool is_last = first + kPiece >= text.size();
    const XML_Status status =
        XML_Parse(parser.get(), piece.data(), static_cast<int>(piece.size()), is_last ? 1 : 0);
    if (reader.error) std::rethrow_exception(reader.error);
    if (status == XML_STATUS_OK) continue;
    const XML_Error error = XML_GetErrorCode(parser.get());
    if (error == XML_ERROR_NO_MEMORY) throw std::bad_alloc();
    reader.location.at("line", XML_GetCurrentLineNumber(parser.get()));
    reader.location.fail(error == XML_ERROR_NO_ELEMENTS || error == XML_ERROR_UNCLOSED_TOKEN
                             ? "the XML ends before its elements do; the file is incomplete"
                             : fmt::format("is damaged XML: {}", XML_ErrorString(error)));
  }
}

}  // namespace

Trajectory read_gpx(const std::filesystem::path& path) {
  const SequenceArgument source = parse_sequence_argument(path.string());
  const MappedFile file(source.path);
  GpxReader reader;
  reader.location.file = path.string();
  reader.range = source.range;
  reader.found.name = path.string();
  reader.found.is_on_earth = true;
  parse(reader, file.text());
  reader.location = {path.string()};
  if (reader.points == 0)
    reader.location.fail(
        "has no track points (<trkpt>); waypoints and routes are no recording of a walk");
  return std::move(reader.found);
}

bool is_gpx(const FileStart& start) {
  const std::string_view text = without_byte_order_mark(start.bytes);
  const size_t first = text.find_first_not_of(" \t\r\n");
  if (first == std::string_view::npos || text[first] != '<') return false;
  return text.find("<gpx") != std::string_view::npos || text.find(":gpx") != std::string_view::npos;
}

}  // namespace vpr
