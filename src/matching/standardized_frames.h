// Standardized distances of one query frame after the other to all training frames.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "base/monitor.h"
#include "matching/hamming_kernels.h"
#include "matching/score_kernels.h"
#include "matching/standardization.h"

namespace vpr {

/// What is known of every training frame's centred distances: 8 bytes a frame.
struct StandardizedState {
  std::vector<float> mean;
  std::vector<float> variance;
  double weight = 0;  ///< of both, in views
  double forgetting = 1;
  ViewQueue views;
  ScoreKernels kernels;
  float least_variance = 0;
  float most_variance = 0;

  /// A view whose distances are learned together with the next pass over the codes.
  struct Lesson {
    CodeWords view = {};
    float offset = 0;
    float gain = 0;
  };
  std::optional<Lesson> lesson;
  CodeWords frame = {};
  float offset = 0;  ///< of the frame
};

/// For a ScoreBasis of the whole query (offline), its views are learned here, and none later.
/// `query` is read only then. Throws Error(interrupted) once the user wants to stop.
StandardizedState start_standardized(const TrainCodes& train, const QueryCodes& query,
                                     const ScoreBasis& basis, const HammingKernels& kernels,
                                     const Monitor& monitor);

/// Takes the next query frame: decides what is learned before it is scored. A frame that can't be
/// read is no view.
void begin_frame(StandardizedState& state, const ScoreBasis& basis, const CodeWords& frame,
                 bool is_readable);

/// Scores (see score_kernels.h) of the frame to training frames [first, last), to out[0] and on;
/// first is a multiple of kBlockFrames, and `out` has room for whole blocks. Learns these training
/// frames' share of the lesson first: called once for each frame and stretch, from any thread.
void score_frames(StandardizedState& state, const TrainCodes& train, const HammingKernels& kernels,
                  size_t first, size_t last, uint16_t* out);

/// Whether each query frame can be read.
std::vector<uint8_t> readable_frames(const QueryCodes& query);

}  // namespace vpr
