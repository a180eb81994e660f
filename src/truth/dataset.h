// Data set descriptions (vpr.dataset/1): which sequences belong together, and their ground truth.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/enum_names.h"
#include "sequence/sequence_argument.h"

namespace vpr {

/// A sequence of a data set, and what results call it.
struct NamedSequence {
  std::string name;
  SequenceArgument sequence;
  std::filesystem::path poses = {};  ///< CSV frame,x,y[,heading]; empty: not known
};

/// Which index of a ground truth matrix counts query frames: its rows or its columns. `automatic`:
/// what its shape and its kind say.
enum class MatrixRows { automatic, query, reference };
template <>
inline constexpr std::array<std::string_view, 3> kEnumNames<MatrixRows> = {"auto", "query",
                                                                           "reference"};

/// What some formats of ground truth need beside a path and a tolerance.
struct GroundTruthOptions {
  std::filesystem::path reference = {};  ///< poses and file names: the training side
  std::filesystem::path soft = {};       ///< matrices: pairs to ignore where the matrix has 0
  /// Poses and file names: the same place within so many metres, bounds included. Poses need it;
  /// nothing with file names: the benchmark's 25.
  std::optional<double> radius_m = {};
  std::optional<double> angle_deg = {};  ///< and with headings that differ by at most so much
  /// Aligned: query frame i is training frame `reference_step` i, rounded. Nothing: 1.
  std::optional<double> reference_step = {};
  MatrixRows matrix_rows = MatrixRows::automatic;
  /// Trajectories: the times of query and training frames, a list, a folder of images that are
  /// named by their times, or a video; empty: pose i is that of frame i.
  std::filesystem::path query_times = {};
  std::filesystem::path reference_times = {};
  std::filesystem::path query_pose_times = {};  ///< of trajectories whose files have no times
  std::filesystem::path reference_pose_times = {};
  std::filesystem::path query_images = {};  ///< GPS: folders or lists that names in a CSV are of
  std::filesystem::path reference_images = {};
  /// Seconds from a frame to its nearest pose at most. Nothing: 0.02, of GPS 1.
  std::optional<double> max_difference_s = {};
  std::optional<double> offset_s = {};            ///< is added to the query's times
  std::optional<double> reference_offset_s = {};  ///< is added to those of the training frames

  bool operator==(const GroundTruthOptions&) const = default;
};

/// The options that are files, by their names in data set descriptions.
template <class Visitor>
void visit_paths(GroundTruthOptions& options, Visitor&& visit) {
  visit("reference", options.reference);
  visit("soft", options.soft);
  visit("query_times", options.query_times);
  visit("reference_times", options.reference_times);
  visit("query_pose_times", options.query_pose_times);
  visit("reference_pose_times", options.reference_pose_times);
  visit("query_images", options.query_images);
  visit("reference_images", options.reference_images);
}

/// The names under which the others stand there.
template <class Visitor>
void visit_fields(GroundTruthOptions& options, Visitor&& visit) {
  visit("radius_m", options.radius_m);
  visit("angle_deg", options.angle_deg);
  visit("reference_step", options.reference_step);
  visit("matrix_rows", options.matrix_rows);
  visit("max_difference_s", options.max_difference_s);
  visit("offset_s", options.offset_s);
  visit("reference_offset_s", options.reference_offset_s);
}

/// Where a ground truth stands and how it is read.
struct GroundTruthArgument {
  std::string format;  ///< a word ("aligned"), or the name of a format; empty: found by content
  std::filesystem::path path = {};
  int tolerance_frames = 0;
  GroundTruthOptions options = {};
};

/// A query of a data set and its ground truths.
struct DatasetQuery {
  NamedSequence sequence;
  std::optional<GroundTruthArgument> sequence_ground_truth;  ///< query frame against train frames
  std::optional<GroundTruthArgument> place_ground_truth;     ///< query frame against places
};

/// A place of FAB-MAP: its views.
struct DatasetPlace {
  std::string name;
  std::vector<SequenceArgument> views;
};

/// A data set description.
struct Dataset {
  std::string name;
  double frames_per_second = 0;  ///< 0: not stated
  std::vector<SequenceArgument> pretrain;
  std::vector<NamedSequence> train;
  std::vector<DatasetPlace> places;
  std::vector<DatasetQuery> queries;
  std::filesystem::path plan;         ///< CSV x0,y0,x1,y1[,floor] of the walls; empty: none
  std::filesystem::path place_poses;  ///< CSV place,x,y[,heading,floor]; empty: not known
};

/// Paths in the file are relative to it. Throws Error(input) if it can't be read, Error(usage) if
/// it is not such a description; unknown keys are errors that name the nearest.
Dataset read_dataset(const std::filesystem::path& path);

/// The query called `name`, or the only one. Throws Error(usage) naming the queries there are.
const DatasetQuery& select_query(const Dataset& dataset, const std::optional<std::string>& name);

}  // namespace vpr
