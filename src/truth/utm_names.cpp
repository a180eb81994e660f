#include "truth/utm_names.h"

#include <algorithm>
#include <vector>

#include <fmt/format.h>

#include "base/error.h"
#include "base/text.h"
#include "sequence/sequence_source.h"
#include "truth/builder.h"
#include "truth/text_file.h"

namespace vpr {
namespace {

// In meters; the radius of the deep visual geo-localization benchmark, which uses these names.
constexpr double kUsualRadius = 25;
constexpr double kMaxZones = 60;

// Indices of the fields between the @ signs; field 0 is before the first one.
enum Field : size_t { kEast = 1, kNorth = 2, kZone = 3, kHeading = 9 };

struct UtmSide {
  Poses poses;
  std::string zone;
};

// Other programs that write such names may put something else there.
bool is_zone(std::string_view field) {
  const auto number = parse_real(field);
  return number && field.size() <= 2 && *number >= 1 && *number <= kMaxZones;
}

UtmSide read_side(GroundTruthBuilder& builder, const std::filesystem::path& path) {
  builder.at_file(path);
  const SequenceSource sequence = open_sequence(parse_sequence_argument(path.string()));
  if (sequence.kind != SequenceKind::images)
    builder.fail("is not a folder or list of images named @east@north@...");
  UtmSide side;
  for (const auto& file : sequence.files) {
    const auto name = parse_utm_name(file.filename().string());
    if (!name)
      builder.fail(
          fmt::format("{} is not named @east@north@...; scripts/convert/exif.py lists the GPS "
                      "positions of JPEG images",
                      file.filename().string()));
    if (side.zone.empty()) side.zone = name->zone;
    if (!name->zone.empty() && name->zone != side.zone)
      builder.fail(
          fmt::format("{} lies in UTM zone {}, others in {}: their distances are meaningless",
                      file.filename().string(), name->zone, side.zone));
    side.poses.emplace_back(name->pose);
  }
  return side;
}

}  // namespace

std::optional<UtmName> parse_utm_name(std::string_view file_name) {
  const auto dot = file_name.rfind('.');
  const auto last_at = file_name.rfind('@');
  // "@1.5@2.5.jpg": the last dot starts the extension, but "@1.5@2.5@" has no extension.
  const bool has_extension =
      dot != std::string_view::npos && last_at != std::string_view::npos && dot > last_at;
  const auto fields = split(has_extension ? file_name.substr(0, dot) : file_name, '@');
  if (fields.size() <= kNorth) return std::nullopt;
  const auto east = parse_real(fields[kEast]);
  const auto north = parse_real(fields[kNorth]);
  if (!east || !north) return std::nullopt;
  UtmName name;
  name.pose.position = {*east, *north, 0};
  if (fields.size() > kZone && is_zone(fields[kZone])) name.zone = fields[kZone];
  if (fields.size() > kHeading) name.pose.heading_deg = parse_real(fields[kHeading]);
  return name;
}

std::string read_utm_names(GroundTruthBuilder& builder) {
  const GroundTruthArgument& argument = builder.argument();
  const size_t sequence = builder.only_searched(argument.path.string());
  if (argument.options.reference.empty())
    throw Error(ErrorKind::usage,
                fmt::format("{}: has the positions of the query; pass the images of the training "
                            "sequence, as in --ground-truth-reference FOLDER",
                            argument.path.string()));
  const UtmSide query = read_side(builder, argument.path);
  builder.require_query_frames(query.poses.size());
  const UtmSide train = read_side(builder, argument.options.reference);
  builder.require_train_frames(sequence, train.poses.size());
  if (!query.zone.empty() && !train.zone.empty() && query.zone != train.zone)
    builder.fail(
        fmt::format("lies in UTM zone {}, but the query in {}: their distances are nothing",
                    train.zone, query.zone));
  return fmt::format("UTM coordinates in file names: {}{}",
                     match_poses(builder, sequence, query.poses, train.poses, kUsualRadius),
                     argument.options.radius_m ? "" : ", the radius of the benchmark");
}

bool is_utm_names(const FileStart& start) {
  if (start.is_folder) return true;
  const size_t slash = start.first_line.rfind('/');
  const std::string_view name =
      slash == std::string_view::npos ? start.first_line : start.first_line.substr(slash + 1);
  return parse_utm_name(name).has_value();
}

}  // namespace vpr
