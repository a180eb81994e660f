// Data set descriptions (vpr.dataset/3): their sequences, places and ground truth.
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/enum_names.h"
#include "base/json_fwd.h"
#include "recordings/sequence_source.h"

namespace vpr {

/// A sequence of a data set and its name in results.
struct NamedSequence {
  std::string name;
  SequenceArgument sequence;
  std::filesystem::path poses = {};  ///< CSV frame,x,y[,heading]; empty: unknown
};

/// Whether the rows or the columns of a ground truth matrix are query frames. `automatic`:
/// determined by the shape and the kind of the matrix.
enum class MatrixRows { automatic, query, reference };
template <>
inline constexpr std::array<std::string_view, 3> kEnumNames<MatrixRows> = {"auto", "query",
                                                                           "reference"};

/// Options of one side of a ground truth: of the query or of the training sequence.
struct TruthSide {
  std::filesystem::path times = {};
  std::filesystem::path pose_times = {};
  std::filesystem::path images = {};
  std::optional<double> offset_s = {};

  bool operator==(const TruthSide&) const = default;
};

/// Options that some formats of ground truth need in addition to path and tolerance.
struct GroundTruthOptions {
  std::filesystem::path reference = {};
  std::filesystem::path soft = {};
  std::optional<double> radius_m = {};
  std::optional<double> angle_deg = {};
  std::optional<double> ignore_radius_m = {};
  std::optional<double> train_step = {};
  MatrixRows matrix_rows = MatrixRows::automatic;
  TruthSide query = {};
  TruthSide train = {};
  std::optional<double> max_difference_s = {};
};

template <class Visitor>
void visit_fields(GroundTruthOptions& options, Visitor&& visit) {
  visit("reference", options.reference, "Poses or images of the training sequence.");
  visit("soft", options.soft, "A matrix of pairs to ignore if the ground truth has 0.");
  visit("query_times", options.query.times,
        "Times of the query frames: a list, a folder of images named by time, or a video; absent: "
        "pose i belongs to frame i.");
  visit("train_times", options.train.times, "The same of training frames.");
  visit("query_pose_times", options.query.pose_times,
        "Times of the query poses, for files without times (kitti).");
  visit("train_pose_times", options.train.pose_times,
        "Times of the training poses, as for the query.");
  visit("query_images", options.query.images,
        "gps: folder or list of the query images that a CSV names.");
  visit("train_images", options.train.images, "gps: the same of training images.");
  visit("radius_m", options.radius_m,
        "Largest distance of the same place, in m, inclusive; needed for poses, auto for file "
        "names: 25.",
        at_least(0));
  visit("angle_deg", options.angle_deg,
        "Largest difference of headings of the same place, in degrees, inclusive.", at_least(0));
  visit("ignore_radius_m", options.ignore_radius_m,
        "Frames beyond radius_m and within this distance, in m, and angle_deg are ignored.",
        at_least(0));
  visit("train_step", options.train_step,
        "Aligned: query frame i is training frame train_step * i, rounded; auto: 1.", above(0));
  visit("matrix_rows", options.matrix_rows, "Rows of the matrix.");
  visit("max_difference_s", options.max_difference_s,
        "Largest difference between a frame and its pose, in seconds; auto: 0.02, for gps 1.",
        at_least(0));
  visit("offset_s", options.query.offset_s, "Added to the times of query frames, in s.");
  visit("train_offset_s", options.train.offset_s, "Added to the times of training frames, in s.");
}

/// A query frame and a training frame of the same place, by the frames of their recordings.
struct PlacePair {
  size_t query = 0;
  size_t reference = 0;
  std::string sequence = {};  ///< of the training frame; empty: the only one that was searched
};

/// The path and the format of a ground truth, with its options.
struct GroundTruthArgument {
  std::string format;  ///< a word ("aligned") or the name of a format; empty: detected by content
  std::filesystem::path path = {};
  int tolerance_frames = 0;
  GroundTruthOptions options = {};
  /// The pairs of the format "pairs" in memory instead of a file, which `path` names in messages.
  std::shared_ptr<const std::vector<PlacePair>> pairs = {};
  /// The names of FAB-MAP's places, which the ground truth counts in this order; empty: unknown.
  std::vector<std::string> places = {};
};

/// A query of a data set and its ground truths.
struct DatasetQuery {
  NamedSequence sequence;
  std::optional<GroundTruthArgument> sequence_ground_truth;  ///< for training frames
  std::optional<GroundTruthArgument> place_ground_truth;     ///< for places
};

/// A place of FAB-MAP with its views.
struct DatasetPlace {
  std::string name;
  std::vector<SequenceArgument> views;
};

struct Dataset {
  std::string name;
  double frames_per_second = 0;  ///< 0: unknown
  std::vector<SequenceArgument> pretrain;
  std::vector<NamedSequence> train;
  std::vector<DatasetPlace> places;
  std::vector<DatasetQuery> queries;
  std::filesystem::path plan;         ///< CSV x0,y0,x1,y1[,floor] of the walls; empty: none
  std::filesystem::path place_poses;  ///< CSV place,x,y[,heading,floor]; empty: unknown
};

/// Paths in the file are relative to its folder. Throws Error(input) if it cannot be read,
/// Error(usage) if it is not a data set description or has an unknown key, with the nearest known
/// one.
Dataset read_dataset(const std::filesystem::path& path);
Json dataset_schema();

/// The query with this name, or the only one. Throws Error(usage), which lists the queries.
const DatasetQuery& select_query(const Dataset& dataset, const std::optional<std::string>& name);

}  // namespace vpr
