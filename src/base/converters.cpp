#include "base/converters.h"

#include <algorithm>
#include <array>

#include "base/error.h"
#include "base/npy.h"
#include "base/text.h"

namespace vpr {
namespace {

namespace fs = std::filesystem;

/// A conversion script and a test for the files that it reads.
struct Converter {
  std::string_view format;
  std::string_view what;
  std::string_view script;
  std::string_view before = {};  ///< a command that makes the input of the script
  bool makes_arrays = false;     ///< its output is an array of any kind, not only ground truth
  bool (*reads)(const fs::path& path, std::string_view start) = nullptr;
};

bool is_opencv_yaml(const fs::path& path, std::string_view start) {
  const fs::path name = path.extension() == ".gz" ? path.stem() : path;
  return name.extension() == ".yml" || name.extension() == ".yaml" || start.starts_with("%YAML");
}

bool is_image(const fs::path&, std::string_view start) {
  constexpr std::array<std::string_view, 6> kSignatures = {"\x89PNG", "\xff\xd8", "BM",
                                                           "P5",      "II*",      "MM"};
  return std::ranges::any_of(
      kSignatures, [&](std::string_view signature) { return start.starts_with(signature); });
}

constexpr Converter kConverters[] = {
    {"mat", "a MAT-file", "mat.py", "", true,
     [](const fs::path& path, std::string_view start) {
       return path.extension() == ".mat" || start.starts_with("MATLAB ") ||
              start.starts_with("\x89HDF\r\n");
     }},
    {"octave", "a text file of Octave", "mat.py", "save -v7 FILE.mat NAME in Octave, then ", true,
     [](const fs::path&, std::string_view start) {
       return start.starts_with("# Created by Octave");
     }},
    {"openfabmap", "OpenCV's YAML", "openfabmap.py", "", true, is_opencv_yaml},
    {"gpx", "a GPX track", "gpx.py", "", false,
     [](const fs::path& path, std::string_view start) {
       return path.extension() == ".gpx" || start.find("<gpx") != std::string_view::npos;
     }},
    {"nmea", "an NMEA log", "gpx.py", "gpsbabel -i nmea -f LOG -o gpx -F track.gpx, then ", false,
     [](const fs::path&, std::string_view start) {
       return std::ranges::any_of(split_lines(start), [](std::string_view line) {
         return line.size() > 6 && line[0] == '$' && line[6] == ',' &&
                (line[1] == 'G' || line[1] == 'B');
       });
     }},
    {"kml", "a KML track", "gpx.py", "gpsbabel -i kml -f FILE -o gpx -F track.gpx, then ", false,
     [](const fs::path&, std::string_view start) {
       return start.find("<kml") != std::string_view::npos;
     }},
    {"tcx", "a TCX track", "gpx.py", "gpsbabel -i gtrnctr -f FILE -o gpx -F track.gpx, then ",
     false,
     [](const fs::path&, std::string_view start) {
       return start.find("<TrainingCenterDatabase") != std::string_view::npos;
     }},
    {"mask", "an image", "mask.py", "", false, is_image},
    {"openseqslam2", "OpenSeqSLAM2's CSV", "openseqslam2.py", "", false, nullptr},
    {"vpr-bench", "an array of Python objects", "vpr_bench.py", "", false,
     [](const fs::path&, std::string_view start) {
       const auto header = parse_npy_header(start);
       return header && header->type == "|O" && !header->shape.empty();  // not a dict
     }}};

}  // namespace

void refuse_convertible(const fs::path& path, std::string_view start, bool arrays_only) {
  for (const Converter& converter : kConverters)
    if (converter.reads != nullptr && (converter.makes_arrays || !arrays_only) &&
        converter.reads(path, start))
      throw Error(ErrorKind::usage, "{} is {}: convert it with {}scripts/convert/{}", path.string(),
                  converter.what, converter.before, converter.script);
}

void refuse_convertible_format(std::string_view format) {
  for (const Converter& converter : kConverters)
    if (converter.format == format)
      throw Error(ErrorKind::usage,
                  "Programs do not read the format {}: convert it with {}scripts/convert/{}",
                  format, converter.before, converter.script);
}

}  // namespace vpr
