// Evaluations in formats of other tools: CSV for data frames, TUM trajectories, and JUnit XML.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "evaluate/expectation.h"
#include "truth/poses.h"

namespace vpr {

struct Evaluation;
struct JudgedResult;
struct Judgment;

/// Header lines, with their line feeds.
std::string outcomes_csv_header();
std::string recognitions_csv_header();

/// One row a query window (a frame): where it ends, its best match, and how right it is. `name` and
/// `query` stand in front of each row. A field that is not known is empty.
std::string outcomes_csv(const Judgment& judgment, const std::string& name,
                         const std::string& query);

/// One row a cluster of recognitions: the frames that its windows cover, and the frames at which it
/// is judged. Of a result without clusters one row a recognition: a frame and a place, whose index
/// the "train" columns hold.
std::string recognitions_csv(const JudgedResult& judged, const std::string& name);

/// Positions of training frames (of FAB-MAP: of places, as one sequence), by sequence of the scope
/// and frame; an empty list where those of a sequence are not known.
using TrainPositions = std::vector<Poses>;

/// When query frames were taken: the times of all of them in nanoseconds, or, where there are none,
/// numbers of frames by frames_per_second (above 0), or as they are. Of a query that is thinned,
/// these are the recording's frames, of which `sources` has one a query frame; empty otherwise.
struct FrameClock {
  std::vector<int64_t> times_ns;
  std::optional<double> frames_per_second;
  std::vector<uint32_t> sources = {};
};

/// A line "time x y z 0 0 0 1" (the TUM format) for each query frame that has a fix, right or
/// wrong, and whose match has a position: where somebody is told to be. Positions are in meters
/// (z is 0 on a plan), orientations not known. The first line is a comment.
std::string fix_trajectory(const Evaluation& evaluation, const TrainPositions& positions,
                           const FrameClock& clock);

/// One test suite with a test case for each value; those that are not met have a failure that says
/// what was expected and found. `suite`: what is tested, `file`: what expects it. Whatever the
/// texts hold, the file is well-formed XML 1.0.
std::string junit_xml(const std::string& suite, const std::string& file,
                      std::span<const CheckedValue> values);

}  // namespace vpr
