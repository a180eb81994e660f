#include "truth/poses.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include <fmt/format.h>

#include "base/error.h"
#include "base/text.h"
#include "truth/association.h"
#include "truth/builder.h"
#include "truth/route.h"
#include "truth/text_file.h"
#include "truth/trajectory.h"

namespace vpr {

namespace {

Poses read_csv_poses(const std::filesystem::path& path, const FrameCount& frames) {
  PoseCsvRules rules{frames.frames, kMaxGrownFrames};
  if (frames.grows) rules.frames.reset();
  Poses poses;
  for (const auto& found : read_pose_csv(path, rules)) {
    if (found && found->is_on_earth)
      throw Error(ErrorKind::data,
                  fmt::format("{}: has latitudes and longitudes, but the other side has poses "
                              "in meters; use the format gps for both sides",
                              path.string()));
    poses.push_back(found ? std::optional(found->pose) : std::nullopt);
  }
  return poses;
}

/// The readers of a trajectory format: without times, and with checked times.
struct TrajectoryReaders {
  Trajectory (*without_times)(const std::filesystem::path& path);
  Trajectory (*with_times)(const std::filesystem::path& path);
};

const std::filesystem::path& training_path(const GroundTruthArgument& argument) {
  if (argument.options.reference.empty())
    throw Error(ErrorKind::usage,
                fmt::format("{}: has the poses of the query; pass those of the training sequence, "
                            "as in --ground-truth-reference POSES",
                            argument.path.string()));
  return argument.options.reference;
}

/// `read(side, path)` returns the poses of one side.
template <class Read>
std::string read_both(GroundTruthBuilder& builder, std::string_view format, Read&& read) {
  const GroundTruthArgument& argument = builder.argument();
  const size_t sequence = builder.only_searched(argument.path.string());
  const std::filesystem::path& reference = training_path(argument);
  builder.at_file(argument.path);  // for errors about the whole file
  const Poses query = read(PoseSide::query, argument.path);
  const GroundTruthOptions& options = argument.options;
  if (!options.query_times.empty()) builder.at_file(options.query_times);
  builder.require_query_frames(query.size());
  builder.at_file(reference);
  const Poses train = read(PoseSide::train, reference);
  if (!options.reference_times.empty()) builder.at_file(options.reference_times);
  builder.require_train_frames(sequence, train.size());
  return fmt::format("{} poses{}: {}", format, times_in_words(argument.options),
                     match_poses(builder, sequence, query, train));
}

std::string read_trajectories(GroundTruthBuilder& builder, std::string_view format,
                              const TrajectoryReaders& readers) {
  return read_both(builder, format, [&](PoseSide side, const std::filesystem::path& path) {
    const GroundTruthOptions& options = builder.argument().options;
    const bool has_times =
        !(side == PoseSide::query ? options.query_times : options.reference_times).empty();
    return poses_of_side(options, side,
                         (has_times ? readers.with_times : readers.without_times)(path),
                         builder.monitor());
  });
}

bool has_numbers(std::string_view line, size_t count) {
  const auto words = split_words(line);
  return words.size() == count && std::all_of(words.begin(), words.end(), [](std::string_view w) {
           return parse_real(w).has_value();
         });
}

/// With a larger share of pairs of the same place, almost every match is correct.
constexpr double kLargeShare = 0.1;
/// Limit of pairs of the same place, each of which is compared.
constexpr uint64_t kMaxPairs = uint64_t{1} << 27;

/// The limits of the same place.
struct Nearness {
  double radius_m = 0;
  std::optional<double> angle_deg;
};

bool is_near(const Pose& a, const Pose& b, const Nearness& nearness,
             const GroundTruthBuilder& builder) {
  double square = 0;
  for (size_t k = 0; k < 3; ++k) {
    const double difference = b.position[k] - a.position[k];
    square += difference * difference;
  }
  if (!(square <= nearness.radius_m * nearness.radius_m)) return false;
  if (!nearness.angle_deg) return true;
  const auto angle = angle_between(a, b);
  if (!angle) builder.fail("an angle is set, but a pose has no heading");
  return *angle <= *nearness.angle_deg;
}

/// Neighboring frames first .. last.
struct FrameSpan {
  size_t first = 0;
  size_t last = 0;
};

/// Frames with a pose, sorted by the coordinate with the largest extent.
struct SortedPoses {
  size_t axis = 0;
  std::vector<size_t> known;
  std::vector<FrameSpan> unknown;
  size_t unknown_frames = 0;
};

size_t longest_axis(const Poses& poses) {
  const std::array<double, 3> extents = extents_of(poses);
  return static_cast<size_t>(std::max_element(extents.begin(), extents.end()) - extents.begin());
}

SortedPoses sort_poses(const Poses& poses) {
  SortedPoses sorted;
  sorted.axis = longest_axis(poses);
  for (size_t i = 0; i < poses.size(); ++i) {
    auto& unknown = sorted.unknown;
    if (poses[i])
      sorted.known.push_back(i);
    else if (++sorted.unknown_frames; !unknown.empty() && unknown.back().last + 1 == i)
      unknown.back().last = i;
    else
      unknown.push_back({i, i});
  }
  std::stable_sort(sorted.known.begin(), sorted.known.end(), [&](size_t a, size_t b) {
    return poses[a]->position[sorted.axis] < poses[b]->position[sorted.axis];
  });
  return sorted;
}

// Whether the radius covers the whole extent, so that every pair is near; known before the
// comparison.
bool is_everything_near(const Poses& query, const Poses& train, const Nearness& nearness) {
  Poses all = query;
  all.insert(all.end(), train.begin(), train.end());
  const auto [x, y, z] = extents_of(all);
  return !nearness.angle_deg && std::hypot(x, y, z) <= nearness.radius_m;
}

[[noreturn]] void refuse_pairs(const GroundTruthBuilder& builder, const Nearness& nearness) {
  builder.fail(
      fmt::format("more than {} pairs of frames lie within {} m. Use a smaller --radius, "
                  "or fewer frames (vpr-query --fps)",
                  kMaxPairs, nearness.radius_m));
}

std::vector<size_t> near_frames(const Pose& query, const Poses& train, const SortedPoses& sorted,
                                const Nearness& nearness, const GroundTruthBuilder& builder) {
  const auto offset = [&](size_t frame) {
    return train[frame]->position[sorted.axis] - query.position[sorted.axis];
  };
  const auto first =
      std::partition_point(sorted.known.begin(), sorted.known.end(),
                           [&](size_t frame) { return offset(frame) < -nearness.radius_m; });
  const auto end = std::partition_point(
      first, sorted.known.end(), [&](size_t frame) { return offset(frame) <= nearness.radius_m; });
  std::vector<size_t> frames;
  for (auto frame = first; frame != end; ++frame)
    if (is_near(query, *train[*frame], nearness, builder)) frames.push_back(*frame);
  std::sort(frames.begin(), frames.end());
  return frames;
}

Nearness find_nearness(const GroundTruthBuilder& builder, std::optional<double> usual_radius_m) {
  const GroundTruthOptions& options = builder.argument().options;
  if (!options.radius_m && !usual_radius_m)
    throw Error(
        ErrorKind::usage,
        fmt::format("{}: poses need the radius in meters within which frames show the same "
                    "place, such as --radius 2 (in a corridor 1 to 3, on a road often 25), or "
                    "\"radius_m\" in a data set",
                    builder.argument().path.string()));
  const Nearness nearness{options.radius_m ? *options.radius_m : *usual_radius_m,
                          options.angle_deg};
  const auto is_length = [](double value) { return value >= 0 && std::isfinite(value); };
  if (!is_length(nearness.radius_m) || !is_length(nearness.angle_deg.value_or(0)))
    throw Error(ErrorKind::usage, "radius and angle of a ground truth must be numbers, 0 or more");
  return nearness;
}

void warn_of_large_share(const GroundTruthBuilder& builder, const Nearness& nearness, uint64_t same,
                         uint64_t pairs) {
  if (static_cast<double>(same) <= kLargeShare * static_cast<double>(pairs)) return;
  builder.warn_user(
      fmt::format("{}: within {} m lie {:.0f} % of all pairs of frames, so almost every match is "
                  "correct; use a "
                  "smaller --radius",
                  builder.argument().path.string(), nearness.radius_m,
                  100 * static_cast<double>(same) / static_cast<double>(pairs)));
}

std::string describe(const Nearness& nearness, int tolerance_frames, size_t unknown_query,
                     size_t unknown_train) {
  std::string text = fmt::format("within {} m", nearness.radius_m);
  if (nearness.angle_deg) text += fmt::format(" and {} degrees", *nearness.angle_deg);
  if (tolerance_frames != 0)
    text += fmt::format(", and {} more", counted(static_cast<uint64_t>(tolerance_frames), "frame"));
  if (unknown_query + unknown_train > 0)
    text += fmt::format("; {} query and {} training frames without a pose are ignored",
                        unknown_query, unknown_train);
  return text;
}

}  // namespace

std::string read_poses(GroundTruthBuilder& builder) {
  return read_both(builder, "csv", [&](PoseSide side, const std::filesystem::path& path) {
    return read_csv_poses(path, side == PoseSide::query
                                    ? builder.query()
                                    : builder.train(builder.only_searched(path.string())));
  });
}

std::string read_tum_poses(GroundTruthBuilder& builder) {
  return read_trajectories(builder, "tum", {read_tum_without_times, read_tum});
}

std::string read_kitti_poses(GroundTruthBuilder& builder) {
  return read_trajectories(builder, "kitti", {read_kitti, read_kitti});
}

std::string read_euroc_poses(GroundTruthBuilder& builder) {
  return read_trajectories(builder, "euroc", {read_euroc, read_euroc});
}

bool is_pose_csv(const FileStart& start) {
  const std::vector<std::string> names = header_names(start.first_line);
  return std::ranges::all_of(std::array{"frame", "x", "y"}, [&](const char* column) {
    return std::ranges::find(names, column) != names.end();
  });
}

bool is_tum(const FileStart& start) { return has_numbers(start.first_line, 8); }

bool is_kitti(const FileStart& start) { return has_numbers(start.first_line, 12); }

std::array<double, 3> extents_of(const Poses& poses) {
  std::array<double, 3> extents{};
  for (size_t axis = 0; axis < 3; ++axis) {
    double least = std::numeric_limits<double>::infinity();
    double greatest = -least;
    for (const auto& pose : poses) {
      if (!pose) continue;
      least = std::min(least, pose->position[axis]);
      greatest = std::max(greatest, pose->position[axis]);
    }
    extents[axis] = greatest - least;
  }
  return extents;
}

std::optional<double> angle_between(const Pose& a, const Pose& b) {
  if (a.heading_deg && b.heading_deg)
    return std::abs(std::remainder(*a.heading_deg - *b.heading_deg, 360.0));
  if (!a.orientation || !b.orientation) return std::nullopt;
  const double trace =
      std::inner_product(a.orientation->begin(), a.orientation->end(), b.orientation->begin(), 0.0);
  return std::acos(std::clamp((trace - 1) / 2, -1.0, 1.0)) * 180 / std::numbers::pi;
}

std::string match_poses(GroundTruthBuilder& builder, size_t sequence, const Poses& query,
                        const Poses& train, std::optional<double> usual_radius_m,
                        const std::vector<bool>& nowhere) {
  const Nearness nearness = find_nearness(builder, usual_radius_m);
  const SortedPoses sorted = sort_poses(train);
  if (uint64_t{query.size()} * sorted.known.size() > kMaxPairs &&
      is_everything_near(query, train, nearness))
    refuse_pairs(builder, nearness);
  uint64_t known = 0;
  uint64_t same = 0;
  uint64_t unknown = 0;
  for (size_t frame = 0; frame < query.size(); ++frame) {
    builder.check_stop();
    if (frame < nowhere.size() && nowhere[frame]) continue;
    if (!query[frame]) {
      ++unknown;
      if (!train.empty()) builder.add(frame, sequence, 0, train.size() - 1, PlaceLabel::ignore);
      continue;
    }
    ++known;
    for (const size_t reference : near_frames(*query[frame], train, sorted, nearness, builder)) {
      builder.add(frame, sequence, reference, reference, PlaceLabel::same);
      ++same;
    }
    if (same > kMaxPairs) refuse_pairs(builder, nearness);
    for (const FrameSpan& span : sorted.unknown)
      builder.add(frame, sequence, span.first, span.last, PlaceLabel::ignore);
  }
  warn_of_large_share(builder, nearness, same, known * sorted.known.size());
  return describe(nearness, builder.argument().tolerance_frames, unknown, sorted.unknown_frames);
}

}  // namespace vpr
