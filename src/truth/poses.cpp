#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "base/error.h"
#include "base/text.h"
#include "recordings/frame_order.h"
#include "recordings/sequence_source.h"
#include "truth/formats.h"
#include "truth/layouts.h"
#include "truth/positions.h"
#include "truth/readers.h"

namespace vpr {

namespace {

// In meters; the radius of the deep visual geo-localization benchmark, which uses UTM names.
constexpr double kUtmRadius = 25;
constexpr double kMaxZones = 60;

// Indices of the fields between the @ signs; field 0 is before the first one.
enum Field : size_t { kEast = 1, kNorth = 2, kZone = 3, kBand = 4, kHeading = 9 };

// Without the extension.
std::vector<std::string_view> utm_fields(std::string_view file_name) {
  const auto dot = file_name.rfind('.');
  const auto last_at = file_name.rfind('@');
  // "@1.5@2.5.jpg": the last dot starts the extension, but "@1.5@2.5@" has no extension.
  const bool has_extension =
      dot != std::string_view::npos && last_at != std::string_view::npos && dot > last_at;
  return split(has_extension ? file_name.substr(0, dot) : file_name, '@');
}

// "33", "33.0", or "33U" with the latitude band. Nullopt for other text.
std::optional<double> parse_zone(std::string_view field) {
  if (!field.empty() && field.back() >= 'A' && field.back() <= 'Z') field.remove_suffix(1);
  const auto number = parse_real(field);
  const bool is_zone =
      number && *number >= 1 && *number <= kMaxZones && *number == std::floor(*number);
  return is_zone ? number : std::nullopt;
}

// By the latitude band, C to M in the south; nullopt if it is missing.
std::optional<bool> is_southern(const std::vector<std::string_view>& fields) {
  const std::string_view zone = fields[kZone];
  const std::string_view band = !parse_real(zone)       ? zone.substr(zone.size() - 1)
                                : fields.size() > kBand ? fields[kBand]
                                                        : "";
  if (band.size() != 1 || band < "C" || band > "X") return std::nullopt;
  return band <= "M";
}

// `read(side, frames)` returns the poses of one side. Returns the protocol of match_poses.
template <class Read>
std::string match_sides(GroundTruthBuilder& builder, Read&& read,
                        std::optional<double> default_radius_m = std::nullopt) {
  const GroundTruthArgument& argument = builder.argument();
  const size_t sequence = builder.only_searched(argument.path.string());
  const auto read_side = [&](PoseSide side, const FrameCount& frames) {
    const SideOptions options = side_options(argument, side);
    builder.at_file(options.poses);  // for errors about the whole file
    Poses poses = read(side, frames);
    if (options.files.times.empty() && !poses.empty() && count_unknown(poses) == poses.size())
      throw Error(ErrorKind::data, "{}: no frame has a known pose", options.poses.string());
    if (!options.files.times.empty()) builder.at_file(options.files.times);
    return poses;
  };
  const Poses query = read_side(PoseSide::query, builder.query());
  builder.require_query_frames(query.size());
  if (argument.options.reference.empty())
    throw Error(ErrorKind::usage,
                "{}: has the positions of the query. Pass those of the training sequence with "
                "--ground-truth-train",
                argument.path.string());
  const Poses train = read_side(PoseSide::train, builder.train(sequence));
  builder.require_train_frames(sequence, train.size());
  return match_poses(builder, sequence, query, train, default_radius_m);
}

// The format of a side: the set one, or the detected one. Throws Error(data) if it has another
// reader than the query's format: trajectories of two layouts can be compared.
std::string_view format_of(const GroundTruthBuilder& builder, const std::filesystem::path& path) {
  const GroundTruthArgument& argument = builder.argument();
  if (!argument.format.empty()) return builder.format();
  const GroundTruthFormat& format = detect_format(path);
  if (format.read != find_format(builder.format()).read)
    throw Error(ErrorKind::data, "{}: has the format {}, and {} has {}. Use one format for both",
                path.string(), format.name, argument.path.string(), builder.format());
  return format.name;
}

// The names of the frames of a side; null: unknown.
NameReader names_of(const GroundTruthBuilder& builder, PoseSide side) {
  const GroundTruthScope& scope = builder.scope();
  if (side == PoseSide::query) return scope.query_names;
  return scope.sequences[builder.only_searched(builder.argument().path.string())].names;
}

// Both sides have the column, or none. `known`: whether the first side has it; unset before.
void require_equal(const std::filesystem::path& path, std::string_view column,
                   std::optional<bool>& known, bool has_column) {
  if (known.value_or(has_column) != has_column)
    throw Error(ErrorKind::data,
                "{}: has {} column {}, and the other side has {}. Give both sides the column, or "
                "none",
                path.string(), has_column ? "a" : "no", column, has_column ? "none" : "one");
  known = has_column;
}

// Refuses poses with times that are not one per frame and that no times of frames associate.
void require_one_per_frame(const Trajectory& found, const SideOptions& side,
                           const FrameCount& frames) {
  if (!side.files.times.empty() || !(found.has_times || !found.times_ns.empty()) ||
      !found.names.empty() || frames.known().value_or(found.poses.size()) == found.poses.size())
    return;
  throw Error(ErrorKind::data,
              "{}: has {}, but there are {} {} frames. Its poses have times: pass those of the "
              "frames with --{}-times",
              found.name, counted(found.poses.size(), "pose"), *frames.known(), side.name,
              side.name);
}

/// With a larger share of pairs of the same place, many matches are correct by chance.
constexpr double kLargeShare = 0.25;
/// Limit of pairs of the same place, each of which is compared.
constexpr uint64_t kMaxPairs = uint64_t{1} << 27;

/// Frames with a pose, sorted by the coordinate with the largest extent, and runs of frames without
/// a pose.
struct SortedPoses {
  size_t axis = 0;
  std::vector<size_t> known;
  std::vector<LabelStretch> unknown;
};

SortedPoses sort_poses(const Poses& poses) {
  const std::array<double, 3> extents = extents_of(poses);
  SortedPoses sorted;
  sorted.axis = static_cast<size_t>(std::ranges::max_element(extents) - extents.begin());
  for (size_t i = 0; i < poses.size(); ++i) {
    auto& unknown = sorted.unknown;
    if (poses[i])
      sorted.known.push_back(i);
    else if (!unknown.empty() && unknown.back().last + 1 == i)
      unknown.back().last = i;
    else
      unknown.push_back({i, i, PlaceLabel::ignore});
  }
  std::ranges::stable_sort(sorted.known, {},
                           [&](size_t i) { return poses[i]->position[sorted.axis]; });
  return sorted;
}

// Whether the radius covers the whole extent, so that every pair is near; known before the
// comparison.
bool is_everything_near(const Poses& query, const Poses& train, const Nearness& nearness) {
  Poses all = query;
  all.insert(all.end(), train.begin(), train.end());
  const auto [x, y, z] = extents_of(all);
  return !nearness.angle_deg && std::hypot(x, y, z) <= nearness.farthest_m();
}

// Floors and UTM zones.
std::set<std::string> areas_of(const Poses& poses) {
  std::set<std::string> areas;
  for (const auto& pose : poses)
    if (pose && !pose->area.empty()) areas.insert(pose->area);
  return areas;
}

[[noreturn]] void refuse_pairs(const GroundTruthBuilder& builder, const Nearness& nearness) {
  builder.fail(
      "more than {} pairs of frames lie within {} m. Use a smaller --radius, "
      "or fewer frames (vpr-query --fps)",
      kMaxPairs, nearness.radius_m);
}

std::vector<LabelStretch> near_frames(const Poses& queries, size_t query_frame, const Poses& train,
                                      const SortedPoses& sorted, const Nearness& nearness,
                                      const GroundTruthBuilder& builder) {
  const Pose& query = *queries[query_frame];
  const auto offset = [&](size_t frame) {
    return train[frame]->position[sorted.axis] - query.position[sorted.axis];
  };
  const double reach = nearness.farthest_m();
  const auto first = std::partition_point(sorted.known.begin(), sorted.known.end(),
                                          [&](size_t frame) { return offset(frame) < -reach; });
  const auto end = std::partition_point(first, sorted.known.end(),
                                        [&](size_t frame) { return offset(frame) <= reach; });
  std::vector<LabelStretch> frames;
  for (auto frame = first; frame != end; ++frame) {
    const auto label = label_of(query, *train[*frame], nearness);
    if (!label && has_heading(query))
      refuse_angle(builder.argument().options.reference.string(), *frame);
    if (!label) refuse_angle(builder.argument().path.string(), query_frame);
    if (*label != PlaceLabel::different) frames.push_back({*frame, *frame, *label});
  }
  std::ranges::sort(frames, {}, &LabelStretch::first);
  return frames;
}

Nearness find_nearness(const GroundTruthBuilder& builder, std::optional<double> default_radius_m) {
  const GroundTruthOptions& options = builder.argument().options;
  if (!options.radius_m && !default_radius_m)
    throw Error(
        ErrorKind::usage,
        "{}: poses need the radius in meters within which frames show the same place, such as "
        "--radius 2 (in a corridor 1 to 3, on a road often 25), or \"radius_m\" in a data set",
        builder.argument().path.string());
  const Nearness nearness{options.radius_m ? *options.radius_m : *default_radius_m,
                          options.angle_deg, options.ignore_radius_m};
  check_nearness(nearness);
  return nearness;
}

}  // namespace

std::string read_poses(GroundTruthBuilder& builder) {
  std::optional<bool> have_heights;
  std::optional<bool> have_floors;
  const std::string matched = match_sides(builder, [&](PoseSide side, const FrameCount& count) {
    const std::filesystem::path& path = side_options(builder.argument(), side).poses;
    format_of(builder, path);
    Trajectory found = read_pose_csv(path, count.known());
    if (found.is_on_earth)
      throw Error(ErrorKind::data,
                  "{}: has latitudes and longitudes, but the other side has poses in meters. Use "
                  "the format gps for both sides",
                  path.string());
    require_equal(path, "z", have_heights, found.has_heights);
    require_equal(path, "floor", have_floors, found.has_floors);
    return std::move(found.poses);
  });
  return "csv poses: " + matched;
}

std::string read_trajectories(GroundTruthBuilder& builder) {
  const GroundTruthArgument& argument = builder.argument();
  std::string formats;
  std::optional<bool> have_heights;
  const std::string matched = match_sides(builder, [&](PoseSide side, const FrameCount& count) {
    const SideOptions options = side_options(argument, side);
    const std::string_view format = format_of(builder, options.poses);
    if (formats != format) formats += fmt::format("{}{}", formats.empty() ? "" : " and ", format);
    Trajectory found =
        read_layout(options.poses, *find_layout(format), !options.files.times.empty());
    require_equal(options.poses, "z", have_heights, found.has_heights);
    if (options.files.times.empty())
      choose_names(found, names_of_side(options.files, names_of(builder, side)), builder.monitor());
    if (found.names.empty()) warn_of_steps(found, builder.monitor());
    // Frames without a line at the end of a file that numbers them.
    if (found.lines.empty() && count.known() && found.poses.size() < *count.known())
      found.poses.resize(*count.known());
    require_one_per_frame(found, options, count);
    return poses_of_side(argument, side, std::move(found), names_of(builder, side),
                         builder.monitor());
  });
  return fmt::format("{} poses{}: {}", formats, describe_times(argument), matched);
}

std::string read_gps(GroundTruthBuilder& builder) {
  const GroundTruthArgument& argument = builder.argument();
  std::optional<bool> have_floors;
  const std::string matched = match_sides(builder, [&](PoseSide side, const FrameCount& count) {
    const SideOptions options = side_options(argument, side);
    Trajectory found = read_fixes(options.poses, count.known(), !options.files.times.empty());
    if (options.files.times.empty())
      choose_names(found, names_of_side(options.files, names_of(builder, side)), builder.monitor());
    require_equal(options.poses, "floor", have_floors, found.has_floors);
    require_one_per_frame(found, options, count);
    Poses poses =
        poses_of_side(argument, side, std::move(found), names_of(builder, side), builder.monitor());
    const size_t missing = count_unknown(poses);
    if (!options.files.times.empty()) return poses;  // poses_of_side has checked them
    if (missing == poses.size())
      throw Error(ErrorKind::data, "{}: has no fix for any frame", options.poses.string());
    if (missing * 2 > poses.size())
      warn(builder.monitor(), "{}: {} of {} have no fix and are ignored", options.poses.string(),
           missing, counted(poses.size(), "frame"));
    return poses;
  });
  return fmt::format("gps positions{}: {}", describe_times(argument, true), matched);
}

std::optional<Pose> parse_utm_name(std::string_view file_name) {
  const auto fields = utm_fields(file_name);
  if (fields.size() <= kNorth) return std::nullopt;
  const auto east = parse_real(fields[kEast]);
  const auto north = parse_real(fields[kNorth]);
  if (!east || !north) return std::nullopt;
  Pose pose;
  pose.position = {*east, *north, 0};
  if (const auto zone = fields.size() > kZone ? parse_zone(fields[kZone]) : std::nullopt)
    pose.area = fmt::format("{:g}", *zone);
  if (fields.size() > kHeading) pose.heading_deg = parse_real(fields[kHeading]);
  return pose;
}

namespace {

/// The name of an image with its position.
struct UtmName {
  std::string text;
  std::optional<Pose> pose = {};  // unset: "nan"
  std::optional<double> zone = {};
  std::optional<bool> is_southern = {};
};

bool is_unknown_position(const std::vector<std::string_view>& fields) {
  return fields.size() > kNorth && !fields[kEast].empty() && is_missing(fields[kEast]) &&
         is_missing(fields[kNorth]);
}

std::vector<UtmName> parse_names(const GroundTruthBuilder& builder,
                                 const SequenceSource& sequence) {
  std::vector<UtmName> names;
  bool is_unzoned = false;
  for (const std::string& text : file_names(sequence)) {
    const auto fields = utm_fields(text);
    UtmName name{text, parse_utm_name(text)};
    if (!name.pose && !is_unknown_position(fields))
      builder.fail(
          "{} is not named @east@north@...; scripts/convert/exif.py lists the GPS positions of "
          "JPEG images",
          text);
    if (name.pose && !name.pose->area.empty()) {
      name.zone = parse_zone(fields[kZone]);
      name.is_southern = is_southern(fields);
    } else if (name.pose && fields.size() > kZone && !is_missing(fields[kZone]) &&
               !std::exchange(is_unzoned, true)) {
      warn(builder.monitor(),
           "{}: \"{}\" in {} is not a UTM zone, 1 to 60, so its zone is unknown and fits any other",
           sequence.argument.path.string(), fields[kZone], text);
    }
    names.push_back(std::move(name));
  }
  return names;
}

void require_sorted(const SequenceSource& sequence) {
  const auto unsorted = std::ranges::is_sorted_until(sequence.files);
  std::error_code error;
  if (unsorted == sequence.files.end() || current_frame_order() != FrameOrder::automatic ||
      !std::filesystem::is_directory(sequence.argument.path, error))
    return;
  throw Error(
      ErrorKind::usage,
      "{}: the order of names without padding is unclear. For frames of vpr-train and vpr-query, "
      "pass --order natural ({} before {}); for arrays of programs that sort names as text, "
      "--order "
      "name",
      sequence.argument.path.string(), (unsorted - 1)->filename().string(),
      unsorted->filename().string());
}

// Positions in several zones, all of them known with their hemispheres, become places on the earth.
// Otherwise, throws Error(data) for zones that touch.
void join_zones(const GroundTruthBuilder& builder, std::span<UtmName* const> names) {
  std::map<std::pair<double, bool>, const UtmName*> zones;
  bool are_known = true;
  for (const UtmName* name : names) {
    are_known = are_known && name->zone && name->is_southern;
    if (name->zone) zones.emplace(std::pair(*name->zone, name->is_southern.value_or(false)), name);
  }
  if (zones.size() < 2) return;
  for (UtmName* name : names) {
    if (!are_known) break;
    name->pose->position =
        earth_position(place_of_utm(name->pose->position[0], name->pose->position[1],
                                    static_cast<int>(*name->zone), *name->is_southern));
    name->pose->area.clear();
  }
  if (are_known) return;
  for (const auto& [own, name] : zones)
    for (const double next : {own.first, own.first == kMaxZones ? 1 : own.first + 1})
      for (const bool is_south : {false, true})
        if (const auto touching = zones.find({next, is_south});
            touching != zones.end() && touching->first != own)
          builder.fail(
              "{} lies in UTM zone {}, and {} in zone {}, which touches it. Distances between them "
              "need the zone and band of every image, as in @33@U@; or use latitudes and "
              "longitudes "
              "(gps)",
              name->text, own.first, touching->second->text, next);
}

}  // namespace

std::string read_utm_names(GroundTruthBuilder& builder) {
  const GroundTruthArgument& argument = builder.argument();
  std::map<PoseSide, std::vector<UtmName>> sides;
  std::vector<UtmName*> located;
  for (const PoseSide side : {PoseSide::query, PoseSide::train}) {
    const std::filesystem::path& path = side_options(argument, side).poses;
    if (path.empty()) continue;  // refused below
    builder.at_file(path);
    const SequenceSource sequence = open_sequence(parse_sequence_argument(path.string()));
    if (sequence.kind != SequenceKind::images)
      builder.fail("is not a folder or list of images named @east@north@...");
    sides[side] = parse_names(builder, sequence);
    require_sorted(sequence);
    for (UtmName& name : sides[side])
      if (name.pose) located.push_back(&name);
  }
  builder.at_file(argument.path);
  join_zones(builder, located);
  const auto read = [&](PoseSide side, const FrameCount&) {
    Poses poses;
    for (const UtmName& name : sides[side]) poses.push_back(name.pose);
    return poses;
  };
  return fmt::format("UTM coordinates in file names: {}{}", match_sides(builder, read, kUtmRadius),
                     argument.options.radius_m ? "" : ", the radius of the benchmark");
}

bool is_utm_names(const FileStart& start) {
  if (start.is_folder) return true;
  const size_t slash = start.first_line.rfind('/');  // npos + 1 is 0
  const std::string name = start.first_line.substr(slash + 1);
  return parse_utm_name(name) || is_unknown_position(utm_fields(name));
}

namespace {

/// Counts of match_poses.
struct PoseCounts {
  uint64_t known = 0;    ///< query frames with a pose
  uint64_t unknown = 0;  ///< query frames without one
  uint64_t same = 0;     ///< pairs of the same place
  uint64_t pairs = 0;    ///< of known poses
};

PoseCounts label_pairs(GroundTruthBuilder& builder, size_t sequence, const Poses& query,
                       const Poses& train, const Nearness& nearness,
                       const std::vector<bool>& unplaced) {
  const SortedPoses sorted = sort_poses(train);
  if (uint64_t{query.size()} * sorted.known.size() > kMaxPairs &&
      is_everything_near(query, train, nearness))
    refuse_pairs(builder, nearness);
  PoseCounts counts;
  for (size_t frame = 0; frame < query.size(); ++frame) {
    builder.check_stop();
    if (frame < unplaced.size() && unplaced[frame]) continue;
    if (!query[frame]) {
      ++counts.unknown;
      if (!train.empty()) builder.add(frame, sequence, 0, train.size() - 1, PlaceLabel::ignore);
      continue;
    }
    ++counts.known;
    for (const LabelStretch& near : near_frames(query, frame, train, sorted, nearness, builder)) {
      builder.add(frame, sequence, near.first, near.last, near.label);
      counts.same += near.label == PlaceLabel::same;
    }
    if (counts.same > kMaxPairs) refuse_pairs(builder, nearness);
    for (const LabelStretch& run : sorted.unknown)
      builder.add(frame, sequence, run.first, run.last, run.label);
  }
  counts.pairs = counts.known * sorted.known.size();
  return counts;
}

void warn_of(const GroundTruthBuilder& builder, const PoseCounts& counts, const Poses& query,
             const Poses& train, const Nearness& nearness) {
  const std::string path = builder.argument().path.string();
  if (nearness.angle_deg) {
    warn_of_headings(path, query, builder.monitor());
    warn_of_headings(builder.argument().options.reference.string(), train, builder.monitor());
  }
  const auto areas = areas_of(query);
  const auto trained = areas_of(train);
  if (!areas.empty() && !trained.empty() &&
      std::ranges::none_of(areas, [&](const auto& area) { return trained.contains(area); }))
    warn(builder.monitor(),
         "{}: no floor or UTM zone of the query ({}, ...) is one of the training sequence ({}, "
         "...), so frames that have one are different places",
         path, *areas.begin(), *trained.begin());
  const double share = static_cast<double>(counts.same) / static_cast<double>(counts.pairs);
  if (counts.pairs > 0 && share > kLargeShare)
    warn(builder.monitor(),
         "{}: within {} m lie {:.0f} % of all pairs of frames, so as many random matches would be "
         "correct. Use a smaller --radius",
         path, nearness.radius_m, 100 * share);
}

std::string protocol_of(const GroundTruthArgument& argument, const Nearness& nearness,
                        size_t unknown_query, size_t unknown_train) {
  std::string protocol = fmt::format("within {} m", nearness.radius_m);
  if (nearness.angle_deg) protocol += fmt::format(" and {} degrees", *nearness.angle_deg);
  if (nearness.ignore_radius_m)
    protocol += fmt::format(", ignored up to {} m", *nearness.ignore_radius_m);
  if (const auto tolerance = static_cast<uint64_t>(argument.tolerance_frames))
    protocol += fmt::format(", and {} more", counted(tolerance, "frame"));
  if (unknown_query + unknown_train > 0)
    protocol += fmt::format("; {} query and {} training frames without a pose are ignored",
                            unknown_query, unknown_train);
  return protocol;
}

}  // namespace

std::string match_poses(GroundTruthBuilder& builder, size_t sequence, const Poses& query,
                        const Poses& train, std::optional<double> default_radius_m,
                        const std::vector<bool>& unplaced) {
  const Nearness nearness = find_nearness(builder, default_radius_m);
  const PoseCounts counts = label_pairs(builder, sequence, query, train, nearness, unplaced);
  warn_of(builder, counts, query, train, nearness);
  return protocol_of(builder.argument(), nearness, counts.unknown, count_unknown(train));
}

}  // namespace vpr
