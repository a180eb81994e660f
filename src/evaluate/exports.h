// Evaluations in formats of other tools: CSV, TUM trajectories and JUnit XML.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "evaluate/expectation.h"
#include "truth/trajectory.h"

namespace vpr {

struct Evaluation;
struct EvaluatedResult;
struct Judgment;

inline constexpr const char* kOutcomesHeader =
    "name,query,first_frame,frame,sequence,train_frame,score,outcome,has_match,recognition,rank,"
    "margin\n";
inline constexpr const char* kRecognitionsHeader =
    "name,query,sequence,first_frame,frame,last_frame,train_first_frame,train_frame,"
    "train_last_frame,recognitions,recognitions_correct,recognitions_incorrect,score,outcome\n";

/// A row per query frame: the window that ends there, best match and outcome, with `name` and
/// `query` in the first columns. Unknown fields are empty.
std::string outcomes_csv(const Judgment& judgment, const std::string& name,
                         const std::string& query);

/// A row per cluster of recognitions: the frames of its windows, and the frames of its
/// representative. For results without clusters a row per recognition, with the place's index in
/// the "train" columns.
std::string recognitions_csv(const EvaluatedResult& judged, const std::string& name);

/// Positions of training frames by sequence of the scope and frame. FAB-MAP's places are one
/// sequence. The list of a sequence without positions is empty.
using TrainPositions = std::vector<Poses>;

/// Times of query frames.
struct FrameTimes {
  std::vector<std::string> texts;
  bool are_seconds = true;  ///< false: numbers of frames
};

/// TUM format, "time x y z 0 0 0 1": a line per recognized query frame whose match has a position,
/// in meters. The first line is a comment.
std::string recognized_trajectory(const Evaluation& evaluation, const TrainPositions& positions,
                                  const FrameTimes& times);

/// One test suite with a test case per value, and a failure for each value that is not met.
/// `suite`: the tested result; `file`: the expectations. The output is well-formed XML 1.0 for any
/// strings.
std::string junit_xml(const std::string& suite, const std::string& file,
                      std::span<const CheckedValue> values);

}  // namespace vpr
