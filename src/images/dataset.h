// Data set descriptions (vpr.dataset/1): which sequences belong together, and their ground truth.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/json.h"
#include "images/sequence.h"

namespace vpr {

struct NamedSequence {
  std::string name;
  SequenceArgument sequence;
  std::filesystem::path poses = {};  ///< CSV frame,x,y[,heading]; empty: not known
};

/// Where a ground truth stands and how it is read. The format is "aligned" (without a path) or the
/// name of a file format.
struct GroundTruthArgument {
  std::string format;
  std::filesystem::path path;
  int tolerance_frames = 0;
};

struct DatasetQuery {
  NamedSequence sequence;
  std::optional<GroundTruthArgument> sequence_ground_truth;  ///< query frame against train frames
  std::optional<GroundTruthArgument> place_ground_truth;     ///< query frame against places
};

struct DatasetPlace {
  std::string name;
  std::vector<SequenceArgument> views;
};

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
